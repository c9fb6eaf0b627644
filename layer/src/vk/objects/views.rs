//! Views of images.

use super::Objects;
use crate::abi::guard;
use crate::scene::Target;
use crate::vk::armed::Armed;
use crate::vk::chain::extension;
use crate::vk::device;
use ash::vk;

/// A live view.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// The image, its first level and its layers in the view.
    pub target: Target,
    /// The view's format, which may be another than the image's.
    pub format: vk::Format,
    /// Whether passes may draw colours to the image that shaders read.
    pub is_colour_target: bool,
}

impl View {
    fn created(objects: &Objects, info: &vk::ImageViewCreateInfo<'_>) -> Option<Self> {
        let image = objects.image(info.image)?;
        let range = info.subresource_range;
        let rest = image.description.layers.saturating_sub(range.base_array_layer);
        Some(Self {
            target: Target {
                image: image.description.key,
                level: range.base_mip_level,
                base_layer: range.base_array_layer,
                layers: if range.layer_count == vk::REMAINING_ARRAY_LAYERS {
                    rest
                } else {
                    range.layer_count
                },
            },
            format: info.format,
            is_colour_target: image.usage.contains(vk::ImageUsageFlags::COLOR_ATTACHMENT)
                && !image.description.is_cube,
        })
    }
}

/// The usage of a view as the application thinks it to be, where its image has more: it must be what the application says
/// of imageless framebuffers.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateImageView).
unsafe fn asked_usage(armed: &Armed, info: &vk::ImageViewCreateInfo<'_>) -> Option<vk::ImageUsageFlags> {
    if armed.masks.is_none() || armed.record.api_version < vk::API_VERSION_1_1 {
        return None;
    }
    // SAFETY: the caller vouches for the chain.
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
