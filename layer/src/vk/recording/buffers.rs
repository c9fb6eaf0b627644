//! Command pools and command buffers.

use super::{BUFFERS, Buffer, buffer, draws, timed, with_buffer};
use crate::abi::copies::slice;
use crate::abi::guard;
use crate::vk::armed::Armed;
use crate::vk::device;
use ash::vk;
use std::sync::Arc;

const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;

/// `vkCreateCommandPool`.
pub unsafe extern "system" fn create_pool(
    device: vk::Device,
    info: *const vk::CommandPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::CommandPool,
) -> vk::Result {
    guard(
        "vkCreateCommandPool",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, create_command_pool(device, info, allocator, pool), FAILED)
        },
        |answer| {
            // SAFETY: `device` is live, by the valid usage of vkCreateCommandPool.
            let found = unsafe { device::with(device, |next| next.create_command_pool) };
            let Some((known, next)) = found else { return FAILED };
            // SAFETY: the next layer's function, with the application's own arguments.
            let result = answer.record(unsafe { next(device, info, allocator, pool) });
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: both pointers are valid, by the same valid usage; the call has written the pool.
                let (pool, family) = unsafe { (*pool, (*info).queue_family_index) };
                armed.objects.add_pool(pool);
                if armed.follows_passes()
                    && armed.timing.is_possible()
                    && let Some(functions) = armed.functions()
                {
                    armed.timing.add_pool(functions, pool, family);
                }
            }
            result
        },
    )
}

/// `vkDestroyCommandPool`, which frees its command buffers.
pub unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's own arguments.
    guard(
        "vkDestroyCommandPool",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_command_pool(device, pool, allocator), ()) },
        |answer| unsafe {
            let Some((known, next)) = device::with(device, |next| next.destroy_command_pool) else { return };
            if let Some(armed) = &known.armed
                && let Some(known_pool) = armed.objects.remove_pool(pool)
            {
                armed.timing.remove_pool(pool);
                known_pool.buffers().iter().for_each(|&freed| drop(BUFFERS.remove(freed)));
            }
            next(device, pool, allocator);
            answer.made();
        },
    );
}

/// `vkResetCommandPool`, which resets its command buffers.
pub unsafe extern "system" fn reset_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    flags: vk::CommandPoolResetFlags,
) -> vk::Result {
    // SAFETY: the application's own arguments.
    guard(
        "vkResetCommandPool",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, reset_command_pool(device, pool, flags), FAILED) },
        |answer| unsafe {
            let Some((known, next)) = device::with(device, |next| next.reset_command_pool) else {
                return FAILED;
            };
            let result = answer.record(next(device, pool, flags));
            if let Some(pool) = known.armed.as_ref().and_then(|armed| armed.objects.pool(pool)) {
                let buffers = pool.buffers();
                buffers.iter().filter_map(|&reset| buffer(reset)).for_each(|reset| reset.recorded().clear());
            }
            result
        },
    )
}

/// `vkAllocateCommandBuffers`.
pub unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::CommandBufferAllocateInfo<'_>,
    buffers: *mut vk::CommandBuffer,
) -> vk::Result {
    guard(
        "vkAllocateCommandBuffers",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, allocate_command_buffers(device, info, buffers), FAILED) },
        |answer| {
            // SAFETY: `device` is live, by the valid usage of vkAllocateCommandBuffers.
            let found = unsafe { device::with(device, |next| next.allocate_command_buffers) };
            let Some((known, next)) = found else { return FAILED };
            // SAFETY: the next layer's function, with the application's own arguments.
            let result = answer.record(unsafe { next(device, info, buffers) });
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: the pointer is valid, by the same valid usage, and the call has written so many command buffers.
                let (info, made) =
                    unsafe { (&*info, slice(buffers.cast_const(), (*info).command_buffer_count)) };
                note_allocated(armed, info, made);
            }
            result
        },
    )
}

