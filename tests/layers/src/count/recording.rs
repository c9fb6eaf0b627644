//! The hooks for command pools, command buffers and draws.

use super::Counter;
use crate::layer::{Layer, device_of};
use ash::vk;
use std::sync::Arc;

/// # Safety
///
/// `buffer` is a live command buffer.
unsafe fn counter(buffer: vk::CommandBuffer) -> Arc<Counter> {
    // SAFETY: the caller vouches for it.
    match unsafe { device_of(buffer) } {
        Some(counter) => counter,
        None => panic!("a command buffer of a device that was created without this layer"),
    }
}

/// # Safety
///
/// `device` is a live device.
unsafe fn counter_of_device(device: vk::Device) -> Arc<Counter> {
    // SAFETY: the caller vouches for it.
    match unsafe { device_of(device) } {
        Some(counter) => counter,
        None => panic!("a device that was created without this layer"),
    }
}

/// # Safety
///
/// `first` points to that many handles, or there are none.
pub(super) unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    if count == 0 || first.is_null() {
        return &[];
    }
    // SAFETY: the caller vouches for it.
    unsafe { std::slice::from_raw_parts(first, count as usize) }
}

pub(super) unsafe extern "system" fn create_pool(
    device: vk::Device,
    info: *const vk::CommandPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::CommandPool,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let counter = counter_of_device(device);
        let result = (counter.next().functions.fp_v1_0().create_command_pool)(device, info, allocator, pool);
        if result == vk::Result::SUCCESS {
            counter.buffers().add_pool(*pool, (*info).queue_family_index, (*info).flags);
        }
        result
    }
}

pub(super) unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments; none of the pool's buffers is pending.
    unsafe {
        let counter = counter_of_device(device);
        collect_pool(&counter, pool);
        (counter.next().functions.fp_v1_0().destroy_command_pool)(device, pool, allocator);
        counter.buffers().remove_pool(pool);
    }
}

pub(super) unsafe extern "system" fn reset_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    flags: vk::CommandPoolResetFlags,
) -> vk::Result {
    // SAFETY: the application's valid arguments; none of the pool's buffers is pending.
    unsafe {
        let counter = counter_of_device(device);
        collect_pool(&counter, pool);
        (counter.next().functions.fp_v1_0().reset_command_pool)(device, pool, flags)
    }
}

/// # Safety
///
/// None of the pool's buffers is pending.
unsafe fn collect_pool(counter: &Counter, pool: vk::CommandPool) {
    let mut buffers = counter.buffers();
    for buffer in buffers.of_pool(pool) {
        // SAFETY: the buffer lives as long as its pool.
        unsafe { buffers.collect(buffer) };
    }
}

pub(super) unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::CommandBufferAllocateInfo<'_>,
    allocated: *mut vk::CommandBuffer,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let counter = counter_of_device(device);
        let result = (counter.next().functions.fp_v1_0().allocate_command_buffers)(device, info, allocated);
        if result == vk::Result::SUCCESS {
            let new = slice(allocated.cast_const(), (*info).command_buffer_count);
            counter.buffers().add((*info).command_pool, (*info).level, new);
        }
        result
    }
}

pub(super) unsafe extern "system" fn free(
    device: vk::Device,
    pool: vk::CommandPool,
    count: u32,
    freed: *const vk::CommandBuffer,
) {
    // SAFETY: the application's valid arguments; the buffers are not pending.
    unsafe {
        let counter = counter_of_device(device);
        let buffers = slice(freed, count);
        for &buffer in buffers {
            counter.buffers().collect(buffer);
        }
        (counter.next().functions.fp_v1_0().free_command_buffers)(device, pool, count, freed);
        counter.buffers().remove(buffers);
    }
}

pub(super) unsafe extern "system" fn begin(
    buffer: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the buffer is not pending.
    unsafe {
        let counter = counter(buffer);
        counter.buffers().collect(buffer);
        let next = counter.next().functions.fp_v1_0().begin_command_buffer;
        let secondary = counter.buffers().is_secondary(buffer);
        let inheritance =
            (*info).p_inheritance_info.as_ref().filter(|_| secondary && counter.inherited_queries);
        let result = match inheritance {
            // It runs while the primary buffer's query is active, and must say so.
            Some(inheritance) => {
                let mut inheritance = *inheritance;
                inheritance.pipeline_statistics |=
                    vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS;
                let info = vk::CommandBufferBeginInfo { p_inheritance_info: &inheritance, ..*info };
                next(buffer, &info)
            }
            None => next(buffer, info),
        };
        if result == vk::Result::SUCCESS {
            counter.buffers().begin(buffer);
        }
        result
    }
}

pub(super) unsafe extern "system" fn end(buffer: vk::CommandBuffer) -> vk::Result {
    // SAFETY: the application's valid argument.
    unsafe {
        let counter = counter(buffer);
        counter.buffers().end(buffer);
        (counter.next().functions.fp_v1_0().end_command_buffer)(buffer)
    }
}

pub(super) unsafe extern "system" fn reset(
    buffer: vk::CommandBuffer,
    flags: vk::CommandBufferResetFlags,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the buffer is not pending.
    unsafe {
        let counter = counter(buffer);
        counter.buffers().collect(buffer);
        (counter.next().functions.fp_v1_0().reset_command_buffer)(buffer, flags)
    }
}

pub(super) unsafe extern "system" fn execute(
    primary: vk::CommandBuffer,
    count: u32,
    secondary: *const vk::CommandBuffer,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let counter = counter(primary);
        let why_not = (!counter.inherited_queries)
            .then_some("secondary command buffers, and the device has no inheritedQueries");
        counter.buffers().execute(primary, slice(secondary, count), why_not);
        (counter.next().functions.fp_v1_0().cmd_execute_commands)(primary, count, secondary);
    }
}

macro_rules! draws {
    ($($hook:ident -> $next:ident, $draws:expr, ($($argument:ident: $type:ty),*);)*) => {
        $(pub(super) unsafe extern "system" fn $hook(buffer: vk::CommandBuffer, $($argument: $type),*) {
            // SAFETY: the application's valid arguments.
            unsafe {
                let counter = counter(buffer);
                counter.buffers().add_draws(buffer, u64::from($draws));
                (counter.next().functions.fp_v1_0().$next)(buffer, $($argument),*);
            }
        })*
    };
}

draws! {
    draw -> cmd_draw, 1u32, (vertices: u32, instances: u32, first_vertex: u32, first_instance: u32);
    draw_indexed -> cmd_draw_indexed, 1u32,
        (indices: u32, instances: u32, first_index: u32, vertex_offset: i32, first_instance: u32);
    draw_indirect -> cmd_draw_indirect, count,
        (arguments: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32);
    draw_indexed_indirect -> cmd_draw_indexed_indirect, count,
        (arguments: vk::Buffer, offset: vk::DeviceSize, count: u32, stride: u32);
}
