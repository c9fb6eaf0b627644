//! Images.

use super::new_key;
use crate::abi::guard;
use crate::link::SwapchainRecord;
use crate::scene::{ImageDescription, SwapchainKey};
use crate::vk::device;
use ash::vk;

/// A live image.
#[derive(Debug, Clone, Copy)]
pub struct Image {
    /// Its handle.
    pub handle: vk::Image,
    /// What recognition needs to know of it.
    pub description: ImageDescription,
    /// What it may be used for.
    #[allow(dead_code, reason = "for the mask, which takes only some images")]
    pub usage: vk::ImageUsageFlags,
    /// How it was created.
    #[allow(dead_code, reason = "for the mask, which takes only some images")]
    pub flags: vk::ImageCreateFlags,
    /// Whether it was not made through this layer, so that nobody tells when it is destroyed but its swapchain.
    pub is_foreign: bool,
}

impl Image {
    /// An image that the application creates.
    fn created(handle: vk::Image, info: &vk::ImageCreateInfo<'_>) -> Self {
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
            flags: info.flags,
            is_foreign: false,
        }
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
            flags: vk::ImageCreateFlags::empty(),
            is_foreign: true,
        }
    }
}

/// `vkCreateImage`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::ImageCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    image: *mut vk::Image,
) -> vk::Result {
    guard(
        "vkCreateImage",
        || vk::Result::ERROR_INITIALIZATION_FAILED,
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `image` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_image) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let result = answer.record(next(device, info, allocator, image));
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                    armed.objects.add_image(Image::created(*image, &*info));
                }
                result
            }
        },
    )
}

/// `vkDestroyImage`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    image: vk::Image,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyImage",
        || (),
        |_| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_image) else { return };
                // Before the call: the handle may be in use again after.
                if let Some(armed) = &known.armed
                    && let Some(image) = armed.objects.remove_image(image)
                {
                    armed.candidates.forget(image.description.key);
                }
                next(device, image, allocator);
            }
        },
    );
}
