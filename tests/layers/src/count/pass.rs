//! The hooks for the begin and end of render passes.

use super::recording::counting;
use super::{Counting, Kind, application};
use crate::layer::hooks;
use ash::vk;
use std::ffi::CStr;

/// The layer's hook of that name.
pub(super) fn hook<L: Counting>(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkCmdBeginRenderPass": PFN_vkCmdBeginRenderPass = begin_render_pass::<L>;
        c"vkCmdEndRenderPass": PFN_vkCmdEndRenderPass = end_render_pass::<L>;
        c"vkCmdBeginRenderPass2": PFN_vkCmdBeginRenderPass2 = begin_render_pass2::<L>;
        c"vkCmdBeginRenderPass2KHR": PFN_vkCmdBeginRenderPass2 = begin_render_pass2::<L>;
        c"vkCmdEndRenderPass2": PFN_vkCmdEndRenderPass2 = end_render_pass2::<L>;
        c"vkCmdEndRenderPass2KHR": PFN_vkCmdEndRenderPass2 = end_render_pass2::<L>;
        c"vkCmdBeginRendering": PFN_vkCmdBeginRendering = begin_rendering::<L>;
        c"vkCmdBeginRenderingKHR": PFN_vkCmdBeginRendering = begin_rendering::<L>;
        c"vkCmdEndRendering": PFN_vkCmdEndRendering = end_rendering::<L>;
        c"vkCmdEndRenderingKHR": PFN_vkCmdEndRendering = end_rendering::<L>;
    }
    None
}

/// A pass begins by `call`; `why_not` is the reason if it cannot be counted.
///
/// # Safety
///
/// `buffer` is recording, outside of a render pass.
unsafe fn begin<L: Counting>(
    layer: &L,
    buffer: vk::CommandBuffer,
    why_not: Option<&str>,
    call: impl FnOnce(),
) {
    let counter = layer.counter();
    match counter.kind {
        Kind::Invocations => application::begins_pass(call),
        Kind::Samples => {
            if application::is_beginning_pass() {
                // SAFETY: the caller vouches for the buffer.
                unsafe { counter.buffers().begin_pass(buffer, why_not) };
            }
            call();
        }
        Kind::Times => call(),
    }
}

/// A pass has ended.
///
/// # Safety
///
/// `buffer` is recording, outside of a render pass.
unsafe fn end<L: Counting>(layer: &L, buffer: vk::CommandBuffer) {
    if layer.counter().kind == Kind::Samples {
        // SAFETY: the caller vouches for the buffer.
        unsafe { layer.counter().buffers().end_pass(buffer) };
    }
}

/// Reason why the draws of a pass cannot be counted that has secondary command buffers.
fn secondary<L: Counting>(layer: &L, contents: vk::SubpassContents) -> Option<&'static str> {
    let inherits = layer.counter().inherited_queries;
    (contents != vk::SubpassContents::INLINE && !inherits)
        .then_some("secondary command buffers, and the device has no inheritedQueries")
}

/// # Safety
/// As `vkCmdBeginRenderPass`.
unsafe extern "system" fn begin_render_pass<L: Counting>(
    buffer: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    contents: vk::SubpassContents,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(buffer);
        let next = layer.next().functions.fp_v1_0().cmd_begin_render_pass;
        begin(&*layer, buffer, secondary(&*layer, contents), || next(buffer, info, contents));
    }
}

/// # Safety
/// As `vkCmdEndRenderPass`.
unsafe extern "system" fn end_render_pass<L: Counting>(buffer: vk::CommandBuffer) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(buffer);
        (layer.next().functions.fp_v1_0().cmd_end_render_pass)(buffer);
        end(&*layer, buffer);
    }
}

/// # Safety
/// As `vkCmdBeginRenderPass2`.
unsafe extern "system" fn begin_render_pass2<L: Counting>(
    buffer: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    subpass: *const vk::SubpassBeginInfo<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(buffer);
        let Some(next) = layer.counter().functions.begin_render_pass2 else { return };
        let why_not = secondary(&*layer, (*subpass).contents);
        begin(&*layer, buffer, why_not, || next(buffer, info, subpass));
    }
}

/// # Safety
/// As `vkCmdEndRenderPass2`.
unsafe extern "system" fn end_render_pass2<L: Counting>(
    buffer: vk::CommandBuffer,
    subpass: *const vk::SubpassEndInfo<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(buffer);
        let Some(next) = layer.counter().functions.end_render_pass2 else { return };
        next(buffer, subpass);
        end(&*layer, buffer);
    }
}

/// # Safety
/// As `vkCmdBeginRendering`.
unsafe extern "system" fn begin_rendering<L: Counting>(
    buffer: vk::CommandBuffer,
    info: *const vk::RenderingInfo<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(buffer);
        let Some(next) = layer.counter().functions.begin_rendering else { return };
        let flags = (*info).flags;
        let parts = vk::RenderingFlags::SUSPENDING | vk::RenderingFlags::RESUMING;
        let why_not = if flags.intersects(parts) {
            // Between its parts there may be no query.
            Some("a suspended render pass")
        } else {
            let secondaries = flags.contains(vk::RenderingFlags::CONTENTS_SECONDARY_COMMAND_BUFFERS);
            secondaries.then(|| secondary(&*layer, vk::SubpassContents::SECONDARY_COMMAND_BUFFERS)).flatten()
        };
        begin(&*layer, buffer, why_not, || next(buffer, info));
    }
}

/// # Safety
/// As `vkCmdEndRendering`.
unsafe extern "system" fn end_rendering<L: Counting>(buffer: vk::CommandBuffer) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let layer = counting::<L>(buffer);
        let Some(next) = layer.counter().functions.end_rendering else { return };
        next(buffer);
        end(&*layer, buffer);
    }
}
