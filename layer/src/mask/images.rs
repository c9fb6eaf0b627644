//! What images of the application get in addition, so that they can have a mask.

use super::depth_format;
use crate::passes::fill::{USAGE, fill_format};
use ash::vk;

/// Additions to an image that is created.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Additions {
    /// Usage.
    pub usage: vk::ImageUsageFlags,
    /// Flags.
    pub flags: vk::ImageCreateFlags,
    /// A format that it gets views of, besides its own.
    pub view_format: Option<vk::Format>,
}

/// What an image needs that is created like this; nothing where it can be neither depth nor colour of a masked pass. A
/// device may refuse it; then the image is created as the application asks, and its passes are left alone.
///
/// Whoever adds to the usage limits the application's own views to what it asked for (VkImageViewUsageCreateInfo), as the
/// format of a view has to support all of the usage.
pub fn additions(info: &vk::ImageCreateInfo<'_>) -> Option<Additions> {
    let plain = info.image_type == vk::ImageType::TYPE_2D
        && info.tiling == vk::ImageTiling::OPTIMAL
        && info.samples == vk::SampleCountFlags::TYPE_1
        && !info.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT)
        && !info.flags.intersects(
            vk::ImageCreateFlags::PROTECTED
                | vk::ImageCreateFlags::SPARSE_BINDING
                | vk::ImageCreateFlags::CUBE_COMPATIBLE
                | vk::ImageCreateFlags::DISJOINT,
        );
    if !plain {
        return None;
    }
    let is_depth = info.usage.contains(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
    if is_depth && depth_format(info.format).is_some() {
        let usage = vk::ImageUsageFlags::TRANSFER_DST;
        return Some(Additions { usage, flags: vk::ImageCreateFlags::empty(), view_format: None });
    }
    let is_color = info.usage.contains(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    let (_, view) = fill_format(info.format).filter(|_| is_color)?;
    let own = view == info.format;
    let flags = if own {
        vk::ImageCreateFlags::empty()
    } else {
        vk::ImageCreateFlags::MUTABLE_FORMAT | vk::ImageCreateFlags::EXTENDED_USAGE
    };
    Some(Additions { usage: USAGE, flags, view_format: Some(view).filter(|_| !own) })
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

    #[test]
    fn targets_get_what_the_mask_needs() {
        let depth = additions(&image(vk::Format::D24_UNORM_S8_UINT, DEPTH)).unwrap();
        assert_eq!((depth.usage, depth.view_format), (vk::ImageUsageFlags::TRANSFER_DST, None));
        let color = additions(&image(vk::Format::B8G8R8A8_SRGB, COLOR)).unwrap();
        assert_eq!(
            (color.usage, color.view_format),
            (vk::ImageUsageFlags::STORAGE, Some(vk::Format::R32_UINT))
        );
        assert!(
            color.flags.contains(vk::ImageCreateFlags::MUTABLE_FORMAT | vk::ImageCreateFlags::EXTENDED_USAGE)
        );
        let float = additions(&image(vk::Format::R16G16B16A16_SFLOAT, COLOR)).unwrap();
        assert_eq!((float.flags, float.view_format), (vk::ImageCreateFlags::empty(), None));
    }

    #[test]
    fn other_images_stay_as_they_are() {
        let sampled = image(vk::Format::R8G8B8A8_SRGB, vk::ImageUsageFlags::SAMPLED);
        assert_eq!(additions(&sampled), None);
        assert_eq!(additions(&image(vk::Format::R32_UINT, COLOR)), None);
        assert_eq!(additions(&image(vk::Format::S8_UINT, DEPTH)), None);
        let color = || image(vk::Format::R8G8B8A8_SRGB, COLOR);
        for changed in [
            color().samples(vk::SampleCountFlags::TYPE_4),
            color().tiling(vk::ImageTiling::LINEAR),
            color().image_type(vk::ImageType::TYPE_3D),
            color().flags(vk::ImageCreateFlags::PROTECTED),
            color().flags(vk::ImageCreateFlags::CUBE_COMPATIBLE),
            color().usage(COLOR | vk::ImageUsageFlags::TRANSIENT_ATTACHMENT),
        ] {
            assert_eq!(additions(&changed), None);
        }
    }
}
