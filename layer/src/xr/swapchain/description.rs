//! What a swapchain's images are like, for the Vulkan half.

use super::eligibility::vulkan_usage;
use crate::link::SwapchainRecord;
use ash::vk;
use openxr_sys as xr;

/// What the application asked for, and what it got.
#[derive(Debug, Clone, Copy)]
pub struct Description {
    extent: [u32; 2],
    layers: u32,
    format: vk::Format,
    samples: u32,
    usage: vk::ImageUsageFlags,
    granted: vk::ImageUsageFlags,
}

impl Description {
    /// Of a swapchain that the application created with `info`, and whose images may be used for `granted`.
    pub fn new(info: &xr::SwapchainCreateInfo, granted: vk::ImageUsageFlags) -> Self {
        Self {
            extent: [info.width, info.height],
            layers: info.array_size.saturating_mul(info.face_count.max(1)),
            format: i32::try_from(info.format).map_or(vk::Format::UNDEFINED, vk::Format::from_raw),
            samples: info.sample_count,
            usage: vulkan_usage(info.usage_flags),
            granted,
        }
    }

    /// The record for these images, to which it points.
    pub fn record(&self, swapchain: u64, images: &[vk::Image]) -> SwapchainRecord {
        SwapchainRecord {
            swapchain,
            images: images.as_ptr(),
            image_count: images.len() as u32,
            extent: self.extent,
            layers: self.layers,
            format: self.format,
            samples: self.samples,
            usage: self.usage,
            granted: self.granted,
        }
    }
}
