//! Images of a pass, as barriers and copies name them.

use super::attachments::DepthAttachment;
use crate::gpu::ImagePart;
use crate::pass_detection::{Target, Unmasked};
use crate::vk::objects::Objects;
use ash::vk;

/// Whether a layout is of depth alone, beside which stencil has one that barriers here do not name.
pub(super) fn is_separate(objects: &Objects, depth: &DepthAttachment) -> bool {
    let is_alone = |layout: &vk::ImageLayout| {
        matches!(
            *layout,
            vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL | vk::ImageLayout::DEPTH_READ_ONLY_OPTIMAL
        )
    };
    let has_stencil =
        aspects(objects, depth.target).is_ok_and(|aspects| aspects.contains(vk::ImageAspectFlags::STENCIL));
    has_stencil && (depth.layouts.iter().any(is_alone) || is_alone(&depth.final_layout))
}

/// A target as barriers and copies name it, as far as the mask has layers.
pub(super) fn part(
    objects: &Objects,
    target: Target,
    aspects: vk::ImageAspectFlags,
    layers: u32,
) -> Result<ImagePart, Unmasked> {
    let image = objects.image_of(target.image).ok_or(Unmasked::Unknown)?;
    if target.layers < layers {
        return Err(Unmasked::Unknown);
    }
    Ok(ImagePart {
        image: image.handle,
        aspects,
        level: target.level,
        first_layer: target.base_layer,
        layers,
    })
}

/// All aspects of a depth image: barriers without separate layouts name both.
pub(super) fn aspects(objects: &Objects, target: Target) -> Result<vk::ImageAspectFlags, Unmasked> {
    let format = objects.image_of(target.image).ok_or(Unmasked::Unknown)?.description.format;
    let depth = vk::ImageAspectFlags::DEPTH;
    Ok(match format {
        vk::Format::D16_UNORM_S8_UINT | vk::Format::D24_UNORM_S8_UINT | vk::Format::D32_SFLOAT_S8_UINT => {
            depth | vk::ImageAspectFlags::STENCIL
        }
        _ => depth,
    })
}
