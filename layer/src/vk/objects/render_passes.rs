//! Render passes.

mod describe;

use crate::abi::guard;
use crate::scene::PassFacts;
use crate::vk::device;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// A live render pass, as the application created it.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderPass {
    /// Its attachments.
    pub attachments: Vec<Attachment>,
    /// Its subpasses.
    pub subpasses: Vec<Subpass>,
    /// Attachments that any subpass draws colour to, each once.
    pub colors: SmallVec<[u32; 8]>,
    /// Attachments that any subpass resolves colour to, each once.
    pub resolves: SmallVec<[u32; 4]>,
    /// The first subpass's depth attachment, or that of the first that has one.
    pub depth: Option<u32>,
    /// The views of all subpasses (multiview); 0 without.
    pub view_mask: u32,
    /// What is known of every instance of it.
    pub facts: PassFacts,
}

/// One attachment of a render pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attachment {
    /// Its format.
    pub format: vk::Format,
    /// Samples of a pixel.
    pub samples: vk::SampleCountFlags,
    /// What happens to colour or depth at the begin.
    pub load: vk::AttachmentLoadOp,
    /// What happens to colour or depth at the end.
    pub store: vk::AttachmentStoreOp,
    /// What happens to stencil at the begin.
    pub stencil_load: vk::AttachmentLoadOp,
    /// What happens to stencil at the end.
    pub stencil_store: vk::AttachmentStoreOp,
    /// Layout at the begin.
    pub initial_layout: vk::ImageLayout,
    /// Layout at the end.
    pub final_layout: vk::ImageLayout,
}

impl Attachment {
    /// Whether it has stencil that is stored.
    pub fn stores_stencil(&self) -> bool {
        describe::has_stencil(self.format) && self.stencil_store == vk::AttachmentStoreOp::STORE
    }
}

/// One subpass. Attachments are named by their index in the render pass.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Subpass {
    /// Colour attachments, by location.
    pub colors: SmallVec<[Option<u32>; 4]>,
    /// What each of `colors` is resolved to; empty without resolves.
    pub resolves: SmallVec<[Option<u32>; 4]>,
    /// Depth attachment, with its layout.
    pub depth: Option<(u32, vk::ImageLayout)>,
    /// Input attachments.
    pub inputs: SmallVec<[Option<u32>; 4]>,
    /// Multiview's mask; 0 without.
    pub view_mask: u32,
    /// Whether the application gives it rates of its own, or a density map.
    pub has_own_rates: bool,
    /// Whether depth or stencil is resolved at its end.
    pub resolves_depth: bool,
}

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

#[cfg(test)]
mod tests;
