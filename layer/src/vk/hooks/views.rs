//! Hooks of image views.

use crate::vk::armed::Armed;
use crate::vk::chain::extension;
use crate::vk::device;
use crate::vk::objects::{Objects, View};
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
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::ImageViewCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    view: *mut vk::ImageView,
) -> vk::Result {
    hook!(
        "vkCreateImageView",
        device::with,
        create_image_view(device, info, allocator, view),
        |known, next, answer| {
            // SAFETY: the next layer's function, with the application's structure or an amended copy of it.
            let create = |info: *const _| unsafe { next(device, info, allocator, view) };
            let Some(armed) = known.armed.as_ref().filter(|armed| !armed.ignores_runtime()) else {
                return answer.record(create(info));
            };
            // SAFETY: the pointer is valid, by valid usage, for the time of the call.
            let info = unsafe { &*info };
            // SAFETY: as above.
            let asked = unsafe { asked_usage(armed, info) };
            let result = answer.record(match asked {
                Some(usage) => {
                    let mut usage = vk::ImageViewUsageCreateInfo::default().usage(usage);
                    usage.p_next = info.p_next;
                    create(&vk::ImageViewCreateInfo { p_next: (&raw const usage).cast(), ..*info })
                }
                None => create(info),
            });
            if result == vk::Result::SUCCESS {
                // SAFETY: the pointer is valid, by valid usage, and the call has written the view.
                note_created(&armed.objects, unsafe { *view }, View::created(&armed.objects, info));
            }
            result
        }
    )
}

/// A view was created; `None` if its image is not known.
fn note_created(objects: &Objects, view: vk::ImageView, created: Option<View>) {
    match created {
        Some(created) => {
            forget(objects, view);
            if created.may_hold_picture {
                objects.descriptors.add_view(view);
            }
            objects.views.insert(view, created);
        }
        None => forget(objects, view),
    }
}

/// A view is gone.
fn forget(objects: &Objects, view: vk::ImageView) {
    if objects.views.remove(view).is_some_and(|view| view.may_hold_picture) {
        objects.descriptors.forget_view(view);
    }
}

/// `vkDestroyImageView`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    view: vk::ImageView,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!("vkDestroyImageView", device::with, destroy_image_view(device, view, allocator), |known, next| {
        if let Some(armed) = &known.armed {
            forget(&armed.objects, view);
        }
        next();
    });
}
