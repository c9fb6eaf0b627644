//! A virtual swapchain as the OpenXR half has it: images for the application, and the runtime's.

use crate::transfer::Layer;
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::gpu::GpuError;
use parafovea::kernels::compose::{
    AppImages, Compose, ComposeJob, ComposeRegion, RUNTIME_USAGE, RuntimeImages, SwapchainShape,
};

/// Some images for the application, and two of the runtime.
pub struct Swapchain {
    pub app: AppImages,
    pub runtime: RuntimeImages,
    runtime_handles: Vec<vk::Image>,
    extent: vk::Extent2D,
}

/// The usual request of an application.
pub fn shape(format: vk::Format, width: u32, height: u32, array_layers: u32) -> SwapchainShape {
    SwapchainShape {
        format,
        extent: vk::Extent2D { width, height },
        array_layers,
        usage: vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST,
        mutable: false,
        view_formats: vec![],
    }
}

impl Swapchain {
    pub fn new(vulkan: &Vulkan, shape: &SwapchainShape) -> Self {
        Self::with_images(vulkan, shape, 2)
    }

    pub fn with_images(vulkan: &Vulkan, shape: &SwapchainShape, count: u32) -> Self {
        let handles: Vec<vk::Image> = (0..2)
            .map(|_| {
                let usage = shape.usage | RUNTIME_USAGE;
                vulkan.runtime_image(shape.format, shape.extent, shape.array_layers, usage)
            })
            .collect();
        let app = AppImages::new(&vulkan.gpu, shape, count).unwrap();
        app.make_ready(0).unwrap();
        Self {
            app,
            runtime: RuntimeImages::new(&vulkan.gpu, shape, handles.clone()).unwrap(),
            runtime_handles: handles,
            extent: shape.extent,
        }
    }

    pub fn job<'a>(&'a self, index: u32, regions: &'a [ComposeRegion]) -> ComposeJob<'a> {
        ComposeJob {
            app: &self.app,
            app_index: index,
            runtime: &self.runtime,
            runtime_index: (index + 1) % 2,
            regions,
            reuse: &[],
            changes: &[],
        }
    }

    /// One frame: the application fills the layers of image `index`, we compose them, the runtime reads them.
    pub fn frame(
        &self,
        vulkan: &Vulkan,
        compose: &mut Compose,
        index: u32,
        layers: &[Vec<u8>],
        regions: &[ComposeRegion],
    ) -> Result<Vec<Vec<u8>>, GpuError> {
        let texel_size = layers[0].len() / (self.extent.width * self.extent.height) as usize;
        self.render(vulkan, index, layers);
        compose.submit(&[self.job(index, regions)])?;
        Ok(self.shown(vulkan, (index + 1) % 2, layers.len(), texel_size))
    }

    /// The application fills the layers of an image.
    pub fn render(&self, vulkan: &Vulkan, index: u32, layers: &[Vec<u8>]) {
        for (number, pixels) in layers.iter().enumerate() {
            vulkan.upload(self.layer(self.app.images()[index as usize], number), pixels);
        }
    }

    /// The runtime reads the layers of an image.
    pub fn shown(&self, vulkan: &Vulkan, index: u32, layers: usize, texel_size: usize) -> Vec<Vec<u8>> {
        let target = self.runtime_handles[index as usize];
        (0..layers).map(|number| vulkan.download(self.layer(target, number), texel_size)).collect()
    }

    fn layer(&self, image: vk::Image, layer: usize) -> Layer {
        Layer { image, layer: layer as u32, extent: self.extent }
    }
}
