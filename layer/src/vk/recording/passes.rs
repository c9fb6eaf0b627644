//! Render passes.

use super::{Buffer, Within, timed, with_buffer};
use crate::abi::guard;
use crate::scene::{Pass, Target};
use crate::vk::chain::extension;
use crate::vk::objects::{Objects, RenderPass};
use ash::vk;
use smallvec::SmallVec;
use std::slice;

/// `vkCmdBeginRenderPass`.
pub unsafe extern "system" fn begin(
    handle: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    contents: vk::SubpassContents,
) {
    // SAFETY: the application's own arguments; `info` is valid.
    guard(
        "vkCmdBeginRenderPass",
        || (),
        |_| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_begin_render_pass) else { return };
            let begin = |info: *const vk::RenderPassBeginInfo<'_>| next(handle, info, contents);
            match known {
                Some(known) => begin_noted(&known, handle, info, begin),
                None => begin(info),
            }
        },
    );
}

/// `vkCmdBeginRenderPass2`.
pub unsafe extern "system" fn begin2(
    handle: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    subpass: *const vk::SubpassBeginInfo<'_>,
) {
    // SAFETY: the application's own arguments; `info` is valid.
    guard(
        "vkCmdBeginRenderPass2",
        || (),
        |_| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_begin_render_pass2) else { return };
            let begin = |info: *const vk::RenderPassBeginInfo<'_>| next(handle, info, subpass);
            match known {
                Some(known) => begin_noted(&known, handle, info, begin),
                None => begin(info),
            }
        },
    );
}

/// `vkCmdEndRenderPass`.
pub unsafe extern "system" fn end(handle: vk::CommandBuffer) {
    // SAFETY: the application's own argument.
    guard(
        "vkCmdEndRenderPass",
        || (),
        |_| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_end_render_pass) else { return };
            next(handle);
            if let Some(known) = known {
                known.recorded().end();
                timed::end(&known, handle);
            }
        },
    );
}

/// `vkCmdEndRenderPass2`.
pub unsafe extern "system" fn end2(handle: vk::CommandBuffer, info: *const vk::SubpassEndInfo<'_>) {
    // SAFETY: the application's own arguments.
    guard(
        "vkCmdEndRenderPass2",
        || (),
        |_| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_end_render_pass2) else { return };
            next(handle, info);
            if let Some(known) = known {
                known.recorded().end();
                timed::end(&known, handle);
            }
        },
    );
}

/// `vkCmdClearAttachments`.
pub unsafe extern "system" fn clear_attachments(
    handle: vk::CommandBuffer,
    count: u32,
    attachments: *const vk::ClearAttachment,
    rect_count: u32,
    rects: *const vk::ClearRect,
) {
    // SAFETY: the application's own arguments; `count` attachments are there.
    guard(
        "vkCmdClearAttachments",
        || (),
        |_| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_clear_attachments) else { return };
            next(handle, count, attachments, rect_count, rects);
            let clears_depth = slice::from_raw_parts(attachments, count as usize)
                .iter()
                .any(|cleared| cleared.aspect_mask.contains(vk::ImageAspectFlags::DEPTH));
            if let Some(known) = known.filter(|_| clears_depth) {
                known.recorded().tell(Within { clears_depth, ..Within::default() });
            }
        },
    );
}

/// Begins a render pass with `begin`, with rates where it may have them, and notes it. One whose render pass or
/// framebuffer is not known is left out.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRenderPass.
unsafe fn begin_noted(
    buffer: &Buffer,
    handle: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    begin: impl FnOnce(*const vk::RenderPassBeginInfo<'_>),
) {
    let armed = &buffer.armed;
    // SAFETY: the caller vouches for the structure.
    let pass = unsafe { described(&armed.objects, &*info) };
    // SAFETY: the command buffer is recording outside of render passes, as one begins.
    unsafe { timed::begin(buffer, handle, pass.as_ref()) };
    let candidate = match &armed.rate_attachments {
        Some(rates) => {
            let target = pass.as_ref().and_then(|pass| armed.objects.first_color(pass));
            // SAFETY: as above.
            let image = unsafe { rates.begin_render_pass(info, target, begin) };
            image.map(|image| armed.candidates.with_map(image.key.target, image))
        }
        None => {
            begin(info);
            pass.as_ref().and_then(|pass| armed.candidates.of(armed, pass))
        }
    };
    buffer.recorded().begin(pass, candidate);
}

/// What a render pass instance draws to.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRenderPass.
unsafe fn described(objects: &Objects, info: &vk::RenderPassBeginInfo<'_>) -> Option<Pass> {
    let pass = objects.render_pass(info.render_pass)?;
    let framebuffer = objects.framebuffer(info.framebuffer)?;
    Some(if framebuffer.is_imageless {
        // SAFETY: the caller vouches for the chain, and for the array in it.
        let views = unsafe {
            extension::<vk::RenderPassAttachmentBeginInfo<'_>>(info.p_next).map_or(&[][..], |begin| {
                match begin.attachment_count {
                    0 => &[],
                    count => slice::from_raw_parts(begin.p_attachments, count as usize),
                }
            })
        };
        let targets: SmallVec<[Option<Target>; 8]> =
            views.iter().map(|&view| Some(objects.view(view)?.target)).collect();
        instance(&pass, &targets, info.render_area)
    } else {
        instance(&pass, &framebuffer.attachments, info.render_area)
    })
}

/// An instance of a render pass with these attachments.
fn instance(pass: &RenderPass, targets: &[Option<Target>], area: vk::Rect2D) -> Pass {
    let target = |&index: &u32| targets.get(index as usize).copied().flatten();
    Pass {
        colors: pass.colors.iter().filter_map(target).collect(),
        resolves: pass.resolves.iter().filter_map(target).collect(),
        depth: pass.depth.as_ref().and_then(target),
        area: super::area(area),
        view_mask: pass.view_mask,
        facts: pass.facts,
    }
}
