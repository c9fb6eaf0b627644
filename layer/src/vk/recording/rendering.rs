//! Dynamic rendering.

use super::passes::end_tracked;
use super::{Buffer, binding, drawing, draws, timed, with_buffer};
use crate::abi::copies::slice;
use crate::backend::mask::{DepthWork, Masks, OpenMask, rendering_attachments};
use crate::pass_detection::{Pass, PassFacts, Target, Unmasked};
use crate::vk::candidates::Candidate;
use crate::vk::chain::extension;
use crate::vk::objects::Objects;
use ash::vk;
use std::ffi::c_void;
use std::sync::Arc;

/// `vkCmdBeginRendering`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn begin(handle: vk::CommandBuffer, info: *const vk::RenderingInfo<'_>) {
    hook!("vkCmdBeginRendering", with_buffer, cmd_begin_rendering(handle, info), |known, next, answer| {
        let begin = |info: *const vk::RenderingInfo<'_>| {
            // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
            unsafe { next(handle, info) };
            answer.made();
        };
        match known.filter(|known| known.armed.follows_passes()) {
            // SAFETY: the application's own arguments, with the valid usage of vkCmdBeginRendering.
            Some(known) => unsafe { begin_tracked(&known, handle, info, begin) },
            None => begin(info),
        }
    });
}

/// `vkCmdEndRendering`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end(handle: vk::CommandBuffer) {
    hook!("vkCmdEndRendering", with_buffer, cmd_end_rendering(handle), |known, next| {
        next();
        if let Some(known) = known {
            // SAFETY: the command buffer is recording, by valid usage, and outside of rendering since the call.
            unsafe { end_tracked(&known, handle) };
        }
    });
}

/// `vkCmdEndRendering2KHR`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end2(handle: vk::CommandBuffer, info: *const c_void) {
    hook!("vkCmdEndRendering2KHR", with_buffer, cmd_end_rendering2(handle, info), |known, next| {
        next();
        if let Some(known) = known {
            // SAFETY: the command buffer is recording, by valid usage, and outside of rendering since the call.
            unsafe { end_tracked(&known, handle) };
        }
    });
}

/// `vkCmdEndRendering2EXT`, the same by its first name.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn end2_ext(handle: vk::CommandBuffer, info: *const c_void) {
    hook!("vkCmdEndRendering2EXT", with_buffer, cmd_end_rendering2_ext(handle, info), |known, next| {
        next();
        if let Some(known) = known {
            // SAFETY: the command buffer is recording, by valid usage, and outside of rendering since the call.
            unsafe { end_tracked(&known, handle) };
        }
    });
}

