//! The end of a frame for the Vulkan half: it takes the submission, and reports on the frame.

use crate::link::{NO_EYE, NO_IMAGE, ShownRecord, ShownViewRecord};
use crate::planner::TREMOR;
use crate::xr::submission::{Layer, ProjectionView, Submission};
use crate::xr::swapchain;
use crate::xr::vulkan_device::{FrameReport, VulkanDevice};
use openxr_sys as xr;
use openxr_sys::Handle;
use parafovea_core::geometry::Fov;
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
    let scene = submission.scene();
    for layer in submission.layers() {
        match layer {
            Layer::Flat(image) => flat.push(image.swapchain.into_raw()),
            Layer::Cube(swapchain) => flat.push(swapchain.into_raw()),
            Layer::Projection(layer) => {
                for (index, view) in layer.views.iter().enumerate() {
                    let planned = scene.as_ref().and_then(|scene| scene.views.get(index));
                    views.extend(shown_view(index, view, planned));
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

/// One view; `None` for a rectangle that the runtime refuses. `planned`: the view of the scene that the plan is for.
fn shown_view(
    index: usize,
    view: &ProjectionView,
    planned: Option<&ProjectionView>,
) -> Option<ShownViewRecord> {
    let xr::SwapchainSubImage { swapchain, image_rect, image_array_index } = view.sub_image;
    let xr::Rect2Di { offset, extent } = image_rect;
    let sides = [offset.x, offset.y, extent.width, extent.height];
    let [x, y, width, height] = sides.map(u32::try_from);
    Some(ShownViewRecord {
        // The first two views are the eyes' in every configuration; the views after them are insets in the eyes' views. So is a layer with
        // another field of view than the scene's, which the plan does not fit.
        eye: if index < 2 && planned.is_none_or(|planned| fits(planned, view)) {
            index as u32
        } else {
            NO_EYE
        },
        swapchain: swapchain.into_raw(),
        image_index: swapchain::newest_image(swapchain).unwrap_or(NO_IMAGE),
        layer: image_array_index,
        rect: [x.ok()?, y.ok()?, width.ok()?, height.ok()?],
        is_upside_down: u32::from(view.fov.up < view.fov.down),
    })
}

/// Whether the plan for one view fits another: their fields of view are the same within [`TREMOR`].
fn fits(planned: &ProjectionView, view: &ProjectionView) -> bool {
    // Whether a picture is upside down, its record has.
    let angles = |fov: Fov| [fov.left, fov.right, fov.up.max(fov.down), fov.up.min(fov.down)];
    angles(planned.fov).iter().zip(angles(view.fov)).all(|(planned, own)| (planned - own).abs() <= TREMOR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    fn view(fov: Fov) -> ProjectionView {
        // SAFETY: plain data, for which all zero is a valid value.
        let sub_image = unsafe { std::mem::zeroed() };
        let orientation = Some(Quat::IDENTITY);
        ProjectionView { orientation, position_m: Vec3::ZERO, fov, sub_image, depth: None }
    }

    /// The plan of a view of 100 degrees would be squeezed into one of 50.
    #[test]
    fn a_layer_with_another_field_of_view_than_the_scenes_has_no_plan() {
        let wide = Fov { left: -0.9, right: 0.8, up: 0.85, down: -0.85 };
        let narrow = Fov { left: -0.45, right: 0.4, up: 0.42, down: -0.42 };
        let flipped = Fov { up: wide.down, down: wide.up, ..wide };
        let trembling = Fov { left: wide.left + 1e-5, ..wide };
        let eye = |fov, planned| shown_view(1, &view(fov), Some(&view(planned))).unwrap().eye;
        assert_eq!([eye(wide, wide), eye(flipped, wide), eye(trembling, wide)], [1; 3]);
        assert_eq!([eye(narrow, wide), eye(wide, narrow)], [NO_EYE; 2]);
        assert_eq!(shown_view(2, &view(wide), Some(&view(wide))).unwrap().eye, NO_EYE, "an inset");
    }
}
