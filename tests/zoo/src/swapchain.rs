//! Swapchains of the runtime, and their images as the device sees them.

use crate::gpu::{Gpu, Image, Made};
use anyhow::Result;
use ash::vk;
use ash::vk::Handle;
use openxr as xr;

/// A swapchain, of which at most one image is acquired.
pub struct Swapchain {
    pub handle: xr::Swapchain<xr::Vulkan>,
    pub images: Vec<Image>,
    pub extent: [u32; 2],
}

impl Swapchain {
    /// Makes a swapchain, and views of its images, which the device keeps.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Gpu,
        format: vk::Format,
        extent: [u32; 2],
        layers: u32,
        extra_usage: xr::SwapchainUsageFlags,
    ) -> Result<Self> {
        let depth = format == vk::Format::D32_SFLOAT;
        let (usage, view_usage) = if depth {
            (xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)
        } else {
            (xr::SwapchainUsageFlags::COLOR_ATTACHMENT, vk::ImageUsageFlags::COLOR_ATTACHMENT)
        };
        let handle = session.create_swapchain(&xr::SwapchainCreateInfo {
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: usage | xr::SwapchainUsageFlags::SAMPLED | extra_usage,
            format: format.as_raw() as u32,
            sample_count: 1,
            width: extent[0],
            height: extent[1],
            face_count: 1,
            array_size: layers,
            mip_count: 1,
        })?;
        let mut images = Vec::new();
        for raw in handle.enumerate_images()? {
            let image = gpu.viewed(&Image {
                handle: vk::Image::from_raw(raw),
                view: vk::ImageView::null(),
                format,
                extent,
                base_layer: 0,
                layers,
                base_level: 0,
                levels: 1,
                samples: 1,
                usage: view_usage,
            })?;
            gpu.keep(Made::View(image.view));
            images.push(image);
        }
        Ok(Self { handle, images, extent })
    }

    /// Takes the next image and waits for it: its number.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn acquire(&mut self) -> Result<usize> {
        let index = self.handle.acquire_image()?;
        self.handle.wait_image(xr::Duration::INFINITE)?;
        Ok(index as usize)
    }

    /// A rectangle of one of its layers.
    pub fn sub_image(
        &self,
        layer: u32,
        [x, y]: [u32; 2],
        [width, height]: [u32; 2],
    ) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        let rect = xr::Rect2Di {
            offset: xr::Offset2Di { x: x as i32, y: y as i32 },
            extent: xr::Extent2Di { width: width as i32, height: height as i32 },
        };
        xr::SwapchainSubImage::new().swapchain(&self.handle).image_array_index(layer).image_rect(rect)
    }
}
