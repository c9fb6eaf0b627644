//! Usage that images of the application get in addition, so that they can have a mask.

use crate::backend::mask::{FillKind, depth_format};
use crate::kernels::fill::USAGE;
use crate::kernels::{nearest, samples};
use ash::vk;

/// The usage that an image with this description needs, besides the application's; empty if it can be neither depth nor colour of a masked
/// pass. A device may refuse it; then the image is created as the application asks, and its passes are left alone.
pub fn added_usage(info: &vk::ImageCreateInfo<'_>) -> vk::ImageUsageFlags {
    let plain = info.image_type == vk::ImageType::TYPE_2D
        && info.tiling == vk::ImageTiling::OPTIMAL
        && !info.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT)
        && !info.flags.intersects(
            vk::ImageCreateFlags::PROTECTED
                | vk::ImageCreateFlags::SPARSE_BINDING
                | vk::ImageCreateFlags::CUBE_COMPATIBLE
                | vk::ImageCreateFlags::DISJOINT,
        );
    let is_depth = info.usage.contains(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
    let is_color = info.usage.contains(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    let added = if plain && is_depth && depth_format(info.format).is_some() {
        nearest::USAGE
    } else if plain && is_color && FillKind::of(info.format, info.samples).is_some() {
        match info.samples {
            vk::SampleCountFlags::TYPE_1 => USAGE,
            _ => samples::USAGE,
        }
    } else {
        vk::ImageUsageFlags::empty()
    };
    added & !info.usage
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(format: vk::Format, usage: vk::ImageUsageFlags) -> vk::ImageCreateInfo<'static> {
        vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .tiling(vk::ImageTiling::OPTIMAL)
            .samples(vk::SampleCountFlags::TYPE_1)
            .format(format)
            .usage(usage)
    }

    const COLOR: vk::ImageUsageFlags = vk::ImageUsageFlags::COLOR_ATTACHMENT;
    const DEPTH: vk::ImageUsageFlags = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    const NONE: vk::ImageUsageFlags = vk::ImageUsageFlags::empty();

    #[test]
    fn targets_get_what_the_mask_needs() {
        let target = image(vk::Format::D24_UNORM_S8_UINT, DEPTH);
        assert_eq!(added_usage(&target), nearest::USAGE);
        let several = target.samples(vk::SampleCountFlags::TYPE_4);
        assert_eq!(added_usage(&several), nearest::USAGE);
        let color = image(vk::Format::B8G8R8A8_SRGB, COLOR);
        assert_eq!(added_usage(&color), USAGE);
        assert_eq!(added_usage(&color.samples(vk::SampleCountFlags::TYPE_4)), samples::USAGE);
        assert_eq!(added_usage(&image(vk::Format::R16G16_SFLOAT, COLOR)), USAGE);
        let read = image(vk::Format::R16G16B16A16_SFLOAT, COLOR | vk::ImageUsageFlags::TRANSFER_SRC);
        assert_eq!(added_usage(&read), vk::ImageUsageFlags::TRANSFER_DST);
    }

    #[test]
    fn other_images_stay_as_they_are() {
        let sampled = image(vk::Format::R8G8B8A8_SRGB, vk::ImageUsageFlags::SAMPLED);
        assert_eq!(added_usage(&sampled), NONE);
        let indices = image(vk::Format::R32_UINT, COLOR).samples(vk::SampleCountFlags::TYPE_4);
        assert_eq!(added_usage(&indices), NONE);
        assert_eq!(added_usage(&image(vk::Format::S8_UINT, DEPTH)), NONE);
        let color = || image(vk::Format::R8G8B8A8_SRGB, COLOR);
        for changed in [
            color().tiling(vk::ImageTiling::LINEAR),
            color().image_type(vk::ImageType::TYPE_3D),
            color().flags(vk::ImageCreateFlags::PROTECTED),
            color().flags(vk::ImageCreateFlags::CUBE_COMPATIBLE),
            color().usage(COLOR | vk::ImageUsageFlags::TRANSIENT_ATTACHMENT),
        ] {
            assert_eq!(added_usage(&changed), NONE);
        }
    }
}