/// Command buffers of an armed device were allocated.
fn note_allocated(
    armed: &Arc<Armed>,
    info: &vk::CommandBufferAllocateInfo<'_>,
    allocated: &[vk::CommandBuffer],
) {
    let Some(pool) = armed.objects.pool(info.command_pool) else { return };
    pool.buffers().extend_from_slice(allocated);
    let is_primary = info.level == vk::CommandBufferLevel::PRIMARY;
    for &handle in allocated {
        let timer = armed.timing.timer(info.command_pool, info.level);
        BUFFERS.insert(handle, Arc::new(Buffer::new(Arc::clone(armed), is_primary, timer)));
    }
}

/// `vkFreeCommandBuffers`.
pub unsafe extern "system" fn free(
    device: vk::Device,
    pool: vk::CommandPool,
    count: u32,
    buffers: *const vk::CommandBuffer,
) {
    guard(
        "vkFreeCommandBuffers",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, free_command_buffers(device, pool, count, buffers), ()) },
        // SAFETY: `device` is live, and there are `count` command buffers of the pool, or null for them, by the valid usage of
        // vkFreeCommandBuffers.
        |answer| unsafe {
            let Some((known, next)) = device::with(device, |next| next.free_command_buffers) else { return };
            let known_pool = known.armed.as_ref().and_then(|armed| armed.objects.pool(pool));
            if let Some(known_pool) = known_pool
                && count > 0
            {
                let freed = slice(buffers, count);
                known_pool.buffers().retain(|live| !freed.contains(live));
                freed.iter().for_each(|&freed| drop(BUFFERS.remove(freed)));
            }
            next(device, pool, count, buffers);
            answer.made();
        },
    );
}

/// `vkBeginCommandBuffer`, which resets it.
pub unsafe extern "system" fn begin(
    handle: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    // SAFETY: the application's own arguments.
    guard(
        "vkBeginCommandBuffer",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, begin_command_buffer(handle, info), FAILED) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.begin_command_buffer) else {
                return FAILED;
            };
            let result = answer.record(next(handle, info));
            if let Some(known) = known {
                draws::recording_begins(handle);
                let mut recorded = known.recorded();
                recorded.clear();
                recorded.timer.recorded_with((*info).flags);
            }
            result
        },
    )
}

/// `vkResetCommandBuffer`.
pub unsafe extern "system" fn reset(
    handle: vk::CommandBuffer,
    flags: vk::CommandBufferResetFlags,
) -> vk::Result {
    // SAFETY: the application's own arguments.
    guard(
        "vkResetCommandBuffer",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, reset_command_buffer(handle, flags), FAILED) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.reset_command_buffer) else {
                return FAILED;
            };
            let result = answer.record(next(handle, flags));
            if let Some(known) = known {
                known.recorded().clear();
            }
            result
        },
    )
}

/// `vkCmdExecuteCommands`.
pub unsafe extern "system" fn execute(
    handle: vk::CommandBuffer,
    count: u32,
    secondaries: *const vk::CommandBuffer,
) {
    guard(
        "vkCmdExecuteCommands",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_execute_commands(handle, count, secondaries), ()) },
        |answer| {
            // SAFETY: `handle` is live, by the valid usage of vkCmdExecuteCommands.
            let found = unsafe { with_buffer(handle, |next| next.cmd_execute_commands) };
            let Some((known, next)) = found else { return };
            if let Some(known) = known.as_ref().filter(|known| !known.recorded().is_within_pass()) {
                // SAFETY: the command buffer is recording, by the same valid usage, and outside of render passes.
                unsafe {
                    timed::work_begins(known, handle);
                    known.fill_all(handle);
                }
            }
            // SAFETY: the next layer's function, with the application's own arguments.
            unsafe { next(handle, count, secondaries) };
            answer.made();
            let Some(known) = known else { return };
            draws::recording_begins(handle);
            let mut recorded = known.recorded();
            // SAFETY: the same valid usage demands `count` command buffers.
            for secondary in unsafe { slice(secondaries, count) } {
                // Whoever records a command buffer that is executed breaks the rules, and must not lock up.
                if let Some(secondary) = buffer(*secondary)
                    && let Ok(secondary) = secondary.recorded.try_lock()
                {
                    recorded.execute(&secondary);
                }
            }
        },
    );
}
