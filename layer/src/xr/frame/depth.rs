//! The depth that is submitted with a view (XR_KHR_composition_layer_depth).

use super::history::ShownDepth;
use super::regions::{Images, rect_within};
use crate::xr::submission::{ProjectionView, SubmittedDepth};
use crate::xr::swapchain;
use parafovea_core::geometry::Nearness;
use parafovea_core::kernels::compose::DepthRect;
use parafovea_core::reuse::Viewpoint;

/// What comes with a view, where it was copied and makes sense.
pub fn of(view: &ProjectionView) -> Option<ShownDepth> {
    let SubmittedDepth { sub_image, range } = view.depth.as_ref()?;
    let newest = swapchain::newest_depth(sub_image.swapchain)?;
    let shape = newest.kept.shape();
    let images = Images { extent: shape.extent, array_layers: shape.array_layers, is_unit_range: true };
    let rect = rect_within(sub_image, &images)?;
    let nearness = Nearness::new(range)?;
    let position_m = view.position_m;
    position_m.is_finite().then_some(ShownDepth {
        newest,
        array_layer: sub_image.image_array_index,
        rect: DepthRect {
            offset: [rect.offset.x as u32, rect.offset.y as u32],
            extent: [rect.extent.width, rect.extent.height],
        },
        viewpoint: Viewpoint { position_m, nearness },
    })
}
