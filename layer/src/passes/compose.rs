//! `compose`: from the image that the application rendered to the image that the runtime shows.

use crate::gpu::{Gpu, GpuError};
use ash::vk;
pub use parafovea_core::kernels::compose::ComposeParams;
use std::sync::Arc;

/// The usage that the runtime's swapchain must be created with, besides what the application asks for.
pub const RUNTIME_USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::TRANSFER_DST.as_raw() | vk::ImageUsageFlags::COLOR_ATTACHMENT.as_raw(),
);

/// What a swapchain's images are like.
#[derive(Clone, Debug)]
pub struct SwapchainShape {
    /// Format of the swapchain.
    pub format: vk::Format,
    /// Size in pixels.
    pub extent: vk::Extent2D,
    /// Number of array layers.
    pub array_layers: u32,
    /// What the application asked for.
    pub usage: vk::ImageUsageFlags,
    /// Whether the application asked for views of other formats.
    pub mutable: bool,
    /// The formats of views that it named, if any.
    pub view_formats: Vec<vk::Format>,
}

/// Images of ours that the application renders to.
pub struct AppImages {
    images: Vec<vk::Image>,
}

impl AppImages {
    /// Creates `count` images and brings them to COLOR_ATTACHMENT_OPTIMAL, with a submit.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn new(_gpu: &Arc<Gpu>, _shape: &SwapchainShape, _count: u32) -> Result<Self, GpuError> {
        Err(GpuError::Unsupported("not built yet"))
    }

    /// The images, in order.
    pub fn images(&self) -> &[vk::Image] {
        &self.images
    }
}

/// Views and framebuffers over the runtime's images, which stay the runtime's.
pub struct RuntimeImages {
    _images: Vec<vk::Image>,
}

impl RuntimeImages {
    /// Prepares `images`, which have [`RUNTIME_USAGE`] and the given shape.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn new(_gpu: &Arc<Gpu>, _shape: &SwapchainShape, _images: Vec<vk::Image>) -> Result<Self, GpuError> {
        Err(GpuError::Unsupported("not built yet"))
    }
}

/// One rectangle of one array layer that gets processed.
#[derive(Clone, Copy, Debug)]
pub struct ComposeRegion {
    /// The array layer.
    pub array_layer: u32,
    /// The rectangle, in pixels; what lies outside of the image is ignored.
    pub rect: vk::Rect2D,
    /// What is done there.
    pub params: ComposeParams,
}

/// One image to copy and process. An image may appear in one job of a submit only.
#[derive(Clone, Copy)]
pub struct ComposeJob<'a> {
    /// Where the picture comes from.
    pub app: &'a AppImages,
    /// Which of those images.
    pub app_index: u32,
    /// Where it goes; of the same shape.
    pub runtime: &'a RuntimeImages,
    /// Which of those images.
    pub runtime_index: u32,
    /// What is processed; all the rest is copied.
    pub regions: &'a [ComposeRegion],
}

/// The pass.
pub struct Compose {
    _gpu: Arc<Gpu>,
}

impl Compose {
    /// Prepares the pass.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn new(gpu: Arc<Gpu>) -> Result<Self, GpuError> {
        Ok(Self { _gpu: gpu })
    }

    /// Whether swapchains of this format can be substituted.
    pub fn supports(&self, _format: vk::Format) -> bool {
        false
    }

    /// Makes what drawing to this format needs, so that the first frame need not.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn prepare(&mut self, _format: vk::Format) -> Result<(), GpuError> {
        Ok(())
    }

    /// Records and submits all jobs at once on the binding's queue, without waiting for them.
    ///
    /// All images are COLOR_ATTACHMENT_OPTIMAL before and after.
    ///
    /// # Errors
    /// See [`GpuError`]; then nothing was submitted.
    pub fn submit(&mut self, _jobs: &[ComposeJob]) -> Result<(), GpuError> {
        Err(GpuError::Unsupported("not built yet"))
    }
}
