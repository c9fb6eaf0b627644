//! The hooks for submits.

use super::Counter;
use super::recording::slice;
use crate::layer::{Layer, device_of};
use ash::vk;

pub(super) unsafe extern "system" fn queue_submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(counter) = device_of::<Counter>(queue) else { return vk::Result::ERROR_DEVICE_LOST };
        let buffers: Vec<_> = slice(submits, count)
            .iter()
            .flat_map(|submit| slice(submit.p_command_buffers, submit.command_buffer_count))
            .copied()
            .collect();
        counted(&counter, &buffers, || {
            (counter.next().functions.fp_v1_0().queue_submit)(queue, count, submits, fence)
        })
    }
}

pub(super) unsafe extern "system" fn queue_submit2(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let known = device_of::<Counter>(queue).and_then(|counter| Some((counter.queue_submit2?, counter)));
        let Some((next, counter)) = known else { return vk::Result::ERROR_DEVICE_LOST };
        let buffers: Vec<_> = slice(submits, count)
            .iter()
            .flat_map(|submit| slice(submit.p_command_buffer_infos, submit.command_buffer_info_count))
            .map(|info| info.command_buffer)
            .collect();
        counted(&counter, &buffers, || next(queue, count, submits, fence))
    }
}

/// Reads what is left of the buffers' last submits, then submits them.
///
/// # Safety
///
/// The buffers are live.
unsafe fn counted(
    counter: &Counter,
    buffers: &[vk::CommandBuffer],
    submit: impl FnOnce() -> vk::Result,
) -> vk::Result {
    for &buffer in buffers {
        // SAFETY: the caller vouches for the buffers.
        unsafe { counter.buffers().collect(buffer) };
    }
    let result = submit();
    if result == vk::Result::SUCCESS {
        counter.buffers().submitted(buffers);
    }
    result
}
