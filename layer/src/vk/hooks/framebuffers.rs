//! Hooks of framebuffers.

use crate::vk::device;
use crate::vk::objects::Framebuffer;
use ash::vk;
use std::sync::Arc;

/// `vkCreateFramebuffer`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::FramebufferCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    framebuffer: *mut vk::Framebuffer,
) -> vk::Result {
    hook!(
        "vkCreateFramebuffer",
        device::with,
        create_framebuffer(device, info, allocator, framebuffer),
        |known, next, answer| {
            let arguments = (device, info, allocator, framebuffer);
            // SAFETY: the next layer's function, with the application's own arguments.
            let create = || unsafe { next(device, info, allocator, framebuffer) };
            let Some(armed) = &known.armed else { return answer.record(create()) };
            let objects = &armed.objects;
            // SAFETY: the pointer is valid, by valid usage.
            let (created, pass) = unsafe { (Framebuffer::created(objects, &*info), (*info).render_pass) };
            let result = answer.record(match known.rate_attachments() {
                Some(rates) => {
                    let pass = objects.render_pass(pass);
                    let target_of = |index: u32| created.attachments.get(index as usize).copied().flatten();
                    let depth = pass.as_ref().and_then(|pass| target_of(pass.depth?));
                    let color = pass.and_then(|pass| pass.colors.first().copied()).unwrap_or(0);
                    let target = target_of(color).and_then(|target| {
                        Some((target, objects.image_of(target.image)?.description, depth.is_some()))
                    });
                    // SAFETY: the application's own arguments, and the next layer's function for them.
                    unsafe { rates.create_framebuffer(arguments, color, target, next) }
                }
                None => create(),
            });
            if result == vk::Result::SUCCESS {
                // SAFETY: the pointer is valid, by valid usage, and the call has written the framebuffer.
                objects.framebuffers.insert(unsafe { *framebuffer }, Arc::new(created));
            }
            result
        }
    )
}

/// `vkDestroyFramebuffer`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    framebuffer: vk::Framebuffer,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyFramebuffer",
        device::with,
        destroy_framebuffer(device, framebuffer, allocator),
        |known, next| {
            if let Some(armed) = &known.armed {
                armed.objects.framebuffers.remove(framebuffer);
            }
            if let Some(rates) = known.rate_attachments() {
                rates.forget_framebuffer(framebuffer);
            }
            next();
        }
    );
}
