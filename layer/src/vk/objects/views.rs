//! Views of images.

use super::{Image, Objects};
use crate::pass_detection::{ImageDescription, Target, holds_colours};
use ash::vk;

/// A live view.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// The image, its first level and its layers in the view.
    pub target: Target,
    /// The view's format, which may be another than the image's.
    pub format: vk::Format,
    /// Whether the image may hold a picture of the frame: passes draw colours to it, or compute may write it and it is large.
    pub may_hold_picture: bool,
}

impl View {
    /// The view that a call creates; `None` for a view of an unknown image.
    pub fn created(objects: &Objects, info: &vk::ImageViewCreateInfo<'_>) -> Option<Self> {
        let image = objects.image(info.image)?;
        let range = info.subresource_range;
        let rest = image.description.layers.saturating_sub(range.base_array_layer);
        Some(Self {
            target: Target {
                image: image.description.key,
                level: range.base_mip_level,
                base_layer: range.base_array_layer,
                layers: if range.layer_count == vk::REMAINING_ARRAY_LAYERS {
                    rest
                } else {
                    range.layer_count
                },
            },
            format: info.format,
            may_hold_picture: may_hold_picture(&image, info.view_type),
        })
    }
}

/// Least side of a picture that compute writes, pixels: tables are smaller.
const LEAST_PICTURE: u32 = 64;

fn may_hold_picture(image: &Image, kind: vk::ImageViewType) -> bool {
    let ImageDescription { extent, format, is_cube, .. } = image.description;
    let is_drawn = image.usage.contains(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    let is_large = extent.iter().all(|side| *side >= LEAST_PICTURE);
    let is_flat = matches!(kind, vk::ImageViewType::TYPE_2D | vk::ImageViewType::TYPE_2D_ARRAY);
    let is_computed =
        image.usage.contains(vk::ImageUsageFlags::STORAGE) && is_flat && is_large && holds_colours(format);
    !is_cube && (is_drawn || is_computed)
}
