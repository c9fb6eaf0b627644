//! Render passes: each subpass that draws colour gets the rate attachment.

mod version1;

pub use version1::convert;

use super::capabilities::RateCapabilities;
use crate::abi::copies::{Copies, find, slice};
use crate::pass_detection::holds_colours;
use ash::vk;

/// The additions to a render pass, and to each that is compatible with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddedRates {
    /// Index of the rate attachment, which is the last.
    pub attachment: u32,
    /// Layers that a layered rate attachment needs for the views of multiview; 0 without multiview.
    pub views: u32,
}

/// Reason why a render pass is left alone. Each is a property that compatible render passes share, so that pipelines and
/// framebuffers, which are made for one and used with another, go on fitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LeftAlone {
    /// No subpass draws colour.
    #[error("it draws no colour")]
    NoColour,
    /// It has a rate attachment of the application's.
    #[error("it sets its own shading rates")]
    OwnRates,
    /// A structure that we do not know how to convert.
    #[error("it has a structure of the unknown type {0:?}")]
    Unknown(vk::StructureType),
}

/// The render pass with a rate attachment added, which is loaded, and in the layout for rates throughout.
///
/// With `needs_depth`, only subpasses with depth get it, as the scene's have: there each attachment costs time, even one of 1x1 everywhere.
/// Compatible render passes have depth in the same subpasses.
///
/// # Errors
///
/// Reason why it is left alone.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateRenderPass2). The result points to memory of `info` and of `copies`.
pub unsafe fn with_rates<'c>(
    info: &vk::RenderPassCreateInfo2<'c>,
    capabilities: &RateCapabilities,
    needs_depth: bool,
    copies: &mut Copies<'_>,
) -> Result<(vk::RenderPassCreateInfo2<'c>, AddedRates), LeftAlone> {
    // SAFETY: valid usage demands so many attachments and subpasses.
    let (attachments, subpasses) = unsafe {
        (slice(info.p_attachments, info.attachment_count), slice(info.p_subpasses, info.subpass_count))
    };
    // SAFETY: valid usage demands valid subpasses.
    if subpasses.iter().any(|subpass| unsafe { has_own_rates(subpass) }) {
        return Err(LeftAlone::OwnRates);
    }
    // SAFETY: as above.
    let may_be_scene = |subpass: &vk::SubpassDescription2<'_>| unsafe {
        draws_colour(subpass) && (!needs_depth || has_depth(subpass))
    };
    if !subpasses.iter().any(may_be_scene) {
        return Err(LeftAlone::NoColour);
    }
    let index = info.attachment_count;
    let reference = vk::AttachmentReference2::default()
        .attachment(index)
        .layout(vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR);
    let reference = (index, copies.one(reference).cast_const());
    // SAFETY: as above.
    let is_post = |number: usize| unsafe { is_post_processing(number, subpasses, attachments) };
    let attached: Vec<_> = (0..)
        .zip(subpasses)
        // SAFETY: as above.
        .map(|(number, subpass)| unsafe {
            let is_attached = may_be_scene(subpass) && !is_post(number);
            attach((subpass, is_attached), reference, capabilities, copies)
        })
        .collect();
    let all: Vec<_> = attachments.iter().copied().chain([rate_attachment()]).collect();
    let views = subpasses.iter().fold(0, |all, subpass| all | subpass.view_mask);
    let amended = vk::RenderPassCreateInfo2 {
        attachment_count: index + 1,
        p_attachments: copies.many(all.iter().copied()),
        p_subpasses: copies.many(attached.iter().copied()),
        ..*info
    };
    Ok((amended, AddedRates { attachment: index, views: u32::BITS - views.leading_zeros() }))
}

/// The rate attachment: never written by a render pass, so that it is loaded and kept.
fn rate_attachment() -> vk::AttachmentDescription2<'static> {
    let layout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
    vk::AttachmentDescription2::default()
        .format(super::FORMAT)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::LOAD)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(layout)
        .final_layout(layout)
}

