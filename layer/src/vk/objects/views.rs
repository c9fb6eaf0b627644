//! Views of images.

use super::Objects;
use crate::pass_detection::Target;
use ash::vk;

/// A live view.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// The image, its first level and its layers in the view.
    pub target: Target,
    /// The view's format, which may be another than the image's.
    pub format: vk::Format,
    /// Whether passes may draw colours to the image that shaders read.
    pub is_colour_target: bool,
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
            is_colour_target: image.usage.contains(vk::ImageUsageFlags::COLOR_ATTACHMENT)
                && !image.description.is_cube,
        })
    }
}
