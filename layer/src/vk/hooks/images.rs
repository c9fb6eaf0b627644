//! Hooks of images.

use crate::abi::guard;
use crate::vk::device;
use crate::vk::objects::Image;
use ash::vk;

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
