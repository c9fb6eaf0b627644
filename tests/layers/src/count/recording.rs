//! The hooks for command pools, command buffers and draws.

use super::{Counter, Counting, Invocations, Kind};
use crate::layer::{device_of, hooks};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// The layer's hook of that name.
pub(super) fn hook<L: Counting>(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkCreateCommandPool": PFN_vkCreateCommandPool = create_pool::<L>;
        c"vkDestroyCommandPool": PFN_vkDestroyCommandPool = destroy_pool::<L>;
        c"vkResetCommandPool": PFN_vkResetCommandPool = reset_pool::<L>;
        c"vkAllocateCommandBuffers": PFN_vkAllocateCommandBuffers = allocate::<L>;
        c"vkFreeCommandBuffers": PFN_vkFreeCommandBuffers = free::<L>;
        c"vkBeginCommandBuffer": PFN_vkBeginCommandBuffer = begin::<L>;
        c"vkEndCommandBuffer": PFN_vkEndCommandBuffer = end::<L>;
        c"vkResetCommandBuffer": PFN_vkResetCommandBuffer = reset::<L>;
        c"vkCmdExecuteCommands": PFN_vkCmdExecuteCommands = execute::<L>;
    }
    None
}

/// # Safety
///
/// `buffer` is a live command buffer.
pub(super) unsafe fn counting<L: Counting>(buffer: vk::CommandBuffer) -> Arc<L> {
    // SAFETY: the caller vouches for it.
    match unsafe { device_of(buffer) } {
        Some(layer) => layer,
        None => panic!("a command buffer of a device that was created without this layer"),
    }
}

