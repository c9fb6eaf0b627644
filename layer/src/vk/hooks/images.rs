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
            // SAFETY: `device` is live, by the valid usage of vkCreateImage.
            let found = unsafe { device::with(device, |next| next.create_image) };
            let Some((known, next)) = found else { return vk::Result::ERROR_INITIALIZATION_FAILED };
            // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
            let create = |info: *const _| unsafe { next(device, info, allocator, image) };
            let Some(armed) = &known.armed else { return answer.record(create(info)) };
            // SAFETY: the pointer is valid, by the same valid usage, for the time of the call.
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
                // SAFETY: the pointer is valid, by the same valid usage, and the call has written the image.
                armed.objects.add_image(Image::created(unsafe { *image }, info, granted));
            }
            result
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
            // SAFETY: `device` is live, by the valid usage of vkGetDeviceImageMemoryRequirements.
            let found = unsafe { device::with(device, |next| next.image_memory_requirements) };
            let Some((known, next)) = found else { return };
            let ask = |info: *const _| {
                // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
                unsafe { next(device, info, requirements) };
                answer.made();
            };
            let Some(masks) = known.masks() else { return ask(info) };
            // SAFETY: both pointers are valid, by the same valid usage, for the time of the call.
            let (info, image) = unsafe { (&*info, &*(*info).p_create_info) };
            // SAFETY: as above: the chain is valid too.
            match unsafe { masks.usage(image) } {
                Some(usage) => {
                    let image = vk::ImageCreateInfo { usage, ..*image };
                    ask(&vk::DeviceImageMemoryRequirements { p_create_info: &image, ..*info });
                }
                None => ask(info),
            }
        },
    );
}
