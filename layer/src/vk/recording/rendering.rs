//! Dynamic rendering.

use super::passes::end_tracked;
use super::{drawing, draws, timed, with_buffer};
use crate::abi::guard;
use crate::backend::mask::{DepthWork, rendering_attachments};
use crate::pass_detection::{Pass, PassFacts, Target, Unmasked};
use crate::vk::chain::extension;
use crate::vk::objects::Objects;
use ash::vk;
use std::slice;

/// `vkCmdBeginRendering`.
pub unsafe extern "system" fn begin(handle: vk::CommandBuffer, info: *const vk::RenderingInfo<'_>) {
    // SAFETY: the application's own arguments; `info` is valid.
    guard(
        "vkCmdBeginRendering",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_begin_rendering(handle, info), ()) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_begin_rendering) else { return };
            let begin = |info: *const vk::RenderingInfo<'_>| {
                next(handle, info);
                answer.made();
            };
            let Some(known) = known.filter(|known| known.armed.follows_passes()) else { return begin(info) };
            let armed = &known.armed;
            let mut pass = instance(&armed.objects, &*info);
            timed::pass_begins(&known, handle, Some(&pass));
            let mut mask = None;
            let candidate = match (&armed.rate_attachments, &armed.masks) {
                (Some(rates), _) => {
                    let image = rates.begin_rendering(info, armed.objects.first_color(&pass), begin);
                    image.map(|image| armed.candidates.with_map(image.key.target, image))
                }
                (None, Some(masks)) => {
                    let attachments = rendering_attachments(&armed.objects, &*info);
                    let candidate = known.candidate(&pass, &attachments);
                    let area = (*info).render_area;
                    let covering = known.covering(attachments.depth.map(|depth| depth.target.image));
                    let context = known.context(area, &attachments, covering.as_ref());
                    match masks.begin_pass(
                        handle,
                        candidate.as_ref().map(|candidate| (candidate.target, candidate.mask())),
                        &mut pass,
                        &attachments,
                        context,
                        (
                            |_: DepthWork| loading(&*info),
                            |mask: Option<&_>| known.settle(handle, &attachments, area, mask),
                        ),
                    ) {
                        Some((open, Some(depth))) => {
                            begin(&vk::RenderingInfo { p_depth_attachment: &depth, ..*info });
                            mask = Some(open);
                        }
                        Some((open, None)) => {
                            begin(info);
                            mask = Some(open);
                        }
                        None => begin(info),
                    }
                    candidate
                }
                (None, None) => {
                    begin(info);
                    None
                }
            };
            known.recorded().begin(Some(pass), candidate, mask);
            draws::pass_begins(&known, handle);
            drawing::pass_begins(&known, handle);
        },
    );
}

/// `vkCmdEndRendering`.
pub unsafe extern "system" fn end(handle: vk::CommandBuffer) {
    // SAFETY: the application's own argument.
    guard(
        "vkCmdEndRendering",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(with_buffer: handle, cmd_end_rendering(handle), ()) },
        |answer| unsafe {
            let Some((known, next)) = with_buffer(handle, |next| next.cmd_end_rendering) else { return };
            next(handle);
            answer.made();
            if let Some(known) = known {
                end_tracked(&known, handle);
            }
        },
    );
}

/// An instance of dynamic rendering.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
unsafe fn instance(objects: &Objects, info: &vk::RenderingInfo<'_>) -> Pass {
    // SAFETY: the caller vouches for the structure, its arrays and its chain.
    let (colors, depth, stencil, has_own_rates) = unsafe {
        let colors = match info.color_attachment_count {
            0 => &[][..],
            count => slice::from_raw_parts(info.p_color_attachments, count as usize),
        };
        let is_attached =
            |found: &&vk::RenderingAttachmentInfo<'_>| found.image_view != vk::ImageView::null();
        let has_rates = extension::<vk::RenderingFragmentShadingRateAttachmentInfoKHR<'_>>(info.p_next)
            .is_some_and(|found| found.image_view != vk::ImageView::null());
        let has_density =
            extension::<vk::RenderingFragmentDensityMapAttachmentInfoEXT<'_>>(info.p_next).is_some();
        (
            colors,
            info.p_depth_attachment.as_ref().filter(is_attached),
            info.p_stencil_attachment.as_ref().filter(is_attached),
            has_rates || has_density,
        )
    };
    // Without multiview the pass draws to `layer_count` layers of each view, and with it to those of the mask.
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
        view_mask: info.view_mask,
        facts: PassFacts {
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
