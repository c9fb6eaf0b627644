//! The images of the runtime's swapchain, which the picture ends up in.

use super::SwapchainShape;
use crate::gpu::{ColorTarget, Gpu, GpuError, Uses, color_pass, serial};
use ash::vk;
use std::sync::Arc;

/// The usage that the runtime's swapchain must have: it is copied and drawn to.
pub const RUNTIME_USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::TRANSFER_DST.as_raw() | vk::ImageUsageFlags::COLOR_ATTACHMENT.as_raw(),
);

/// Views and framebuffers over the runtime's images, which stay the runtime's.
pub struct RuntimeImages {
    // First: waits before the rest is destroyed.
    uses: Uses,
    targets: Vec<ColorTarget>,
    handles: Vec<vk::Image>,
    shape: SwapchainShape,
    serial: u64,
}

impl RuntimeImages {
    /// Prepares `images`, which have [`RUNTIME_USAGE`] and the format, extent and layers of `shape`, and live
    /// until the result is dropped.
    ///
    /// # Errors
    /// A failed call.
    pub fn new(gpu: &Arc<Gpu>, shape: &SwapchainShape, images: Vec<vk::Image>) -> Result<Self, GpuError> {
        let pass = color_pass(gpu, shape.format)?;
        let targets = images
            .iter()
            .flat_map(|&image| (0..shape.array_layers).map(move |layer| (image, layer)))
            .map(|(image, layer)| ColorTarget::new(gpu, &pass, image, shape.format, shape.extent, layer))
            .collect::<Result<Vec<_>, GpuError>>()?;
        Ok(Self { uses: Uses::new(gpu), targets, handles: images, shape: shape.clone(), serial: serial() })
    }

    /// The images, in order.
    pub fn images(&self) -> &[vk::Image] {
        &self.handles
    }

    pub(in crate::kernels) fn shape(&self) -> &SwapchainShape {
        &self.shape
    }

    /// No other images have it.
    pub(in crate::kernels) fn serial(&self) -> u64 {
        self.serial
    }

    pub(in crate::kernels) fn uses(&self) -> &Uses {
        &self.uses
    }

    /// A layer of an image, to draw to.
    pub(in crate::kernels) fn target(&self, image: u32, layer: u32) -> Option<&ColorTarget> {
        self.targets.get((image * self.shape.array_layers + layer) as usize)
    }
}
