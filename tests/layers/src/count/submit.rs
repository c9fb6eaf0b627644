//! The hooks for submits.

use super::recording::slice;
use super::{Counter, Counting};
use crate::layer::{device_of, hooks};
use ash::vk;
use std::ffi::CStr;

/// The layer's hook of that name.
pub(super) fn hook<L: Counting>(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkQueueSubmit": PFN_vkQueueSubmit = queue_submit::<L>;
        c"vkQueueSubmit2": PFN_vkQueueSubmit2 = queue_submit2::<L>;
        c"vkQueueSubmit2KHR": PFN_vkQueueSubmit2 = queue_submit2::<L>;
    }
    None
}

/// # Safety
/// As `vkQueueSubmit`.
unsafe extern "system" fn queue_submit<L: Counting>(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<L>(queue) else { return vk::Result::ERROR_DEVICE_LOST };
        let counter = layer.counter();
        let buffers: Vec<_> = slice(submits, count)
            .iter()
            .flat_map(|submit| slice(submit.p_command_buffers, submit.command_buffer_count))
            .copied()
            .collect();
        counted(counter, &buffers, || {
            (counter.next.functions.fp_v1_0().queue_submit)(queue, count, submits, fence)
        })
    }
}

/// # Safety
/// As `vkQueueSubmit2`.
unsafe extern "system" fn queue_submit2<L: Counting>(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<L>(queue) else { return vk::Result::ERROR_DEVICE_LOST };
        let counter = layer.counter();
        let Some(next) = counter.functions.queue_submit2 else { return vk::Result::ERROR_DEVICE_LOST };
        let buffers: Vec<_> = slice(submits, count)
            .iter()
            .flat_map(|submit| slice(submit.p_command_buffer_infos, submit.command_buffer_info_count))
            .map(|info| info.command_buffer)
            .collect();
        counted(counter, &buffers, || next(queue, count, submits, fence))
    }
}

/// Reads the remaining results of the buffers' last submits, then submits them.
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
