//! Hooks of render passes.

use crate::vk::device;
use crate::vk::objects::RenderPass;
use ash::vk;
use std::sync::Arc;

/// `vkCreateRenderPass`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pass: *mut vk::RenderPass,
) -> vk::Result {
    hook!(
        "vkCreateRenderPass",
        device::with,
        create_render_pass(device, info, allocator, pass),
        |known, next, answer| {
            let result = answer.record(match known.rate_attachments() {
                Some(rates) => {
                    let next2 = known.hooked.create_render_pass2;
                    // SAFETY: the application's own arguments, and the next layer's functions for them.
                    unsafe { rates.create_render_pass((device, info, allocator, pass), next, next2) }
                }
                // SAFETY: the next layer's function, with the application's own arguments.
                None => unsafe { next(device, info, allocator, pass) },
            });
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: both pointers are valid, by valid usage, and the call has written the render pass.
                let (info, pass) = unsafe { (&*info, *pass) };
                // SAFETY: the structure is that of vkCreateRenderPass.
                let described = Arc::new(unsafe { RenderPass::of_version_1(info) });
                if let Some(masks) = &armed.masks {
                    // SAFETY: `pass` was made of `info` on this device, whose function `next` is.
                    unsafe { masks.add_render_pass(device, (pass, &described), info, next) };
                    // SAFETY: the same function, with the arguments that were valid just now and a render pass to write.
                    let again = |made: &mut _| unsafe { next(device, info, std::ptr::null(), made) };
                    masks.add_compatible(pass, &described, again);
                }
                armed.objects.render_passes.insert(pass, described);
            }
            result
        }
    )
}

/// `vkCreateRenderPass2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn create2(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo2<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pass: *mut vk::RenderPass,
) -> vk::Result {
    hook!(
        "vkCreateRenderPass2",
        device::with,
        create_render_pass2(device, info, allocator, pass),
        |known, next, answer| {
            let result = answer.record(match known.rate_attachments() {
                // SAFETY: the application's own arguments, and the next layer's function for them.
                Some(rates) => unsafe { rates.create_render_pass2((device, info, allocator, pass), next) },
                // SAFETY: the next layer's function, with the application's own arguments.
                None => unsafe { next(device, info, allocator, pass) },
            });
            if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                // SAFETY: both pointers are valid, by valid usage, and the call has written the render pass.
                let (info, pass) = unsafe { (&*info, *pass) };
                // SAFETY: the structure is that of vkCreateRenderPass2.
                let described = Arc::new(unsafe { RenderPass::of_version_2(info) });
                if let Some(masks) = &armed.masks {
                    // SAFETY: `pass` was made of `info` on this device, whose function `next` is.
                    unsafe { masks.add_render_pass2(device, (pass, &described), info, next) };
                    // SAFETY: the same function, with the arguments that were valid just now and a render pass to write.
                    let again = |made: &mut _| unsafe { next(device, info, std::ptr::null(), made) };
                    masks.add_compatible(pass, &described, again);
                }
                armed.objects.render_passes.insert(pass, described);
            }
            result
        }
    )
}

/// `vkDestroyRenderPass`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    pass: vk::RenderPass,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    hook!(
        "vkDestroyRenderPass",
        device::with,
        destroy_render_pass(device, pass, allocator),
        |known, next, answer| {
            if let Some(armed) = &known.armed {
                armed.objects.render_passes.remove(pass);
                let ours = armed.masks.as_ref().and_then(|masks| masks.forget_render_pass(pass));
                if let Some(ours) = ours {
                    // SAFETY: it was made on this device without an allocator, and nothing uses it any more.
                    unsafe { next(device, ours, std::ptr::null()) };
                }
            }
            if let Some(rates) = known.rate_attachments() {
                rates.forget_render_pass(pass);
            }
            // SAFETY: the next layer's function, with the application's own arguments.
            unsafe { next(device, pass, allocator) };
            answer.made();
        }
    );
}