/// A subpass with the rate attachment, which is given by its number and a reference, if it is to be attached; others preserve its content.
///
/// # Safety
///
/// The subpass is valid.
unsafe fn attach<'c>(
    (subpass, is_attached): (&vk::SubpassDescription2<'c>, bool),
    (index, reference): (u32, *const vk::AttachmentReference2<'c>),
    capabilities: &RateCapabilities,
    copies: &mut Copies<'_>,
) -> vk::SubpassDescription2<'c> {
    type Rates<'a> = vk::FragmentShadingRateAttachmentInfoKHR<'a>;
    let mut attached = *subpass;
    // SAFETY: the subpass is valid, as `# Safety` demands, with so many preserved attachments.
    let preserved = unsafe { slice(subpass.p_preserve_attachments, subpass.preserve_attachment_count) };
    if !is_attached {
        let all: Vec<u32> = preserved.iter().copied().chain([index]).collect();
        attached.p_preserve_attachments = copies.many(all.iter().copied());
        attached.preserve_attachment_count = all.len() as u32;
        return attached;
    }
    let fill = |rates: &mut Rates<'_>| {
        rates.p_fragment_shading_rate_attachment = reference.cast();
        rates.shading_rate_attachment_texel_size = capabilities.texel_size();
    };
    // SAFETY: the chain is valid, as `# Safety` demands.
    attached.p_next = unsafe {
        if find::<Rates<'_>>(subpass.p_next).is_some() {
            copies.amend::<Rates<'_>>(subpass.p_next, fill)
        } else {
            let mut rates = Rates { p_next: subpass.p_next, ..Default::default() };
            fill(&mut rates);
            copies.one(rates).cast_const().cast()
        }
    };
    attached
}

/// Whether a subpass has depth or stencil.
///
/// # Safety
///
/// The subpass is valid.
unsafe fn has_depth(subpass: &vk::SubpassDescription2<'_>) -> bool {
    // SAFETY: the pointer is null or valid, as `# Safety` demands.
    unsafe { subpass.p_depth_stencil_attachment.as_ref() }
        .is_some_and(|depth| depth.attachment != vk::ATTACHMENT_UNUSED)
}

/// Whether a subpass without depth reads nothing but one picture of an earlier subpass: it maps tones, as the second subpass of Godot's
/// and Unreal's mobile renderers does, and coarse rates would only lose detail. A G-buffer has several images, and a visibility buffer no colours.
///
/// # Safety
///
/// The subpasses are valid.
unsafe fn is_post_processing(
    number: usize,
    subpasses: &[vk::SubpassDescription2<'_>],
    attachments: &[vk::AttachmentDescription2<'_>],
) -> bool {
    let used = |reference: &vk::AttachmentReference2<'_>| reference.attachment != vk::ATTACHMENT_UNUSED;
    let subpass = &subpasses[number];
    // SAFETY: a valid subpass has so many references, or null.
    let (inputs, depth) = unsafe {
        let inputs = slice(subpass.p_input_attachments, subpass.input_attachment_count);
        (inputs, subpass.p_depth_stencil_attachment.as_ref())
    };
    let mut inputs = inputs.iter().filter(|input| used(input));
    let (Some(input), None) = (inputs.next(), inputs.next()) else { return false };
    let is_drawn = |earlier: &vk::SubpassDescription2<'_>| {
        // SAFETY: as above.
        let colours = unsafe { slice(earlier.p_color_attachments, earlier.color_attachment_count) };
        colours.iter().any(|colour| colour.attachment == input.attachment)
    };
    let holds_colours =
        attachments.get(input.attachment as usize).is_some_and(|input| holds_colours(input.format));
    !depth.is_some_and(used) && holds_colours && subpasses[..number].iter().any(is_drawn)
}

/// Whether a subpass has a rate attachment of the application's.
///
/// # Safety
///
/// The subpass is valid.
unsafe fn has_own_rates(subpass: &vk::SubpassDescription2<'_>) -> bool {
    // SAFETY: the subpass and its chain are valid, as `# Safety` demands.
    unsafe {
        find::<vk::FragmentShadingRateAttachmentInfoKHR<'_>>(subpass.p_next)
            .and_then(|rates| rates.p_fragment_shading_rate_attachment.as_ref())
            .is_some_and(|reference| reference.attachment != vk::ATTACHMENT_UNUSED)
    }
}

/// Whether a subpass has a colour attachment.
///
/// # Safety
///
/// The subpass is valid.
unsafe fn draws_colour(subpass: &vk::SubpassDescription2<'_>) -> bool {
    // SAFETY: a valid subpass has so many references.
    let colours = unsafe { slice(subpass.p_color_attachments, subpass.color_attachment_count) };
    colours.iter().any(|colour| colour.attachment != vk::ATTACHMENT_UNUSED)
}

#[cfg(test)]
mod tests;
