//! A virtual swapchain as the OpenXR half has it: images for the application, and the runtime's.

use crate::transfer::Layer;
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::gpu::GpuError;
use parafovea::passes::compose::{
    AppImages, Compose, ComposeJob, ComposeRegion, RUNTIME_USAGE, RuntimeImages, SwapchainShape,
};

/// Two images on either side.
pub struct Swapchain {
    pub app: AppImages,
    pub runtime: RuntimeImages,
    runtime_handles: Vec<vk::Image>,
    extent: vk::Extent2D,
}

/// What an application usually asks for.
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
        let handles: Vec<vk::Image> = (0..2)
            .map(|_| {
                let usage = shape.usage | RUNTIME_USAGE;
                vulkan.runtime_image(shape.format, shape.extent, shape.array_layers, usage)
            })
            .collect();
        let app = AppImages::new(&vulkan.gpu, shape, 2).unwrap();
        app.make_ready().unwrap();
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
            runtime_index: 1 - index,
            regions,
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
        let layer = |image, layer: usize| Layer { image, layer: layer as u32, extent: self.extent };
        for (number, pixels) in layers.iter().enumerate() {
            vulkan.upload(layer(self.app.images()[index as usize], number), pixels);
        }
        compose.submit(&[self.job(index, regions)])?;
        let target = self.runtime_handles[1 - index as usize];
        Ok((0..layers.len()).map(|number| vulkan.download(layer(target, number), texel_size)).collect())
    }
}
