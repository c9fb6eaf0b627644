//! Views of images.

use super::Objects;
use crate::abi::guard;
use crate::scene::Target;
use crate::vk::device;
use ash::vk;

/// A live view.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// The image, its first level and its layers in the view.
    pub target: Target,
    /// The view's format, which may be another than the image's.
    #[allow(dead_code, reason = "for the mask, whose fill draws through such a view")]
    pub format: vk::Format,
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
        })
    }
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
        || vk::Result::ERROR_INITIALIZATION_FAILED,
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `view` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_image_view) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let result = answer.record(next(device, info, allocator, view));
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                    match View::created(&armed.objects, &*info) {
                        Some(found) => armed.objects.views.insert(*view, found),
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
        || (),
        |_| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_image_view) else {
                    return;
                };
                if let Some(armed) = &known.armed {
                    armed.objects.views.remove(view);
                }
                next(device, view, allocator);
            }
        },
    );
}
