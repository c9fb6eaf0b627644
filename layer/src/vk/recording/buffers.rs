//! Command pools and command buffers.

use super::{
    BUFFERS, Buffer, Recorded, buffer, draws, forget, heaps, timed, tracked, untracked, with_any, with_buffer,
};
use crate::abi::copies::slice;
use crate::vk::armed::Armed;
use crate::vk::device;
use ash::vk;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::thread::yield_now;

/// `vkCreateCommandPool`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create_pool(
    device: vk::Device,
    info: *const vk::CommandPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::CommandPool,
) -> vk::Result {
    hook!(
        "vkCreateCommandPool",
        device::with,
        create_command_pool(device, info, allocator, pool),
        |known, next| {
            let result = next();
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: both pointers are valid, by valid usage; the call has written the pool.
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
        }
    )
}

/// `vkDestroyCommandPool`, which frees its command buffers.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyCommandPool",
        device::with,
        destroy_command_pool(device, pool, allocator),
        |known, next| {
            if let Some(armed) = &known.armed
                && let Some(known_pool) = armed.objects.remove_pool(pool)
            {
                armed.timing.remove_pool(pool);
                known_pool.buffers().iter().for_each(|&freed| forget(freed));
            }
            next();
        }
    );
}

/// `vkResetCommandPool`, which resets its command buffers.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn reset_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    flags: vk::CommandPoolResetFlags,
) -> vk::Result {
    hook!("vkResetCommandPool", device::with, reset_command_pool(device, pool, flags), |known, next| {
        let result = next();
        if let Some(pool) = known.armed.as_ref().and_then(|armed| armed.objects.pool(pool)) {
            let buffers = pool.buffers();
            buffers.iter().filter_map(|&reset| buffer(reset)).for_each(|reset| reset.recorded().clear());
        }
        result
    })
}

/// `vkAllocateCommandBuffers`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::CommandBufferAllocateInfo<'_>,
    buffers: *mut vk::CommandBuffer,
) -> vk::Result {
    hook!(
        "vkAllocateCommandBuffers",
        device::with,
        allocate_command_buffers(device, info, buffers),
        |known, next| {
            let result = next();
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: the pointer is valid, by valid usage, and the call has written so many command buffers.
                let (info, made) =
                    unsafe { (&*info, slice(buffers.cast_const(), (*info).command_buffer_count)) };
                note_allocated(armed, info, made);
            }
            result
        }
    )
}

/// Command buffers of an armed device were allocated.
fn note_allocated(
    armed: &Arc<Armed>,
    info: &vk::CommandBufferAllocateInfo<'_>,
    allocated: &[vk::CommandBuffer],
) {
    if armed.ignores_runtime() {
        return;
    }
    let Some(pool) = armed.objects.pool(info.command_pool) else { return };
    pool.buffers().extend_from_slice(allocated);
    let is_primary = info.level == vk::CommandBufferLevel::PRIMARY;
    for &handle in allocated {
        let timer = armed.timing.timer(info.command_pool, info.level);
        BUFFERS.insert(handle, Arc::new(Buffer::new(Arc::clone(armed), is_primary, timer)));
    }
}

/// `vkFreeCommandBuffers`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn free(
    device: vk::Device,
    pool: vk::CommandPool,
    count: u32,
    buffers: *const vk::CommandBuffer,
) {
    hook!(
        "vkFreeCommandBuffers",
        device::with,
        free_command_buffers(device, pool, count, buffers),
        |known, next| {
            let known_pool = known.armed.as_ref().and_then(|armed| armed.objects.pool(pool));
            if let Some(known_pool) = known_pool
                && count > 0
            {
                // SAFETY: valid usage demands `count` command buffers, or null.
                let freed = unsafe { slice(buffers, count) };
                known_pool.buffers().retain(|live| !freed.contains(live));
                freed.iter().for_each(|&freed| forget(freed));
            }
            next();
        }
    );
}

impl Buffer {
    /// Whether its commands may go untracked now. A rate attachment without content would have to be initialised, secondaries count for the
    /// passes of others, and layouts of images of virtual swapchains are needed in each frame.
    fn may_rest(&self) -> bool {
        let armed = &self.armed;
        self.is_primary
            && armed.rate_attachments.is_none()
            && armed.frame.rests()
            && !armed.layouts.has_virtual()
    }
}

