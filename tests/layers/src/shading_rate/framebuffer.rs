//! Framebuffers, imageless ones too.

use super::chain::{LeftOut, find, slice};
use super::findings::Findings;
use super::image::View;
use super::lower::{self, RATE_USAGE};
use super::render_pass::{RateAttachment, RenderPass};
use super::{Emulator, emulator};
use ash::vk;
use std::sync::Arc;

pub(super) struct Framebuffer {
    /// The rate attachments of the render pass that it was made for.
    pub rates: Vec<Option<RateAttachment>>,
    /// None where it is imageless.
    pub views: Option<Vec<vk::ImageView>>,
    /// The usages that an imageless one was promised.
    pub usages: Vec<vk::ImageUsageFlags>,
    pub layers: u32,
}

const KIND: &str = "framebuffer";

/// # Safety
/// As `vkCreateFramebuffer`.
pub(super) unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::FramebufferCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    framebuffer: *mut vk::Framebuffer,
) -> vk::Result {
    // SAFETY: the application's valid arguments, with other usages; the copies live until the removed
    // structures are put back.
    unsafe {
        let emulator = emulator(device);
        let imageless = (*info).flags.contains(vk::FramebufferCreateFlags::IMAGELESS);
        let promised = find::<vk::FramebufferAttachmentsCreateInfo<'_>>((*info).p_next);
        let images = promised.filter(|_| imageless).map_or(&[][..], |promised| {
            slice(promised.p_attachment_image_infos, promised.attachment_image_info_count)
        });
        let mut lowered = *info;
        let mut lowered_images = images.to_vec();
        let mut replacement;
        let mut left_out = LeftOut::new();
        if let Some(promised) = promised.filter(|_| imageless) {
            for image in &mut lowered_images {
                image.usage = lower::usage(image.usage);
            }
            left_out.leave_out(&mut lowered, vk::StructureType::FRAMEBUFFER_ATTACHMENTS_CREATE_INFO);
            replacement = *promised;
            replacement.p_attachment_image_infos = lowered_images.as_ptr();
            replacement.p_next = lowered.p_next;
            lowered.p_next = (&raw const replacement).cast();
        }
        let result = (emulator.v1_0().create_framebuffer)(device, &lowered, allocator, framebuffer);
        drop(left_out);
        let created = result == vk::Result::SUCCESS;
        let handle = if created { *framebuffer } else { vk::Framebuffer::null() };
        let mut state = emulator.state();
        let state = &mut *state;
        let Some(render_pass) = state.render_passes.get(&(*info).render_pass) else { return result };
        let views = slice((*info).p_attachments, if imageless { 0 } else { (*info).attachment_count });
        let attachments: Vec<Option<Attachment>> = if imageless {
            images.iter().map(|image| Some(Attachment::promised(image))).collect()
        } else {
            views.iter().map(|view| state.views.get(view).and_then(Attachment::of)).collect()
        };
        let ids = if imageless { &IMAGELESS } else { &WITH_IMAGES };
        check(&emulator, &mut state.findings, &*info, render_pass, &attachments, ids, handle);
        if created {
            let known = Framebuffer {
                rates: render_pass.rates.clone(),
                views: (!imageless).then(|| views.to_vec()),
                usages: images.iter().map(|image| image.usage).collect(),
                layers: (*info).layers,
            };
            state.framebuffers.insert(handle, Arc::new(known));
        }
        result
    }
}

/// Facts about an attachment at the creation of the framebuffer.
struct Attachment {
    usage: vk::ImageUsageFlags,
    width: u32,
    height: u32,
    layers: u32,
}

impl Attachment {
    fn promised(image: &vk::FramebufferAttachmentImageInfo<'_>) -> Self {
        Self { usage: image.usage, width: image.width, height: image.height, layers: image.layer_count }
    }

    fn of(view: &View) -> Option<Self> {
        let vk::Extent2D { width, height } = view.extent;
        Some(Self { usage: view.usage?, width, height, layers: view.range.layers })
    }
}

/// The IDs of the rules of usage, width, height, layers, and layers with multiview.
struct Ids {
    usage: &'static str,
    width: &'static str,
    height: &'static str,
    layers: &'static str,
    views: &'static str,
}

const WITH_IMAGES: Ids =
    Ids { usage: "04548", width: "04539", height: "04540", layers: "04538", views: "04537" };
const IMAGELESS: Ids =
    Ids { usage: "04549", width: "04543", height: "04544", layers: "04545", views: "04587" };

fn check(
    emulator: &Emulator,
    findings: &mut Findings,
    info: &vk::FramebufferCreateInfo<'_>,
    render_pass: &RenderPass,
    attachments: &[Option<Attachment>],
    ids: &Ids,
    framebuffer: vk::Framebuffer,
) {
    let mask = render_pass.view_masks.iter().fold(0, |all, mask| all | mask);
    for rate in render_pass.rates.iter().flatten() {
        let Some(Some(attachment)) = attachments.get(rate.attachment as usize) else { continue };
        let mut require = |holds, id: &str, message: String| {
            let rule = format!("VUID-VkFramebufferCreateInfo-flags-{id}");
            findings.require(holds, KIND, &rule, framebuffer, || message);
        };
        require(attachment.usage.contains(RATE_USAGE), ids.usage, format!("{:?}", attachment.usage));
        let [texel_width, texel_height] = rate.texel.map(|side| side.max(1));
        let (width, height) = (info.width.div_ceil(texel_width), info.height.div_ceil(texel_height));
        require(attachment.width >= width, ids.width, format!("{} of {width} texels", attachment.width));
        require(attachment.height >= height, ids.height, format!("{} of {height} texels", attachment.height));
        let layers = attachment.layers;
        if mask != 0 {
            let enough = layers == 1 || layers >= u32::BITS - mask.leading_zeros();
            require(enough, ids.views, format!("{layers} layers for the views {mask:#b}"));
        } else {
            let enough = layers == 1 || layers >= info.layers;
            require(enough, ids.layers, format!("{layers} layers for {}", info.layers));
        }
        let layered = layers == 1 || emulator.profile.layered();
        findings.require(layered, KIND, "layeredShadingRateAttachments", framebuffer, || {
            format!("{layers} layers")
        });
    }
}

/// # Safety
/// As `vkDestroyFramebuffer`.
pub(super) unsafe extern "system" fn destroy(
    device: vk::Device,
    framebuffer: vk::Framebuffer,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(device);
        emulator.state().framebuffers.remove(&framebuffer);
        (emulator.v1_0().destroy_framebuffer)(device, framebuffer, allocator);
    }
}
