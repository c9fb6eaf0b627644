//! Composition layers in a space that the gaze moves. The runtime has no pose for it, so that it gets them in the space of the head.

use super::pose::Pose;
use super::spaces::{GazeSpace, has_spaces};
use crate::xr::amended_layers::{AmendedLayers, LayerCopy};
use crate::xr::submission::cast;
use openxr_sys as xr;

/// The submission with its layers placed by the gaze; `None`, without an allocation, if none is in the space of a gaze.
///
/// # Safety
///
/// As for [`AmendedLayers::of`].
pub unsafe fn placed_by_gaze(info: *const xr::FrameEndInfo) -> Option<AmendedLayers> {
    if !has_spaces() {
        return None;
    }
    // SAFETY: `info` is null or valid, as `# Safety` demands.
    let time = unsafe { info.as_ref() }?.display_time;
    // SAFETY: as `# Safety` demands; each layer is valid.
    unsafe { AmendedLayers::of(info, |layer| in_head(layer, time)) }
}

/// A layer in the space of the head; `None` if the gaze does not move it, or has no pose at that time.
///
/// # Safety
///
/// The layer is valid with its views.
unsafe fn in_head(layer: &xr::CompositionLayerBaseHeader, time: xr::Time) -> Option<LayerCopy> {
    let gaze = GazeSpace::find(layer.space)?;
    let in_head = gaze.pose_in_head(time)?;
    // SAFETY: as `# Safety` demands.
    unsafe { moved(layer, gaze.head(), in_head) }
}

/// A layer whose space has the pose `in_head` in the space of the head; `None` for a layer of a type that is not known.
///
/// # Safety
///
/// As for [`in_head`].
unsafe fn moved(
    layer: &xr::CompositionLayerBaseHeader,
    space: xr::Space,
    in_head: Pose,
) -> Option<LayerCopy> {
    let placed = |pose| placed(in_head, pose);
    // SAFETY: the layer is valid and of its type, as `# Safety` demands.
    let (projection, quad, cylinder, equirect, equirect2, cube) = unsafe {
        (
            cast::<xr::CompositionLayerProjection>(layer),
            cast::<xr::CompositionLayerQuad>(layer),
            cast::<xr::CompositionLayerCylinderKHR>(layer),
            cast::<xr::CompositionLayerEquirectKHR>(layer),
            cast::<xr::CompositionLayerEquirect2KHR>(layer),
            cast::<xr::CompositionLayerCubeKHR>(layer),
        )
    };
    if let Some(layer) = projection.filter(|layer| !layer.views.is_null()) {
        // SAFETY: the layer has `view_count` valid views, as `# Safety` demands.
        let views = unsafe { std::slice::from_raw_parts(layer.views, layer.view_count as usize) };
        let views =
            views.iter().map(|view| xr::CompositionLayerProjectionView { pose: placed(view.pose), ..*view });
        let copy = xr::CompositionLayerProjection { space, ..*layer };
        return Some(LayerCopy::Projection(Box::new(copy), views.collect()));
    }
    if let Some(layer) = quad {
        let copy = xr::CompositionLayerQuad { space, pose: placed(layer.pose), ..*layer };
        return Some(LayerCopy::Quad(Box::new(copy)));
    }
    if let Some(layer) = cylinder {
        let copy = xr::CompositionLayerCylinderKHR { space, pose: placed(layer.pose), ..*layer };
        return Some(LayerCopy::Cylinder(Box::new(copy)));
    }
    if let Some(layer) = equirect {
        let copy = xr::CompositionLayerEquirectKHR { space, pose: placed(layer.pose), ..*layer };
        return Some(LayerCopy::Equirect(Box::new(copy)));
    }
    if let Some(layer) = equirect2 {
        let copy = xr::CompositionLayerEquirect2KHR { space, pose: placed(layer.pose), ..*layer };
        return Some(LayerCopy::Equirect2(Box::new(copy)));
    }
    let layer = cube?;
    let pose = xr::Posef { orientation: layer.orientation, position: xr::Vector3f::default() };
    let orientation = placed(pose).orientation;
    Some(LayerCopy::Cube(Box::new(xr::CompositionLayerCubeKHR { space, orientation, ..*layer })))
}

/// A pose in the space of the gaze, in that of the head; an invalid one stays so, for the runtime's own error.
fn placed(in_head: Pose, pose: xr::Posef) -> xr::Posef {
    Pose::read(&pose).map_or(pose, |pose| in_head.then(pose).written())
}

#[cfg(test)]
mod tests;
