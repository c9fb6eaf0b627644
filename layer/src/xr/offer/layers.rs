//! Composition layers in a space that the gaze moves. The runtime has no pose for it, so that it gets them in the space of the head.

use super::pose::Pose;
use super::spaces::{GazeSpace, has_spaces};
use crate::xr::submission::cast;
use openxr_sys as xr;
use std::ptr;

/// A submission with such layers, placed by the gaze.
pub struct PlacedLayers {
    info: xr::FrameEndInfo,
    /// The layers of `info`, the application's own and our copies.
    _layers: Vec<*const xr::CompositionLayerBaseHeader>,
    _copies: Vec<Copied>,
}

/// A copy of a layer: boxed, so that it stays where it is.
enum Copied {
    Projection(Box<xr::CompositionLayerProjection>, Vec<xr::CompositionLayerProjectionView>),
    Quad(Box<xr::CompositionLayerQuad>),
    Cylinder(Box<xr::CompositionLayerCylinderKHR>),
    Equirect(Box<xr::CompositionLayerEquirectKHR>),
    Equirect2(Box<xr::CompositionLayerEquirect2KHR>),
    Cube(Box<xr::CompositionLayerCubeKHR>),
}

impl PlacedLayers {
    /// The submission with its layers placed by the gaze; `None`, without an allocation, if none is in the space of a gaze.
    ///
    /// # Safety
    ///
    /// `info` is null or valid with its layers and their views, which all stay valid while the result is used.
    pub unsafe fn of(info: *const xr::FrameEndInfo) -> Option<Self> {
        if !has_spaces() {
            return None;
        }
        // SAFETY: `info` is null or valid, as `# Safety` demands, with an array of that many pointers.
        let (info, given) = unsafe {
            let info = info.as_ref().filter(|info| !info.layers.is_null())?;
            (*info, std::slice::from_raw_parts(info.layers, info.layer_count as usize))
        };
        let mut layers = Vec::new();
        let mut copies = Vec::new();
        for (index, layer) in given.iter().enumerate() {
            // SAFETY: each is null or a valid layer, as `# Safety` demands.
            let Some(mut copy) =
                (unsafe { layer.as_ref().and_then(|layer| Copied::of(layer, info.display_time)) })
            else {
                continue;
            };
            if layers.is_empty() {
                layers.extend_from_slice(given);
            }
            layers[index] = copy.header();
            copies.push(copy);
        }
        if copies.is_empty() {
            return None;
        }
        let info = xr::FrameEndInfo { layers: layers.as_ptr(), ..info };
        Some(Self { info, _layers: layers, _copies: copies })
    }

    /// The submission, for as long as `self` lives.
    pub fn info(&self) -> *const xr::FrameEndInfo {
        &raw const self.info
    }
}

impl Copied {
    /// A layer in the space of the head; `None` if the gaze does not move it, or has no pose at that time.
    ///
    /// # Safety
    ///
    /// The layer is valid with its views.
    unsafe fn of(layer: &xr::CompositionLayerBaseHeader, time: xr::Time) -> Option<Self> {
        let gaze = GazeSpace::find(layer.space)?;
        let in_head = gaze.pose_in_head(time)?;
        // SAFETY: as `# Safety` demands.
        unsafe { Self::placed(layer, gaze.head(), in_head) }
    }

    /// A layer whose space has the pose `in_head` in the space of the head; `None` for a layer of a type that is not known.
    ///
    /// # Safety
    ///
    /// As for [`Self::of`].
    unsafe fn placed(
        layer: &xr::CompositionLayerBaseHeader,
        space: xr::Space,
        in_head: Pose,
    ) -> Option<Self> {
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
            let views = views
                .iter()
                .map(|view| xr::CompositionLayerProjectionView { pose: placed(view.pose), ..*view });
            let copy = xr::CompositionLayerProjection { space, ..*layer };
            return Some(Self::Projection(Box::new(copy), views.collect()));
        }
        if let Some(layer) = quad {
            let copy = xr::CompositionLayerQuad { space, pose: placed(layer.pose), ..*layer };
            return Some(Self::Quad(Box::new(copy)));
        }
        if let Some(layer) = cylinder {
            let copy = xr::CompositionLayerCylinderKHR { space, pose: placed(layer.pose), ..*layer };
            return Some(Self::Cylinder(Box::new(copy)));
        }
        if let Some(layer) = equirect {
            let copy = xr::CompositionLayerEquirectKHR { space, pose: placed(layer.pose), ..*layer };
            return Some(Self::Equirect(Box::new(copy)));
        }
        if let Some(layer) = equirect2 {
            let copy = xr::CompositionLayerEquirect2KHR { space, pose: placed(layer.pose), ..*layer };
            return Some(Self::Equirect2(Box::new(copy)));
        }
        let layer = cube?;
        let pose = xr::Posef { orientation: layer.orientation, position: xr::Vector3f::default() };
        let orientation = placed(pose).orientation;
        Some(Self::Cube(Box::new(xr::CompositionLayerCubeKHR { space, orientation, ..*layer })))
    }

    fn header(&mut self) -> *const xr::CompositionLayerBaseHeader {
        match self {
            Self::Projection(layer, views) => {
                layer.views = views.as_ptr();
                ptr::from_ref(&**layer).cast()
            }
            Self::Quad(layer) => ptr::from_ref(&**layer).cast(),
            Self::Cylinder(layer) => ptr::from_ref(&**layer).cast(),
            Self::Equirect(layer) => ptr::from_ref(&**layer).cast(),
            Self::Equirect2(layer) => ptr::from_ref(&**layer).cast(),
            Self::Cube(layer) => ptr::from_ref(&**layer).cast(),
        }
    }
}

/// A pose in the space of the gaze, in that of the head; an invalid one stays so, for the runtime's own error.
fn placed(in_head: Pose, pose: xr::Posef) -> xr::Posef {
    Pose::read(&pose).map_or(pose, |pose| in_head.then(pose).written())
}

#[cfg(test)]
mod tests;
