//! Images of a pass, as barriers and copies name them.

use super::attachments::DepthAttachment;
use crate::gpu::ImagePart;
use crate::pass_detection::{Target, Unmasked};
use crate::vk::objects::Objects;
use ash::vk;

/// Whether stencil beside depth of this format has a layout of its own, which barriers here do not name.
pub(super) fn is_separate(format: vk::Format, depth: &DepthAttachment) -> bool {
    let is_of_both = |layout: vk::ImageLayout| !is_of_depth_alone(layout, format);
    let [before, within] = depth.layouts;
    within == vk::ImageLayout::UNDEFINED || ![before, within, depth.final_layout].into_iter().all(is_of_both)
}

/// Whether stencil of this format needs a second layout beside this one, of depth (Vulkan specification,
/// VUID-VkAttachmentDescription2-format-06906).
pub(super) fn is_of_depth_alone(layout: vk::ImageLayout, format: vk::Format) -> bool {
    let is_alone = matches!(
        layout,
        vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL | vk::ImageLayout::DEPTH_READ_ONLY_OPTIMAL
    );
    is_alone && aspects_of(format).contains(vk::ImageAspectFlags::STENCIL)
}

/// A target as barriers and copies name it, as far as the mask has layers. Copies have the `extent` of the mask, which is that of the pass's
/// first colour image; the other images may be smaller, as long as the render area is within them.
pub(super) fn part(
    objects: &Objects,
    target: Target,
    aspects: vk::ImageAspectFlags,
    (extent, layers): ([u32; 2], u32),
) -> Result<ImagePart, Unmasked> {
    let image = objects.image_of(target.image).ok_or(Unmasked::Unknown)?;
    if target.layers < layers {
        return Err(Unmasked::Unknown);
    }
    let has_room = |axis: usize| image.description.extent[axis] >> target.level >= extent[axis];
    if !has_room(0) || !has_room(1) {
        return Err(Unmasked::Area);
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
    Ok(aspects_of(objects.image_of(target.image).ok_or(Unmasked::Unknown)?.description.format))
}

fn aspects_of(format: vk::Format) -> vk::ImageAspectFlags {
    let depth = vk::ImageAspectFlags::DEPTH;
    match format {
        vk::Format::D16_UNORM_S8_UINT | vk::Format::D24_UNORM_S8_UINT | vk::Format::D32_SFLOAT_S8_UINT => {
            depth | vk::ImageAspectFlags::STENCIL
        }
        _ => depth,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vk::objects::Image;
    use ash::vk::Handle;

    /// Copies of the mask's size must be within all images: Vulkan specification, VUID-vkCmdCopyImage-dstOffset-00150.
    #[test]
    fn an_image_that_is_smaller_than_the_mask_is_refused() {
        let objects = Objects::default();
        let info = vk::ImageCreateInfo::default()
            .extent(vk::Extent3D { width: 64, height: 48, depth: 1 })
            .array_layers(2)
            .samples(vk::SampleCountFlags::TYPE_1);
        let image = Image::created(vk::Image::from_raw(1), &info, vk::ImageUsageFlags::COLOR_ATTACHMENT);
        objects.add_image(image);
        let of = |extent, level| {
            let target = Target { image: image.description.key, level, base_layer: 0, layers: 2 };
            part(&objects, target, vk::ImageAspectFlags::COLOR, (extent, 2)).map(|part| part.level)
        };
        for (extent, level) in [([64, 48], 0), ([32, 20], 0), ([32, 24], 1)] {
            assert_eq!(of(extent, level), Ok(level));
        }
        for (extent, level) in [([65, 48], 0), ([64, 49], 0), ([33, 24], 1)] {
            assert_eq!(of(extent, level), Err(Unmasked::Area), "{extent:?} of level {level}");
        }
    }
}
