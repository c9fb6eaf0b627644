//! Selection of the rectangles of a swapchain that are processed: shown by projection views, and by nothing else.

use crate::inputs::gaze::in_view;
use crate::kernels::compose::{ComposeParams, ComposeRegion};
use crate::xr::submission::ProjectionView;
use ash::vk;
use openxr_sys as xr;
use parafovea_core::chroma::{ChromaSettings, Focus};
use smallvec::SmallVec;

/// Properties of a swapchain's images, for a region of them.
#[derive(Debug, Clone, Copy)]
pub struct Images {
    /// Size, pixels.
    pub extent: vk::Extent2D,
    /// Number of array layers.
    pub array_layers: u32,
    /// Whether they store values from 0 to 1 only.
    pub is_unit_range: bool,
}

/// The region of an image that a view shows, with a focus in the space of its layer. `None` for a rectangle that is not
/// within the image, and other values that the runtime refuses.
pub fn region(
    view: &ProjectionView,
    images: &Images,
    focus: Focus,
    chroma: &ChromaSettings,
) -> Option<ComposeRegion> {
    let rect = rect_within(&view.sub_image, images)?;
    let offset = [rect.offset.x as u32, rect.offset.y as u32];
    let extent = [rect.extent.width, rect.extent.height];
    let focus = Focus { direction: in_view(focus.direction, view.orientation?), ..focus };
    let params = ComposeParams::new(offset, extent, view.fov, focus.direction, chroma, images.is_unit_range);
    Some(ComposeRegion {
        array_layer: view.sub_image.image_array_index,
        rect,
        params: params.following(focus),
    })
}

/// The rectangle of a view, if it is within the images.
pub fn rect_within(image: &xr::SwapchainSubImage, images: &Images) -> Option<vk::Rect2D> {
    let rect = vulkan_rect(image)?;
    let fits = |offset: i32, length: u32, limit: u32| {
        length > 0
            && u32::try_from(offset)
                .ok()
                .and_then(|from| from.checked_add(length))
                .is_some_and(|to| to <= limit)
    };
    let is_within = image.image_array_index < images.array_layers
        && fits(rect.offset.x, rect.extent.width, images.extent.width)
        && fits(rect.offset.y, rect.extent.height, images.extent.height);
    is_within.then_some(rect)
}

fn vulkan_rect(image: &xr::SwapchainSubImage) -> Option<vk::Rect2D> {
    let xr::Rect2Di { offset, extent } = image.image_rect;
    Some(vk::Rect2D {
        offset: vk::Offset2D { x: offset.x, y: offset.y },
        extent: vk::Extent2D {
            width: u32::try_from(extent.width).ok()?,
            height: u32::try_from(extent.height).ok()?,
        },
    })
}

/// Removes the regions whose pixels are also seen otherwise: through another layer's rectangle, or by another
/// view with other parameters. Those pixels stay as the application drew them. Views that agree in everything
/// become one region.
pub fn drop_contested<'a>(
    regions: &mut Vec<ComposeRegion>,
    others: impl Iterator<Item = &'a xr::SwapchainSubImage> + Clone,
) {
    let agree = |a: &ComposeRegion, b: &ComposeRegion| {
        a.array_layer == b.array_layer
            && a.rect == b.rect
            && bytemuck::bytes_of(&a.params) == bytemuck::bytes_of(&b.params)
    };
    regions.dedup_by(|a, b| agree(a, b));
    let is_contested = |region: &ComposeRegion| {
        let by_view = regions.iter().any(|other| {
            !agree(region, other)
                && region.array_layer == other.array_layer
                && overlap(region.rect, other.rect)
        });
        let by_other = others.clone().any(|image| {
            image.image_array_index == region.array_layer
                && vulkan_rect(image).is_some_and(|rect| overlap(region.rect, rect))
        });
        by_view || by_other
    };
    let contested: SmallVec<[bool; 8]> = regions.iter().map(is_contested).collect();
    let mut contested = contested.into_iter();
    regions.retain(|_| !contested.next().unwrap_or(false));
}

fn overlap(a: vk::Rect2D, b: vk::Rect2D) -> bool {
    let meets = |a_from: i32, a_length: u32, b_from: i32, b_length: u32| {
        let (a_from, b_from) = (i64::from(a_from), i64::from(b_from));
        a_from < b_from + i64::from(b_length) && b_from < a_from + i64::from(a_length)
    };
    meets(a.offset.x, a.extent.width, b.offset.x, b.extent.width)
        && meets(a.offset.y, a.extent.height, b.offset.y, b.extent.height)
}

#[cfg(test)]
mod tests;
