//! Hooks of image views.

use crate::abi::guard;
use crate::vk::armed::Armed;
use crate::vk::chain::extension;
use crate::vk::device;
use crate::vk::objects::View;
use ash::vk;

/// The usage of a view in the application's view, where its image has more: it must be that of the application's imageless framebuffers.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateImageView).
unsafe fn asked_usage(armed: &Armed, info: &vk::ImageViewCreateInfo<'_>) -> Option<vk::ImageUsageFlags> {
    if armed.masks.is_none() || armed.record.api_version < vk::API_VERSION_1_1 {
        return None;
    }
    // SAFETY: the chain is valid, by the valid usage of vkCreateImageView.
    if unsafe { extension::<vk::ImageViewUsageCreateInfo<'_>>(info.p_next) }.is_some() {
        return None;
    }
    let image = armed.objects.image(info.image)?;
    (image.granted != image.usage).then_some(image.usage)
}

/// `vkCreateImageView`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::ImageViewCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    view: *mut vk::ImageView,
) -> vk::Result {
    guard(
        "vkCreateImageView",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_image_view(device, info, allocator, view),
                vk::Result::ERROR_INITIALIZATION_FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `view` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_image_view) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let asked = known.armed.as_ref().and_then(|armed| asked_usage(armed, &*info));
                let result = answer.record(match asked {
                    Some(usage) => {
                        let mut usage = vk::ImageViewUsageCreateInfo::default().usage(usage);
                        usage.p_next = (*info).p_next;
                        let p_next = (&raw const usage).cast();
                        let amended = vk::ImageViewCreateInfo { p_next, ..*info };
                        next(device, &amended, allocator, view)
                    }
                    None => next(device, info, allocator, view),
                });
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                    match View::created(&armed.objects, &*info) {
                        Some(found) => {
                            if found.is_colour_target {
                                armed.objects.descriptors.add_view(*view);
                            }
                            armed.objects.views.insert(*view, found);
                        }
                        None => drop(armed.objects.views.remove(*view)),
                    }
                }
                result
            }
        },
    )
}

/// `vkDestroyImageView`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    view: vk::ImageView,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyImageView",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_image_view(device, view, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_image_view) else {
                    return;
                };
                if let Some(armed) = &known.armed {
                    armed.objects.views.remove(view);
                }
                next(device, view, allocator);
                answer.made();
            }
        },
    );
}
