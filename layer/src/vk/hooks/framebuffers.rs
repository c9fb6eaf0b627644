//! Hooks of framebuffers.

use crate::abi::guard;
use crate::vk::device;
use crate::vk::objects::Framebuffer;
use ash::vk;
use std::sync::Arc;

/// `vkCreateFramebuffer`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::FramebufferCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    framebuffer: *mut vk::Framebuffer,
) -> vk::Result {
    guard(
        "vkCreateFramebuffer",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_framebuffer(device, info, allocator, framebuffer),
                vk::Result::ERROR_INITIALIZATION_FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `framebuffer` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_framebuffer) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let Some(armed) = &known.armed else {
                    return answer.record(next(device, info, allocator, framebuffer));
                };
                let objects = &armed.objects;
                let created = Framebuffer::created(objects, &*info);
                let result = answer.record(match known.rates() {
                    Some(rates) => {
                        let pass = objects.render_pass((*info).render_pass);
                        let color = pass.and_then(|pass| pass.colors.first().copied()).unwrap_or(0);
                        let target = created.attachments.get(color as usize).copied().flatten();
                        let target = target.and_then(|target| objects.with_image(target));
                        rates.create_framebuffer((device, info, allocator, framebuffer), color, target, next)
                    }
                    None => next(device, info, allocator, framebuffer),
                });
                if result == vk::Result::SUCCESS {
                    objects.framebuffers.insert(*framebuffer, Arc::new(created));
                }
                result
            }
        },
    )
}

/// `vkDestroyFramebuffer`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    framebuffer: vk::Framebuffer,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyFramebuffer",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_framebuffer(device, framebuffer, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_framebuffer) else {
                    return;
                };
                if let Some(armed) = &known.armed {
                    armed.objects.framebuffers.remove(framebuffer);
                }
                if let Some(rates) = known.rates() {
                    rates.forget_framebuffer(framebuffer);
                }
                next(device, framebuffer, allocator);
                answer.made();
            }
        },
    );
}
