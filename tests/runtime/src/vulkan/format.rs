//! Formats of swapchains, and which usage OpenXR's flags mean.

use crate::fault::{Fault, section};
use ash::vk;
use openxr_sys as xr;
use openxr_sys::SwapchainUsageFlags as Usage;

/// Colour formats on offer, the preferred first.
pub(crate) const COLOUR: [vk::Format; 6] = [
    vk::Format::R8G8B8A8_SRGB,
    vk::Format::B8G8R8A8_SRGB,
    vk::Format::R8G8B8A8_UNORM,
    vk::Format::B8G8R8A8_UNORM,
    vk::Format::R16G16B16A16_SFLOAT,
    vk::Format::A2B10G10R10_UNORM_PACK32,
];

/// Depth formats on offer where the device has them, the preferred first.
pub(crate) const DEPTH: [vk::Format; 3] =
    [vk::Format::D32_SFLOAT, vk::Format::D24_UNORM_S8_UINT, vk::Format::D32_SFLOAT_S8_UINT];

/// The runtime's own usage of an image: the compositor samples it.
pub(crate) const OWN_USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::SAMPLED;

pub(crate) fn is_depth(format: vk::Format) -> bool {
    DEPTH.contains(&format)
}

/// Parts of an image of this format.
pub(crate) fn aspects(format: vk::Format) -> vk::ImageAspectFlags {
    match format {
        vk::Format::D32_SFLOAT => vk::ImageAspectFlags::DEPTH,
        vk::Format::D24_UNORM_S8_UINT | vk::Format::D32_SFLOAT_S8_UINT => {
            vk::ImageAspectFlags::DEPTH | vk::ImageAspectFlags::STENCIL
        }
        _ => vk::ImageAspectFlags::COLOR,
    }
}

/// Whether a view of format `view` may be made of an image of format `image` (Vulkan, "Format Compatibility Classes").
pub(crate) fn compatible(image: vk::Format, view: vk::Format) -> bool {
    image == view || class(image).is_some_and(|image| class(view) == Some(image))
}

/// Bits of a texel, for formats whose views may have other formats: those on offer, and their integer relatives.
fn class(format: vk::Format) -> Option<u32> {
    match format.as_raw() {
        // VK_FORMAT_R8G8B8A8_UNORM to VK_FORMAT_A2B10G10R10_SINT_PACK32: 8 and 10 bits a channel.
        37..=69 => Some(32),
        // VK_FORMAT_R16G16_* and VK_FORMAT_R32_*.
        77..=83 | 98..=100 => Some(32),
        // VK_FORMAT_R16G16B16A16_* and VK_FORMAT_R32G32_*.
        91..=97 | 101..=103 => Some(64),
        _ => None,
    }
}

/// The Vulkan usage that OpenXR's flags ask for, in the order of their bits.
const USAGES: [(Usage, vk::ImageUsageFlags); 6] = [
    (Usage::COLOR_ATTACHMENT, vk::ImageUsageFlags::COLOR_ATTACHMENT),
    (Usage::DEPTH_STENCIL_ATTACHMENT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT),
    (Usage::UNORDERED_ACCESS, vk::ImageUsageFlags::STORAGE),
    (Usage::TRANSFER_SRC, vk::ImageUsageFlags::TRANSFER_SRC),
    (Usage::TRANSFER_DST, vk::ImageUsageFlags::TRANSFER_DST),
    (Usage::SAMPLED, vk::ImageUsageFlags::SAMPLED),
];

/// Exactly the usage that the application requested: other usage must fail here, too.
pub(crate) fn usage(format: vk::Format, flags: Usage) -> Result<vk::ImageUsageFlags, Fault> {
    let known = USAGES.iter().fold(Usage::MUTABLE_FORMAT, |all, (flag, _)| all | *flag);
    let (wrong, kind) = match is_depth(format) {
        true => (Usage::COLOR_ATTACHMENT, "depth"),
        false => (Usage::DEPTH_STENCIL_ATTACHMENT, "colour"),
    };
    if flags.intersects(wrong) || !known.contains(flags) {
        let message =
            format!("usageFlags {:#x} do not go with the {kind} format {format:?}", flags.into_raw());
        return Err(Fault::new(xr::Result::ERROR_FEATURE_UNSUPPORTED, section::SWAPCHAINS, message));
    }
    let asked = USAGES.iter().filter(|(flag, _)| flags.contains(*flag));
    Ok(asked.fold(vk::ImageUsageFlags::empty(), |all, (_, usage)| all | *usage))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_of_other_formats_need_texels_of_the_same_size() {
        assert!(compatible(vk::Format::R8G8B8A8_SRGB, vk::Format::R8G8B8A8_UNORM));
        assert!(compatible(vk::Format::A2B10G10R10_UNORM_PACK32, vk::Format::R32_UINT));
        assert!(!compatible(vk::Format::R8G8B8A8_SRGB, vk::Format::R16G16B16A16_SFLOAT));
        assert!(!compatible(vk::Format::D32_SFLOAT, vk::Format::R32_SFLOAT));
    }

    #[test]
    fn usage_is_what_was_asked_for() {
        let asked = Usage::COLOR_ATTACHMENT | Usage::TRANSFER_DST | Usage::MUTABLE_FORMAT;
        let granted = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
        assert_eq!(usage(vk::Format::R8G8B8A8_SRGB, asked).unwrap(), granted);
        assert!(usage(vk::Format::D32_SFLOAT, Usage::COLOR_ATTACHMENT).is_err());
        assert!(usage(vk::Format::R8G8B8A8_SRGB, Usage::from_raw(1 << 20)).is_err());
    }
}
