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
            // SAFETY: `device` is live, by the valid usage of vkCreateFramebuffer.
            let found = unsafe { device::with(device, |next| next.create_framebuffer) };
            let Some((known, next)) = found else { return vk::Result::ERROR_INITIALIZATION_FAILED };
            let arguments = (device, info, allocator, framebuffer);
            // SAFETY: the next layer's function, with the application's own arguments.
            let create = || unsafe { next(device, info, allocator, framebuffer) };
            let Some(armed) = &known.armed else { return answer.record(create()) };
            let objects = &armed.objects;
            // SAFETY: the pointer is valid, by the same valid usage.
            let (created, pass) = unsafe { (Framebuffer::created(objects, &*info), (*info).render_pass) };
            let result = answer.record(match known.rates() {
                Some(rates) => {
                    let pass = objects.render_pass(pass);
                    let color = pass.and_then(|pass| pass.colors.first().copied()).unwrap_or(0);
                    let target = created.attachments.get(color as usize).copied().flatten();
                    let target = target.and_then(|target| objects.with_image(target));
                    // SAFETY: the application's own arguments, and the next layer's function for them.
                    unsafe { rates.create_framebuffer(arguments, color, target, next) }
                }
                None => create(),
            });
            if result == vk::Result::SUCCESS {
                // SAFETY: the pointer is valid, by the same valid usage, and the call has written the framebuffer.
                objects.framebuffers.insert(unsafe { *framebuffer }, Arc::new(created));
            }
            result
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
