//! The end of a frame for the Vulkan half: it takes the submission, and reports on the frame.

use crate::link::{NO_EYE, NO_IMAGE, ShownRecord, ShownViewRecord};
use crate::xr::submission::{Layer, ProjectionView, Submission};
use crate::xr::swapchain;
use crate::xr::vulkan_device::{FrameReport, VulkanDevice};
use openxr_sys as xr;
use openxr_sys::Handle;
use smallvec::SmallVec;

/// Ends a frame of the Vulkan half with its submission, after that many ignored ones, and takes its report.
pub fn end_frame(
    device: &VulkanDevice,
    submission: &Submission,
    skipped_frames: u32,
    report: &mut FrameReport,
) {
    let mut views: SmallVec<[ShownViewRecord; 8]> = SmallVec::new();
    let mut flat: SmallVec<[u64; 16]> = SmallVec::new();
    let mut depth: SmallVec<[u64; 8]> = SmallVec::new();
    for layer in submission.layers() {
        match layer {
            Layer::Flat(image) => flat.push(image.swapchain.into_raw()),
            Layer::Cube(swapchain) => flat.push(swapchain.into_raw()),
            Layer::Projection(layer) => {
                for (index, view) in layer.views.iter().enumerate() {
                    views.extend(shown_view(index, view));
                    depth.extend(view.depth.map(|depth| depth.sub_image.swapchain.into_raw()));
                }
            }
        }
    }
    let record = ShownRecord {
        views: views.as_ptr(),
        view_count: views.len() as u32,
        flat: flat.as_ptr(),
        flat_count: flat.len() as u32,
        depth: depth.as_ptr(),
        depth_count: depth.len() as u32,
        skipped_frames,
    };
    // SAFETY: the arrays live until the end of this function.
    unsafe { device.end_frame(&record, report) };
}

/// One view; `None` for a rectangle that the runtime refuses.
fn shown_view(index: usize, view: &ProjectionView) -> Option<ShownViewRecord> {
    let xr::SwapchainSubImage { swapchain, image_rect, image_array_index } = view.sub_image;
    let xr::Rect2Di { offset, extent } = image_rect;
    let sides = [offset.x, offset.y, extent.width, extent.height];
    let [x, y, width, height] = sides.map(u32::try_from);
    Some(ShownViewRecord {
        // The first two views are the eyes' in every configuration; the views after them are insets in the eyes' views.
        eye: if index < 2 { index as u32 } else { NO_EYE },
        swapchain: swapchain.into_raw(),
        image_index: swapchain::newest_image(swapchain).unwrap_or(NO_IMAGE),
        layer: image_array_index,
        rect: [x.ok()?, y.ok()?, width.ok()?, height.ok()?],
        is_upside_down: u32::from(view.fov.up < view.fov.down),
    })
}
