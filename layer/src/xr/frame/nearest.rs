//! What submitted depth says of distances, without looking at a pixel: nothing is nearer than its nearest plane.

use crate::xr::structures::extending;
use openxr_sys as xr;

/// Nothing of what is shown is nearer than this, metres; nothing where that is not known: all layers are projections, and
/// all of their views have depth.
///
/// Source: XR_KHR_composition_layer_depth: `nearZ` and `farZ` are the distances of `minDepth` and `maxDepth`, between which all
/// of the depth is, in either order; either may be infinite.
///
/// # Safety
///
/// `info` and what it points to are valid, as `xrEndFrame` demands.
pub unsafe fn of(info: &xr::FrameEndInfo) -> Option<f32> {
    let mut nearest = f32::INFINITY;
    let mut projections = 0;
    // SAFETY: the caller vouches for `info`.
    for layer in unsafe { super::layers::of(info) } {
        let super::layers::Shown::Projection(layer) = layer else { return None };
        projections += 1;
        for view in layer.views {
            // SAFETY: as above, for the chain of each view.
            let depth = unsafe { extending(view.next) }.find::<xr::CompositionLayerDepthInfoKHR>()?;
            let is_distance = |z: f32| z > 0.0;
            if !is_distance(depth.near_z) || !is_distance(depth.far_z) {
                return None;
            }
            nearest = nearest.min(depth.near_z).min(depth.far_z);
        }
    }
    // Layers of other types are left out of the list above.
    (projections == info.layer_count && nearest.is_finite()).then_some(nearest)
}