/// Begins dynamic rendering with `begin`, with rates or a mask where it may have them, and notes it.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
unsafe fn begin_tracked(
    buffer: &Buffer,
    handle: vk::CommandBuffer,
    info: *const vk::RenderingInfo<'_>,
    begin: impl FnOnce(*const vk::RenderingInfo<'_>),
) {
    let armed = &buffer.armed;
    // SAFETY: the pointer is valid, by the valid usage of vkCmdBeginRendering.
    let mut pass = unsafe { instance(&armed.objects, &*info) };
    // SAFETY: vkCmdBeginRendering is valid only in a command buffer that is recording, outside of render passes.
    unsafe { timed::pass_begins(buffer, handle, Some(&pass)) };
    let (candidate, mask) = match (&armed.rate_attachments, &armed.masks) {
        (Some(rates), _) => {
            let target = armed.objects.first_color(&pass);
            // SAFETY: the command buffer is recording and the structure valid, as above.
            let image = unsafe {
                binding::pass_begins(&armed.next, rates, handle, || has_own_rates(&*info));
                rates.begin_rendering(info, (target, armed.frame.is_on()), begin)
            };
            (image.map(|(image, is_attached)| armed.candidates.with_rate_image(image, is_attached)), None)
        }
        // SAFETY: valid usage of vkCmdBeginRendering, as this function requires.
        (None, Some(masks)) => unsafe { begin_masked(buffer, masks, handle, info, &mut pass, begin) },
        (None, None) => {
            begin(info);
            (None, None)
        }
    };
    buffer.recorded().begin(Some(pass), candidate, mask);
    draws::pass_begins(buffer, handle);
    // SAFETY: the command buffer is recording, as above; the pass was begun.
    unsafe { drawing::pass_begins(buffer, handle) };
}

/// Begins dynamic rendering with `begin`, with a mask where it may have one. Returns its candidate and its mask.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
unsafe fn begin_masked(
    buffer: &Buffer,
    masks: &Masks,
    handle: vk::CommandBuffer,
    info: *const vk::RenderingInfo<'_>,
    pass: &mut Pass,
    begin: impl FnOnce(*const vk::RenderingInfo<'_>),
) -> (Option<Arc<Candidate>>, Option<OpenMask>) {
    // SAFETY: the pointer is valid, by the valid usage of vkCmdBeginRendering, for the time of the call.
    let structure = unsafe { &*info };
    // Until the rendering is resumed, no command may come in between.
    if structure.flags.contains(vk::RenderingFlags::SUSPENDING)
        && !structure.flags.contains(vk::RenderingFlags::RESUMING)
    {
        // SAFETY: vkCmdBeginRendering is valid only in a command buffer that is recording, outside of render passes.
        unsafe { buffer.fill_all(handle) };
    }
    // SAFETY: the structure is that of vkCmdBeginRendering.
    let attachments = unsafe { rendering_attachments(&buffer.armed.objects, structure) };
    // SAFETY: as above.
    let loading = |_: DepthWork| unsafe { loading(structure) };
    let is_inline = !structure.flags.contains(vk::RenderingFlags::CONTENTS_SECONDARY_COMMAND_BUFFERS)
        || structure.flags.contains(vk::RenderingFlags::CONTENTS_INLINE_EXT);
    // SAFETY: vkCmdBeginRendering is valid only in a command buffer that is recording, outside of render passes.
    let (candidate, mask, depth) = unsafe {
        buffer.open_mask(masks, handle, pass, (&attachments, structure.render_area, is_inline), loading)
    };
    match depth {
        Some(depth) => begin(&vk::RenderingInfo { p_depth_attachment: &depth, ..*structure }),
        None => begin(info),
    }
    (candidate, mask)
}

/// An instance of dynamic rendering.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
unsafe fn instance(objects: &Objects, info: &vk::RenderingInfo<'_>) -> Pass {
    // SAFETY: valid usage demands so many valid structures.
    let colors = unsafe { slice(info.p_color_attachments, info.color_attachment_count) };
    let is_attached = |found: &&vk::RenderingAttachmentInfo<'_>| found.image_view != vk::ImageView::null();
    // SAFETY: valid usage demands that the pointer is null or to a valid structure.
    let depth = unsafe { info.p_depth_attachment.as_ref() }.filter(is_attached);
    // SAFETY: as for depth.
    let stencil = unsafe { info.p_stencil_attachment.as_ref() }.filter(is_attached);
    // SAFETY: valid usage demands a valid chain.
    let has_own_rates = unsafe { has_own_rates(info) };
    // Without multiview the pass draws to `layer_count` layers of each view, with multiview to the layers of the mask.
    let target = |view: vk::ImageView| -> Option<Target> {
        let mut target = objects.view(view)?.target;
        if info.view_mask == 0 {
            target.layers = target.layers.min(info.layer_count);
        }
        Some(target)
    };
    let suspended = vk::RenderingFlags::SUSPENDING | vk::RenderingFlags::RESUMING;
    Pass {
        colors: colors.iter().filter_map(|found| target(found.image_view)).collect(),
        resolves: colors
            .iter()
            .filter(|found| found.resolve_mode != vk::ResolveModeFlags::NONE)
            .filter_map(|found| target(found.resolve_image_view))
            .collect(),
        depth: depth.and_then(|found| target(found.image_view)),
        area: super::area(info.render_area),
        region: super::area(info.render_area),
        view_mask: info.view_mask,
        facts: PassFacts {
            loads_color: colors
                .iter()
                .find(is_attached)
                .is_some_and(|found| found.load_op == vk::AttachmentLoadOp::LOAD),
            clears_depth: depth.is_some_and(|found| found.load_op == vk::AttachmentLoadOp::CLEAR),
            stores_depth: depth.is_some_and(|found| found.store_op != vk::AttachmentStoreOp::DONT_CARE),
            resolves_depth: depth.into_iter().chain(stencil).any(|found| {
                found.resolve_mode != vk::ResolveModeFlags::NONE
                    && found.resolve_image_view != vk::ImageView::null()
            }),
            loads_stencil: stencil.is_some_and(|found| found.load_op == vk::AttachmentLoadOp::LOAD),
            has_own_rates,
            is_suspended: info.flags.intersects(suspended),
            ..PassFacts::default()
        },
        unmasked: None,
        draws: None,
    }
}

/// Whether dynamic rendering has rates of the application's own.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
unsafe fn has_own_rates(info: &vk::RenderingInfo<'_>) -> bool {
    // SAFETY: valid usage demands a valid chain.
    let (rates, density) = unsafe {
        (
            extension::<vk::RenderingFragmentShadingRateAttachmentInfoKHR<'_>>(info.p_next),
            extension::<vk::RenderingFragmentDensityMapAttachmentInfoEXT<'_>>(info.p_next),
        )
    };
    rates.is_some_and(|found| found.image_view != vk::ImageView::null())
        || density.is_some_and(|found| found.image_view != vk::ImageView::null())
}

/// The depth attachment, loaded.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
unsafe fn loading<'a>(info: &vk::RenderingInfo<'a>) -> Result<vk::RenderingAttachmentInfo<'a>, Unmasked> {
    // SAFETY: the structure is valid, by the valid usage of vkCmdBeginRendering: the pointer is null or valid.
    let depth = unsafe { info.p_depth_attachment.as_ref() }.ok_or(Unmasked::NoDepth)?;
    Ok(vk::RenderingAttachmentInfo { load_op: vk::AttachmentLoadOp::LOAD, ..*depth })
}
