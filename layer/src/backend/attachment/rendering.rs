//! Dynamic rendering: colour passes get a rate attachment where they begin.

use super::capabilities::RateCapabilities;
use super::render_pass::LeftAlone;
use crate::abi::copies::{Copies, find, slice};
use ash::vk;

type Rates<'a> = vk::RenderingFragmentShadingRateAttachmentInfoKHR<'a>;

/// Whether a pass may get rates of ours: it draws colour, and has no rate attachment of the application's. A structure
/// without a view is none (vkd3d-proton chains one in every pass).
///
/// # Errors
///
/// Reason why it is left alone.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCmdBeginRendering).
pub unsafe fn wants_rates(info: &vk::RenderingInfo<'_>) -> Result<(), LeftAlone> {
    // SAFETY: valid usage demands a valid chain, and so many colours.
    unsafe {
        let own = find::<Rates<'_>>(info.p_next);
        let density = find::<vk::RenderingFragmentDensityMapAttachmentInfoEXT<'_>>(info.p_next);
        if own.is_some_and(|own| own.image_view != vk::ImageView::null())
            || density.is_some_and(|density| density.image_view != vk::ImageView::null())
        {
            return Err(LeftAlone::OwnRates);
        }
        let colours = slice(info.p_color_attachments, info.color_attachment_count);
        if colours.iter().all(|colour| colour.image_view == vk::ImageView::null()) {
            return Err(LeftAlone::NoColour);
        }
    }
    Ok(())
}

/// Whether a pass is a part of one that goes on in several command buffers.
pub fn is_suspended(info: &vk::RenderingInfo<'_>) -> bool {
    info.flags.intersects(vk::RenderingFlags::SUSPENDING | vk::RenderingFlags::RESUMING)
}

/// The pass with a view of a rate image attached.
///
/// # Safety
///
/// `info` and its chain are valid and outlive `copies`, and the chain is not used elsewhere meanwhile. The result points to memory of both.
pub unsafe fn with_view<'c>(
    info: &vk::RenderingInfo<'c>,
    view: vk::ImageView,
    capabilities: &RateCapabilities,
    copies: &mut Copies<'_>,
) -> vk::RenderingInfo<'c> {
    let fill = |rates: &mut Rates<'_>| {
        rates.image_view = view;
        rates.image_layout = vk::ImageLayout::FRAGMENT_SHADING_RATE_ATTACHMENT_OPTIMAL_KHR;
        rates.shading_rate_attachment_texel_size = capabilities.texel_size();
    };
    // SAFETY: the chain is valid, as `# Safety` demands.
    let p_next = unsafe {
        if find::<Rates<'_>>(info.p_next).is_some() {
            copies.amend::<Rates<'_>>(info.p_next, fill)
        } else {
            let mut rates = Rates { p_next: info.p_next, ..Default::default() };
            fill(&mut rates);
            copies.one(rates).cast_const().cast()
        }
    };
    vk::RenderingInfo { p_next, ..*info }
}

#[cfg(test)]
mod tests;
