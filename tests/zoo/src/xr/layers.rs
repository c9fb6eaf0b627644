//! xrEndFrame: where the eye buffers are.

use crate::scene::{FAR, NEAR};
use crate::style::Arrangement;
use crate::swapchain::Swapchain;
use anyhow::Result;
use openxr as xr;
use std::ffi::c_void;

/// Layers of a frame.
pub struct Layers<'a> {
    pub arrangement: Arrangement,
    pub color: &'a [Swapchain],
    /// Swapchains beside the colour ones, or empty.
    pub depth: &'a [Swapchain],
    pub quad: Option<&'a Swapchain>,
    pub space: &'a xr::Space,
    /// Width and height of an eye's rectangle.
    pub shown: [u32; 2],
    /// Width and height of an eye buffer.
    pub size: [u32; 2],
}

impl Layers<'_> {
    /// Ends the frame.
    ///
    /// # Errors
    /// Errors of xrEndFrame.
    pub fn submit(
        &self,
        stream: &mut xr::FrameStream<xr::Vulkan>,
        time: xr::Time,
        views: &[xr::View; 2],
    ) -> Result<()> {
        let depths = self.depth_infos();
        let views: Vec<_> = (0..2).map(|eye| self.view(eye, &views[eye], depths.get(eye))).collect();
        let projection = xr::CompositionLayerProjection::new().space(self.space).views(&views);
        let pose = xr::Posef { position: xr::Vector3f { x: 0.0, y: -0.3, z: -1.0 }, ..xr::Posef::IDENTITY };
        let quad = self.quad.map(|quad| {
            xr::CompositionLayerQuad::new()
                .space(self.space)
                .eye_visibility(xr::EyeVisibility::BOTH)
                .sub_image(quad.sub_image(0, [0, 0], quad.extent))
                .pose(pose)
                .size(xr::Extent2Df { width: 0.6, height: 0.3 })
        });
        let mut layers: Vec<&xr::CompositionLayerBase<xr::Vulkan>> = vec![&projection];
        if let Some(quad) = &quad {
            layers.push(quad);
        }
        Ok(stream.end(time, xr::EnvironmentBlendMode::OPAQUE, &layers)?)
    }

    fn sub_image<'s>(
        &self,
        swapchains: &'s [Swapchain],
        eye: usize,
    ) -> xr::SwapchainSubImage<'s, xr::Vulkan> {
        let (swapchain, layer, x) = match self.arrangement {
            Arrangement::Separate => (eye, 0, 0),
            Arrangement::Array => (0, eye as u32, 0),
            Arrangement::DoubleWide => (0, 0, eye as u32 * self.size[0]),
        };
        swapchains[swapchain].sub_image(layer, [x, 0], self.shown)
    }

    fn depth_infos(&self) -> Vec<xr::sys::CompositionLayerDepthInfoKHR> {
        if self.depth.is_empty() {
            return Vec::new();
        }
        let info = |eye| xr::sys::CompositionLayerDepthInfoKHR {
            ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
            next: std::ptr::null(),
            sub_image: self.sub_image(self.depth, eye).into_raw(),
            min_depth: 0.0,
            max_depth: 1.0,
            near_z: NEAR,
            far_z: FAR,
        };
        (0..2).map(info).collect()
    }

    fn view<'s>(
        &'s self,
        eye: usize,
        view: &xr::View,
        depth: Option<&'s xr::sys::CompositionLayerDepthInfoKHR>,
    ) -> xr::CompositionLayerProjectionView<'s, xr::Vulkan> {
        let plain = xr::CompositionLayerProjectionView::new()
            .pose(view.pose)
            .fov(view.fov)
            .sub_image(self.sub_image(self.color, eye));
        let Some(depth) = depth else { return plain };
        let mut raw = plain.into_raw();
        raw.next = std::ptr::from_ref(depth).cast::<c_void>();
        // SAFETY: the result borrows the depth info, to which the structure points.
        unsafe { xr::CompositionLayerProjectionView::from_raw(raw) }
    }
}
