//! The depth that is submitted with a view (XR_KHR_composition_layer_depth).

use super::history::ShownDepth;
use super::regions::{Images, rect_within};
use crate::xr::structures::extending;
use crate::xr::swapchain;
use glam::Vec3;
use openxr_sys as xr;
use parafovea_core::geometry::{DepthRange, Nearness};
use parafovea_core::kernels::compose::DepthRect;
use parafovea_core::reuse::Viewpoint;

/// What comes with a view, where it was copied and makes sense.
///
/// # Safety
///
/// `view` and its chain are valid, as `xrEndFrame` demands.
pub unsafe fn of(view: &xr::CompositionLayerProjectionView) -> Option<ShownDepth> {
    // SAFETY: the caller vouches for the chain.
    let info = unsafe { extending(view.next) }.find::<xr::CompositionLayerDepthInfoKHR>()?;
    let newest = swapchain::newest_depth(info.sub_image.swapchain)?;
    let shape = newest.kept.shape();
    let images = Images { extent: shape.extent, array_layers: shape.array_layers, is_unit_range: true };
    let rect = rect_within(&info.sub_image, &images)?;
    let nearness = Nearness::new(&DepthRange {
        min_depth: info.min_depth,
        max_depth: info.max_depth,
        near_z: info.near_z,
        far_z: info.far_z,
    })?;
    let xr::Vector3f { x, y, z } = view.pose.position;
    let position_m = Vec3::new(x, y, z);
    position_m.is_finite().then_some(ShownDepth {
        newest,
        array_layer: info.sub_image.image_array_index,
        rect: DepthRect {
            offset: [rect.offset.x as u32, rect.offset.y as u32],
            extent: [rect.extent.width, rect.extent.height],
        },
        viewpoint: Viewpoint { position_m, nearness },
    })
}
