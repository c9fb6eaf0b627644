//! Hooks of render passes.

use crate::abi::guard;
use crate::vk::device;
use crate::vk::objects::RenderPass;
use ash::vk;
use std::sync::Arc;

/// `vkCreateRenderPass`.
pub unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pass: *mut vk::RenderPass,
) -> vk::Result {
    guard(
        "vkCreateRenderPass",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_render_pass(device, info, allocator, pass),
                vk::Result::ERROR_INITIALIZATION_FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `pass` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_render_pass) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let result = answer.record(match known.rates() {
                    Some(rates) => {
                        let next2 = known.hooked.create_render_pass2;
                        rates.create_render_pass((device, info, allocator, pass), next, next2)
                    }
                    None => next(device, info, allocator, pass),
                });
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                    let described = Arc::new(RenderPass::of_version_1(&*info));
                    if let Some(masks) = &armed.masks {
                        masks.add_render_pass(device, (*pass, &described), &*info, next);
                        let none = std::ptr::null();
                        masks.add_compatible(*pass, &described, |made| next(device, info, none, made));
                    }
                    armed.objects.render_passes.insert(*pass, described);
                }
                result
            }
        },
    )
}

/// `vkCreateRenderPass2`.
pub unsafe extern "system" fn create2(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo2<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pass: *mut vk::RenderPass,
) -> vk::Result {
    guard(
        "vkCreateRenderPass2",
        // SAFETY: the application's own arguments.
        || unsafe {
            pass_on!(
                device::with: device,
                create_render_pass2(device, info, allocator, pass),
                vk::Result::ERROR_INITIALIZATION_FAILED
            )
        },
        |answer| {
            // SAFETY: the application's own arguments; on success `info` and `pass` are valid.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.create_render_pass2) else {
                    return vk::Result::ERROR_INITIALIZATION_FAILED;
                };
                let result = answer.record(match known.rates() {
                    Some(rates) => rates.create_render_pass2((device, info, allocator, pass), next),
                    None => next(device, info, allocator, pass),
                });
                if let (Some(armed), vk::Result::SUCCESS) = (&known.armed, result) {
                    let described = Arc::new(RenderPass::of_version_2(&*info));
                    if let Some(masks) = &armed.masks {
                        masks.add_render_pass2(device, (*pass, &described), &*info, next);
                        let none = std::ptr::null();
                        masks.add_compatible(*pass, &described, |made| next(device, info, none, made));
                    }
                    armed.objects.render_passes.insert(*pass, described);
                }
                result
            }
        },
    )
}

/// `vkDestroyRenderPass`.
pub unsafe extern "system" fn destroy(
    device: vk::Device,
    pass: vk::RenderPass,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    guard(
        "vkDestroyRenderPass",
        // SAFETY: the application's own arguments.
        || unsafe { pass_on!(device::with: device, destroy_render_pass(device, pass, allocator), ()) },
        |answer| {
            // SAFETY: the application's own arguments.
            unsafe {
                let Some((known, next)) = device::with(device, |next| next.destroy_render_pass) else {
                    return;
                };
                if let Some(armed) = &known.armed {
                    armed.objects.render_passes.remove(pass);
                    let ours = armed.masks.as_ref().and_then(|masks| masks.forget_render_pass(pass));
                    if let Some(ours) = ours {
                        next(device, ours, std::ptr::null());
                    }
                }
                if let Some(rates) = known.rates() {
                    rates.forget_render_pass(pass);
                }
                next(device, pass, allocator);
                answer.made();
            }
        },
    );
}