/// # Safety
///
/// `device` is a live device.
pub(super) unsafe fn counting_of_device<L: Counting>(device: vk::Device) -> Arc<L> {
    // SAFETY: the caller vouches for it.
    match unsafe { device_of(device) } {
        Some(layer) => layer,
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

/// # Safety
/// As `vkCreateCommandPool`.
unsafe extern "system" fn create_pool<L: Counting>(
    device: vk::Device,
    info: *const vk::CommandPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::CommandPool,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting_of_device::<L>(device);
        let counter = layer.counter();
        let result = (counter.next.functions.fp_v1_0().create_command_pool)(device, info, allocator, pool);
        if result == vk::Result::SUCCESS {
            counter.buffers().add_pool(*pool, (*info).queue_family_index, (*info).flags);
        }
        result
    }
}

/// # Safety
/// As `vkDestroyCommandPool`.
unsafe extern "system" fn destroy_pool<L: Counting>(
    device: vk::Device,
    pool: vk::CommandPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments; none of the pool's buffers is pending.
    unsafe {
        let layer = counting_of_device::<L>(device);
        let counter = layer.counter();
        collect_pool(counter, pool);
        (counter.next.functions.fp_v1_0().destroy_command_pool)(device, pool, allocator);
        counter.buffers().remove_pool(pool);
    }
}

/// # Safety
/// As `vkResetCommandPool`.
unsafe extern "system" fn reset_pool<L: Counting>(
    device: vk::Device,
    pool: vk::CommandPool,
    flags: vk::CommandPoolResetFlags,
) -> vk::Result {
    // SAFETY: the application's valid arguments; none of the pool's buffers is pending.
    unsafe {
        let layer = counting_of_device::<L>(device);
        let counter = layer.counter();
        collect_pool(counter, pool);
        (counter.next.functions.fp_v1_0().reset_command_pool)(device, pool, flags)
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

/// # Safety
/// As `vkAllocateCommandBuffers`.
unsafe extern "system" fn allocate<L: Counting>(
    device: vk::Device,
    info: *const vk::CommandBufferAllocateInfo<'_>,
    allocated: *mut vk::CommandBuffer,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting_of_device::<L>(device);
        let counter = layer.counter();
        let result = (counter.next.functions.fp_v1_0().allocate_command_buffers)(device, info, allocated);
        if result == vk::Result::SUCCESS {
            let new = slice(allocated.cast_const(), (*info).command_buffer_count);
            counter.buffers().add((*info).command_pool, (*info).level, new);
        }
        result
    }
}

/// # Safety
/// As `vkFreeCommandBuffers`.
unsafe extern "system" fn free<L: Counting>(
    device: vk::Device,
    pool: vk::CommandPool,
    count: u32,
    freed: *const vk::CommandBuffer,
) {
    // SAFETY: the application's valid arguments; the buffers are not pending.
    unsafe {
        let layer = counting_of_device::<L>(device);
        let counter = layer.counter();
        let buffers = slice(freed, count);
        for &buffer in buffers {
            counter.buffers().collect(buffer);
        }
        (counter.next.functions.fp_v1_0().free_command_buffers)(device, pool, count, freed);
        counter.buffers().remove(buffers);
    }
}

/// # Safety
/// As `vkBeginCommandBuffer`.
unsafe extern "system" fn begin<L: Counting>(
    buffer: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the buffer is not pending.
    unsafe {
        let layer = counting::<L>(buffer);
        let counter = layer.counter();
        counter.buffers().collect(buffer);
        let next = counter.next.functions.fp_v1_0().begin_command_buffer;
        let secondary = counter.buffers().is_secondary(buffer);
        let inheritance =
            (*info).p_inheritance_info.as_ref().filter(|_| secondary && counter.inherited_queries);
        let result = match inheritance {
            // It runs while the primary buffer's query is active, and must declare this.
            Some(inheritance) => {
                let mut inheritance = *inheritance;
                match counter.kind {
                    Kind::Invocations => {
                        inheritance.pipeline_statistics |=
                            vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS;
                    }
                    Kind::Samples => {
                        inheritance.occlusion_query_enable = vk::TRUE;
                        inheritance.query_flags |= vk::QueryControlFlags::PRECISE;
                    }
                    Kind::Times => {}
                }
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

/// # Safety
/// As `vkEndCommandBuffer`.
unsafe extern "system" fn end<L: Counting>(buffer: vk::CommandBuffer) -> vk::Result {
    // SAFETY: the application's valid argument.
    unsafe {
        let layer = counting::<L>(buffer);
        let counter = layer.counter();
        counter.buffers().end(buffer);
        (counter.next.functions.fp_v1_0().end_command_buffer)(buffer)
    }
}

/// # Safety
/// As `vkResetCommandBuffer`.
unsafe extern "system" fn reset<L: Counting>(
    buffer: vk::CommandBuffer,
    flags: vk::CommandBufferResetFlags,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the buffer is not pending.
    unsafe {
        let layer = counting::<L>(buffer);
        let counter = layer.counter();
        counter.buffers().collect(buffer);
        (counter.next.functions.fp_v1_0().reset_command_buffer)(buffer, flags)
    }
}

/// # Safety
/// As `vkCmdExecuteCommands`.
unsafe extern "system" fn execute<L: Counting>(
    primary: vk::CommandBuffer,
    count: u32,
    secondary: *const vk::CommandBuffer,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(primary);
        let counter = layer.counter();
        let why_not = (counter.kind == Kind::Invocations && !counter.inherited_queries)
            .then_some("secondary command buffers, and the device has no inheritedQueries");
        counter.buffers().execute(primary, slice(secondary, count), why_not);
        (counter.next.functions.fp_v1_0().cmd_execute_commands)(primary, count, secondary);
    }
}

macro_rules! draws {
    ($($hook:ident -> $next:ident, $draws:expr, ($($argument:ident: $type:ty),*);)*) => {
        $(pub(super) unsafe extern "system" fn $hook(buffer: vk::CommandBuffer, $($argument: $type),*) {
            // SAFETY: the application's valid arguments.
            unsafe {
                let layer = counting::<Invocations>(buffer);
                let counter = layer.counter();
                counter.buffers().add_draws(buffer, u64::from($draws));
                (counter.next.functions.fp_v1_0().$next)(buffer, $($argument),*);
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
