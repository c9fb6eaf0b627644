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
    /// What the application may use it for.
    pub usage: vk::ImageUsageFlags,
    /// What it may be used for, which may be more.
    pub granted: vk::ImageUsageFlags,
    /// Whether it was not made through this layer, so that nobody tells when it is destroyed but its swapchain.
    pub is_foreign: bool,
}

impl Image {
    /// An image that the application creates, and may be used for `granted`.
    fn created(handle: vk::Image, info: &vk::ImageCreateInfo<'_>, granted: vk::ImageUsageFlags) -> Self {
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

/// `vkCreateImage`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::ImageCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    image: *mut vk::Image,
) -> vk::Result {
    guard(
        "vkCreateImage",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_image(device, info, allocator, image),
                vk::Result::ERROR_INITIALIZATION_FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `image` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_image) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let Some(armed) = &known.armed else {
                    return answer.record(next(device, info, allocator, image));
                };
                let mut granted = (*info).usage;
                let mut result = vk::Result::ERROR_FORMAT_NOT_SUPPORTED;
                if let Some(usage) = armed.masks.as_ref().and_then(|masks| masks.usage(&*info)) {
                    let amended = vk::ImageCreateInfo { usage, ..*info };
                    result = next(device, &amended, allocator, image);
                    granted = usage;
                }
                if result != vk::Result::SUCCESS {
                    result = next(device, info, allocator, image);
                    granted = (*info).usage;
                }
                let result = answer.record(result);
                if result == vk::Result::SUCCESS {
                    armed.objects.add_image(Image::created(*image, &*info, granted));
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
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_image(device, image, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_image) else { return };
                // Before the call: the handle may be in use again after.
                if let Some(armed) = &known.armed
                    && let Some(image) = armed.objects.remove_image(image)
                {
                    armed.forget_drawn(image.description.key);
                }
                next(device, image, allocator);
                answer.made();
            }
        },
    );
}

/// `vkGetDeviceImageMemoryRequirements`: those of an image as it would be created here.
pub unsafe extern "system" fn memory_requirements(
    device: vk::Device,
    info: *const vk::DeviceImageMemoryRequirements<'_>,
    requirements: *mut vk::MemoryRequirements2<'_>,
) {
    guard(
        "vkGetDeviceImageMemoryRequirements",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(device::with: device, image_memory_requirements(device, info, requirements), ())
        },
        |answer| {
            // SAFETY: the application's own arguments: `info` and the creation in it are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.image_memory_requirements) else {
                    return;
                };
                let masks = known.armed.as_ref().and_then(|armed| armed.masks.as_ref());
                let image = (*info).p_create_info;
                match masks.and_then(|masks| masks.usage(&*image)) {
                    Some(usage) => {
                        let image = vk::ImageCreateInfo { usage, ..*image };
                        let amended = vk::DeviceImageMemoryRequirements { p_create_info: &image, ..*info };
                        next(device, &amended, requirements);
                        answer.made();
                    }
                    None => next(device, info, requirements),
                }
            }
        },
    );
}