/// `vkBeginCommandBuffer`, which resets it.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin(
    handle: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    hook!("vkBeginCommandBuffer", with_any, begin_command_buffer(handle, info), |known, next| {
        let result = next();
        let Some(known) = known else {
            untracked::begin_here(handle);
            return result;
        };
        // SAFETY: the pointer is valid, by valid usage.
        let flags = unsafe { (*info).flags };
        let was_tracked = !known.recordings.is_untracked();
        let is_tracked = known.recordings.begin(handle, flags, known.may_rest());
        if is_tracked || was_tracked {
            known.recorded().clear();
        }
        if is_tracked {
            draws::recording_begins(&known, handle);
            if let Some(rates) = &known.armed.rate_attachments
                && rates.set_rates.depend_on_pass()
            {
                // SAFETY: the pointer is valid, by valid usage, which demands the inheritance of a secondary command buffer.
                let continued = if known.is_primary { None } else { unsafe { continued_pass(&*info) } };
                let is_left_alone = continued.is_some_and(|pass| rates.leaves_alone(pass));
                rates.set_rates.recording_begins(handle, is_left_alone);
            }
            // SAFETY: the pointer is valid, by valid usage, which demands the inheritance of a secondary command buffer.
            if !known.is_primary && unsafe { heaps::are_inherited(&*info) } {
                draws::bind_unknown(handle);
            }
            known.recorded().timer.recorded_with(flags);
        } else {
            draws::untracked_begins(handle);
        }
        result
    })
}

/// The render pass that a secondary command buffer continues: null in dynamic rendering, which may have the application's own rate attachment;
/// `None` outside of render passes.
///
/// # Safety
///
/// The valid usage of vkBeginCommandBuffer for a secondary command buffer.
unsafe fn continued_pass(info: &vk::CommandBufferBeginInfo<'_>) -> Option<vk::RenderPass> {
    // SAFETY: valid usage demands a valid pointer with this flag; without the flag it is not used.
    let inherited = unsafe {
        let continues = info.flags.contains(vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE);
        if continues { info.p_inheritance_info.as_ref() } else { None }
    };
    inherited.map(|inherited| inherited.render_pass)
}

/// `vkResetCommandBuffer`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn reset(
    handle: vk::CommandBuffer,
    flags: vk::CommandBufferResetFlags,
) -> vk::Result {
    hook!("vkResetCommandBuffer", with_buffer, reset_command_buffer(handle, flags), |known, next| {
        let result = next();
        if let Some(known) = known {
            known.recorded().clear();
        }
        result
    })
}

/// Attempts to lock a record: far more than other threads need to read it.
const ATTEMPTS: u32 = 10_000;

/// The lock of a secondary command buffer's record, which other threads may read at the same time for their own primary ones. An application that
/// records a command buffer during its execution violates valid usage, but must not deadlock here: `None` for it, after so many `attempts`.
fn patiently_locked(recorded: &Mutex<Recorded>, attempts: u32) -> Option<MutexGuard<'_, Recorded>> {
    (0..attempts).find_map(|_| match recorded.try_lock() {
        Ok(recorded) => Some(recorded),
        Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => {
            yield_now();
            None
        }
    })
}

/// `vkCmdExecuteCommands`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn execute(
    handle: vk::CommandBuffer,
    count: u32,
    secondaries: *const vk::CommandBuffer,
) {
    hook!(
        "vkCmdExecuteCommands",
        with_buffer,
        cmd_execute_commands(handle, count, secondaries),
        |known, next| {
            if let Some(known) = known.as_ref().filter(|known| !known.recorded().is_within_pass()) {
                // SAFETY: the command buffer is recording, by valid usage, and outside of render passes.
                unsafe {
                    timed::work_begins(known, handle);
                    known.fill_all(handle);
                }
            }
            next();
            let Some(known) = known else { return };
            draws::recording_begins(&known, handle);
            let mut recorded = known.recorded();
            // SAFETY: valid usage demands `count` command buffers.
            for secondary in unsafe { slice(secondaries, count) } {
                if let Some(secondary) = tracked(*secondary)
                    && let Some(secondary) = patiently_locked(&secondary.recorded, ATTEMPTS)
                {
                    recorded.execute(&secondary);
                }
            }
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;
    use std::thread::scope;
    use std::time::Duration;

    #[test]
    fn secondary_command_buffers_continue_a_pass_or_dynamic_rendering() {
        let continues = vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE;
        let (pass, none) = (vk::RenderPass::from_raw(1), vk::RenderPass::null());
        let empty = vk::CommandBufferUsageFlags::empty();
        for (flags, inherited, expected) in
            [(continues, pass, Some(pass)), (continues, none, Some(none)), (empty, pass, None)]
        {
            let inheritance = vk::CommandBufferInheritanceInfo::default().render_pass(inherited);
            let info = vk::CommandBufferBeginInfo::default().flags(flags).inheritance_info(&inheritance);
            // SAFETY: a valid structure.
            assert_eq!(unsafe { continued_pass(&info) }, expected);
        }
    }

    #[test]
    fn a_record_that_another_thread_reads_is_waited_for() {
        let recorded = Mutex::new(Recorded::default());
        scope(|threads| {
            let held = recorded.lock().unwrap();
            let other = threads.spawn(|| patiently_locked(&recorded, u32::MAX).is_some());
            std::thread::sleep(Duration::from_micros(50));
            drop(held);
            assert!(other.join().unwrap());
        });
        let _held = recorded.lock().unwrap();
        assert!(patiently_locked(&recorded, 3).is_none(), "held by this thread");
    }
}
