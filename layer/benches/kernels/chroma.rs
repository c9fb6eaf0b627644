//! `compose` on a picture that is its own swapchain: with nothing to do, and removing colour.

use crate::swapchain::{Swapchain, shape};
use crate::vulkan::Vulkan;
use crate::{FORMAT, cpu_ms_of, rgba8};
use ash::vk;
use glam::Vec3;
use parafovea::kernels::compose::{Compose, ComposeParams, ComposeRegion, stores_unit_range};
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::geometry::Fov;

/// The pass, with a picture to work on.
pub struct Chroma<'a> {
    vulkan: &'a Vulkan,
    compose: Compose,
    swapchain: Swapchain,
    region: ComposeRegion,
}

impl<'a> Chroma<'a> {
    pub fn new(vulkan: &'a Vulkan, side: u32) -> Self {
        let swapchain = Swapchain::new(vulkan, &shape(FORMAT, side, side, 1));
        swapchain.render(vulkan, 0, &[rgba8(side)]);
        vulkan.idle();
        let extent = vk::Extent2D { width: side, height: side };
        let fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
        let unit = stores_unit_range(FORMAT);
        let params =
            ComposeParams::new([0; 2], [side; 2], fov, Vec3::NEG_Z, &ChromaSettings::default(), unit);
        let region = ComposeRegion { array_layer: 0, rect: extent.into(), params };
        Self { vulkan, compose: Compose::new(vulkan.gpu.clone()).unwrap(), swapchain, region }
    }

    /// CPU milliseconds for the picture, with colour removed or not.
    pub fn cpu_ms(&mut self, times: u32, removes: bool) -> f64 {
        let regions = if removes { std::slice::from_ref(&self.region) } else { &[] };
        cpu_ms_of(self.vulkan, times, || {
            for _ in 0..times {
                self.compose.submit(&[self.swapchain.job(0, regions)]).unwrap();
            }
        })
    }
}
