//! Late pictures. If the runtime has no free image in time, it shows the last picture again, and gets the views of that picture: it would
//! turn an old picture by a new pose.

use super::Works;
use crate::planner::View;
use crate::xr::amended_layers::{AmendedLayers, LayerCopy};
use crate::xr::submission::{Submission, cast, is_flipped, upside_down};
use crate::xr::swapchain::{self, SubmittedView};
use openxr_sys as xr;
use std::{ptr, slice};

/// Notes the views of the frame's pictures.
pub fn note_views(submission: &Submission, works: &mut Works) {
    for (layer, projection) in submission.projections().enumerate() {
        for (index, seen) in projection.views.iter().enumerate() {
            let is_shown = |handle| handle == seen.sub_image.swapchain;
            let work = works.iter_mut().find(|work| is_shown(work.swapchain.handle));
            if let (Some(work), Some(view)) = (work, seen.view()) {
                let place = [layer, index];
                let (space, sub_image) = (projection.space, seen.sub_image);
                work.target.views.push(SubmittedView { place, space, view, sub_image });
            }
        }
    }
}

/// The submission with the views of earlier pictures in place of late ones; `None` if no picture is late.
///
/// # Safety
///
/// As for [`AmendedLayers::of`], with valid chains.
pub unsafe fn with_earlier_views(
    session: xr::Session,
    info: *const xr::FrameEndInfo,
) -> Option<AmendedLayers> {
    let swapchains = swapchain::virtual_ones(session);
    let earlier = |place, space, now: &xr::SwapchainSubImage| {
        let swapchain = swapchains.iter().find(|swapchain| swapchain.handle == now.swapchain)?;
        let target = swapchain.substitute.as_ref()?.target();
        target.view_of_earlier(place, space, now.image_array_index).copied()
    };
    let mut number = 0;
    let amend = |layer: &xr::CompositionLayerBaseHeader| {
        // SAFETY: the layer is valid and of its type, as `# Safety` demands.
        let layer = unsafe { cast::<xr::CompositionLayerProjection>(layer) }?;
        let projection = number;
        number += 1;
        if layer.views.is_null() {
            return None;
        }
        // SAFETY: the layer has `view_count` valid views and a valid chain, as `# Safety` demands.
        let (views, is_flipped) =
            unsafe { (slice::from_raw_parts(layer.views, layer.view_count as usize), is_flipped(layer)) };
        let found = |index: usize| earlier([projection, index], layer.space, &views[index].sub_image);
        if (0..views.len()).all(|index| found(index).is_none()) {
            return None;
        }
        let views = views.iter().enumerate();
        let views = views.map(|(index, view)| found(index).map_or(*view, |of| shown(&of, view, is_flipped)));
        Some(LayerCopy::Projection(Box::new(*layer), views.collect()))
    };
    // SAFETY: as `# Safety` demands.
    unsafe { AmendedLayers::of(info, amend) }
}

/// A view with an earlier picture, without its chain: depth and motion belong to the new picture.
fn shown(
    earlier: &SubmittedView,
    view: &xr::CompositionLayerProjectionView,
    is_flipped: bool,
) -> xr::CompositionLayerProjectionView {
    let View { orientation, position, fov } = earlier.view;
    let [x, y, z, w] = orientation.to_array();
    let fov = if is_flipped { upside_down(fov) } else { fov };
    xr::CompositionLayerProjectionView {
        next: ptr::null(),
        pose: xr::Posef {
            orientation: xr::Quaternionf { x, y, z, w },
            position: xr::Vector3f { x: position.x, y: position.y, z: position.z },
        },
        fov: xr::Fovf {
            angle_left: fov.left,
            angle_right: fov.right,
            angle_up: fov.up,
            angle_down: fov.down,
        },
        sub_image: earlier.sub_image,
        ..*view
    }
}
