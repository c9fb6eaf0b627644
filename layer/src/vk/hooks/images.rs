//! Hooks of images.

use crate::vk::device;
use crate::vk::objects::Image;
use ash::vk;

/// `vkCreateImage`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::ImageCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    image: *mut vk::Image,
) -> vk::Result {
    hook!(
        "vkCreateImage",
        device::with,
        create_image(device, info, allocator, image),
        |known, next, answer| {
            // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
            let create = |info: *const _| unsafe { next(device, info, allocator, image) };
            let Some(armed) = &known.armed else { return answer.record(create(info)) };
            // SAFETY: the pointer is valid, by valid usage, for the time of the call.
            let info = unsafe { &*info };
            let mut granted = info.usage;
            let mut result = vk::Result::ERROR_FORMAT_NOT_SUPPORTED;
            // SAFETY: as above: the chain is valid too.
            if let Some(usage) = armed.masks.as_ref().and_then(|masks| unsafe { masks.usage(info) }) {
                result = create(&vk::ImageCreateInfo { usage, ..*info });
                granted = usage;
            }
            if result != vk::Result::SUCCESS {
                result = create(info);
                granted = info.usage;
            }
            let result = answer.record(result);
            if result == vk::Result::SUCCESS {
                // SAFETY: the pointer is valid, by valid usage, and the call has written the image.
                armed.objects.add_image(Image::created(unsafe { *image }, info, granted));
            }
            result
        }
    )
}

/// `vkDestroyImage`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    image: vk::Image,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!("vkDestroyImage", device::with, destroy_image(device, image, allocator), |known, next| {
        // Before the call: the handle may be in use again after.
        if let Some(armed) = &known.armed
            && let Some(image) = armed.objects.remove_image(image)
            && image.may_be_drawn_to()
        {
            armed.forget_drawn(image.description.key);
        }
        next();
    });
}

/// `vkGetDeviceImageMemoryRequirements`, for an image as it would be created here.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn memory_requirements(
    device: vk::Device,
    info: *const vk::DeviceImageMemoryRequirements<'_>,
    requirements: *mut vk::MemoryRequirements2<'_>,
) {
    hook!(
        "vkGetDeviceImageMemoryRequirements",
        device::with,
        image_memory_requirements(device, info, requirements),
        |known, next, answer| {
            let ask = |info: *const _| {
                // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
                unsafe { next(device, info, requirements) };
                answer.made();
            };
            let Some(masks) = known.masks() else { return ask(info) };
            // SAFETY: both pointers are valid, by valid usage, for the time of the call.
            let (info, image) = unsafe { (&*info, &*(*info).p_create_info) };
            // SAFETY: as above: the chain is valid too.
            match unsafe { masks.usage(image) } {
                Some(usage) => {
                    let image = vk::ImageCreateInfo { usage, ..*image };
                    ask(&vk::DeviceImageMemoryRequirements { p_create_info: &image, ..*info });
                }
                None => ask(info),
            }
        }
    );
}
