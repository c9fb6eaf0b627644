//! Images.

use super::new_key;
use crate::link::SwapchainRecord;
use crate::pass_detection::{ImageDescription, SwapchainKey};
use ash::vk;

/// A live image.
#[derive(Debug, Clone, Copy)]
pub struct Image {
    /// Its handle.
    pub handle: vk::Image,
    /// Its description for recognition.
    pub description: ImageDescription,
    /// The application's usage.
    pub usage: vk::ImageUsageFlags,
    /// Its usage, which may be more.
    pub granted: vk::ImageUsageFlags,
    /// Whether it was not made through this layer: only the end of its swapchain reveals its destruction.
    pub is_foreign: bool,
}

impl Image {
    /// An image that the application creates, and may be used for `granted`.
    pub fn created(handle: vk::Image, info: &vk::ImageCreateInfo<'_>, granted: vk::ImageUsageFlags) -> Self {
        Self {
            handle,
            description: ImageDescription {
                key: new_key(),
                extent: [info.extent.width, info.extent.height],
                layers: info.array_layers,
                format: info.format,
                samples: info.samples.as_raw(),
                is_cube: info.flags.contains(vk::ImageCreateFlags::CUBE_COMPATIBLE),
                swapchain: None,
            },
            usage: info.usage,
            granted,
            is_foreign: false,
        }
    }

    /// Whether passes may draw to it. Most images are textures, which none does.
    pub fn may_be_drawn_to(&self) -> bool {
        let attached = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        self.granted.intersects(attached)
    }

    /// An image of a swapchain that was not made through this layer.
    pub fn of_swapchain(handle: vk::Image, record: &SwapchainRecord) -> Self {
        Self {
            handle,
            description: ImageDescription {
                key: new_key(),
                extent: record.extent,
                layers: record.layers,
                format: record.format,
                samples: record.samples,
                is_cube: false,
                swapchain: Some(SwapchainKey(record.swapchain)),
            },
            usage: record.usage,
            granted: record.granted,
            is_foreign: true,
        }
    }
}
