//! Render passes that load depth where the application's clear it. Two such are compatible (Vulkan specification, "Render
//! Pass Compatibility"), so that its framebuffers and pipelines go with both.

use super::Masks;
use super::parts::is_of_depth_alone;
use crate::gpu::{CompatiblePass, GpuError};
use crate::vk::objects::RenderPass;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;
use std::{ptr, slice};

/// A render pass of ours for pipelines of ours, with its description.
#[derive(Clone)]
pub struct Compatible {
    /// The pass.
    pub pass: Arc<CompatiblePass>,
    /// Description of the application's, and of this.
    pub description: Arc<RenderPass>,
}

impl Masks {
    /// A render pass was created: one that is compatible with it is made too, by `make`, as the application's may be gone when a
    /// pipeline of ours is made for it.
    pub fn add_compatible(
        &self,
        pass: vk::RenderPass,
        description: &Arc<RenderPass>,
        make: impl FnOnce(&mut vk::RenderPass) -> vk::Result,
    ) {
        drop(self.compatible.remove(pass));
        let Some(gpu) = self.gpu().filter(|_| !description.colors.is_empty()) else { return };
        let mut made = vk::RenderPass::null();
        if make(&mut made) == vk::Result::SUCCESS {
            // SAFETY: it was just made on this device.
            let pass_of_ours = Arc::new(unsafe { CompatiblePass::new(gpu, made) });
            let description = Arc::clone(description);
            self.compatible.insert(pass, Compatible { pass: pass_of_ours, description });
        }
    }

    /// A render pass was created by version 1 of the call: the one that loads is too, if it can ever be of use.
    ///
    /// # Safety
    ///
    /// `pass` was created from `info` on the live device, and `next` is a function of that device.
    pub unsafe fn add_render_pass(
        &self,
        device: vk::Device,
        pass: (vk::RenderPass, &RenderPass),
        info: &vk::RenderPassCreateInfo<'_>,
        next: vk::PFN_vkCreateRenderPass,
    ) {
        let Some((index, layout)) = cleared_depth(pass.1) else { return };
        // SAFETY: the render pass was created of the structure, which has so many attachments; the copy lives until the call
        // is over.
        unsafe {
            let mut attachments: SmallVec<[vk::AttachmentDescription; 8]> =
                slice::from_raw_parts(info.p_attachments, info.attachment_count as usize).into();
            attachments[index].load_op = vk::AttachmentLoadOp::LOAD;
            attachments[index].initial_layout = layout;
            let amended = vk::RenderPassCreateInfo { p_attachments: attachments.as_ptr(), ..*info };
            let mut made = vk::RenderPass::null();
            self.keep(pass.0, next(device, &amended, ptr::null(), &mut made), made);
        }
    }

    /// As [`Self::add_render_pass`], by version 2 of the call.
    ///
    /// # Safety
    ///
    /// As for [`Self::add_render_pass`].
    pub unsafe fn add_render_pass2(
        &self,
        device: vk::Device,
        pass: (vk::RenderPass, &RenderPass),
        info: &vk::RenderPassCreateInfo2<'_>,
        next: vk::PFN_vkCreateRenderPass2,
    ) {
        let Some((index, layout)) = cleared_depth(pass.1) else { return };
        // SAFETY: as above.
        unsafe {
            let mut attachments: SmallVec<[vk::AttachmentDescription2<'_>; 8]> =
                slice::from_raw_parts(info.p_attachments, info.attachment_count as usize).into();
            // A chained structure may specify a different stencil layout.
            if !attachments[index].p_next.is_null() {
                return;
            }
            attachments[index].load_op = vk::AttachmentLoadOp::LOAD;
            attachments[index].initial_layout = layout;
            let amended = vk::RenderPassCreateInfo2 { p_attachments: attachments.as_ptr(), ..*info };
            let mut made = vk::RenderPass::null();
            self.keep(pass.0, next(device, &amended, ptr::null(), &mut made), made);
        }
    }

    fn keep(&self, pass: vk::RenderPass, result: vk::Result, loading: vk::RenderPass) {
        match result {
            vk::Result::SUCCESS => self.loading.insert(pass, loading),
            result => GpuError::Call { call: "vkCreateRenderPass", result }.log("no mask for a render pass"),
        }
    }

    /// A render pass is about to be destroyed; returns ours, which goes with it.
    pub fn forget_render_pass(&self, pass: vk::RenderPass) -> Option<vk::RenderPass> {
        drop(self.compatible.remove(pass));
        self.loading.remove(pass)
    }

    /// Whether there is a render pass that loads depth where `pass` clears it.
    pub fn can_load(&self, pass: vk::RenderPass) -> bool {
        self.loading(pass).is_some()
    }

    /// The render pass that loads depth where `pass` clears it.
    pub(super) fn loading(&self, pass: vk::RenderPass) -> Option<vk::RenderPass> {
        self.loading.get(pass)
    }
}

/// Index and first layout of depth that is cleared, in a pass that may have a mask.
fn cleared_depth(pass: &RenderPass) -> Option<(usize, vk::ImageLayout)> {
    let (index, layout) = pass.subpasses.iter().find_map(|subpass| subpass.depth)?;
    let depth = pass.attachments.get(index as usize)?;
    // One without colour may be a pre-pass for others, which matters where depth has several samples.
    let is_drawn = !pass.colors.is_empty() || depth.samples != vk::SampleCountFlags::TYPE_1;
    let may = depth.load == vk::AttachmentLoadOp::CLEAR
        && is_drawn
        && !resolves_one_sample(pass)
        && !is_of_depth_alone(layout, depth.format);
    may.then_some((index as usize, layout))
}

/// Whether colour of one sample is resolved. This is invalid (VUID-VkSubpassDescription-pResolveAttachments-00848), so no pass of the
/// layer may copy it.
fn resolves_one_sample(pass: &RenderPass) -> bool {
    pass.subpasses.iter().flat_map(|subpass| subpass.colors.iter().zip(&subpass.resolves)).any(|ends| {
        let (Some(color), Some(_)) = ends else { return false };
        let color = pass.attachments.get(*color as usize);
        color.is_some_and(|color| color.samples == vk::SampleCountFlags::TYPE_1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::PassFacts;
    use crate::vk::objects::render_passes::{Attachment, Subpass};
    use smallvec::smallvec;

    fn attachment(samples: vk::SampleCountFlags, load: vk::AttachmentLoadOp) -> Attachment {
        Attachment {
            format: vk::Format::R8G8B8A8_UNORM,
            samples,
            load,
            store: vk::AttachmentStoreOp::STORE,
            stencil_load: vk::AttachmentLoadOp::DONT_CARE,
            stencil_store: vk::AttachmentStoreOp::DONT_CARE,
            initial_layout: vk::ImageLayout::UNDEFINED,
            final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }
    }

    /// Colour of so many samples that is resolved, or not, and depth that begins so.
    fn pass(samples: vk::SampleCountFlags, resolves: bool, load: vk::AttachmentLoadOp) -> RenderPass {
        let colour = attachment(samples, vk::AttachmentLoadOp::CLEAR);
        let subpass = Subpass {
            colors: smallvec![Some(0)],
            resolves: if resolves { smallvec![Some(2)] } else { smallvec![] },
            depth: Some((1, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL)),
            ..Subpass::default()
        };
        RenderPass {
            attachments: vec![
                colour,
                attachment(samples, load),
                attachment(vk::SampleCountFlags::TYPE_1, load),
            ],
            subpasses: vec![subpass],
            colors: smallvec![0],
            resolves: smallvec![2],
            depth: Some(1),
            view_mask: 0,
            facts: PassFacts::default(),
        }
    }

    #[test]
    fn passes_that_clear_depth_and_break_no_rule_have_one_that_loads_it() {
        let [one, four] = [vk::SampleCountFlags::TYPE_1, vk::SampleCountFlags::TYPE_4];
        let clear = vk::AttachmentLoadOp::CLEAR;
        let within = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        assert_eq!(cleared_depth(&pass(one, false, clear)), Some((1, within)));
        assert_eq!(cleared_depth(&pass(four, true, clear)), Some((1, within)));
        assert_eq!(cleared_depth(&pass(one, true, clear)), None);
        let prepass = |samples| RenderPass { colors: smallvec![], ..pass(samples, false, clear) };
        assert_eq!(cleared_depth(&prepass(one)), None);
        assert_eq!(cleared_depth(&prepass(four)), Some((1, within)));
        assert_eq!(cleared_depth(&pass(four, true, vk::AttachmentLoadOp::LOAD)), None);
        let depth_alone = |format| {
            let mut pass = pass(one, false, clear);
            pass.attachments[1].format = format;
            pass.subpasses[0].depth = Some((1, vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL));
            cleared_depth(&pass).is_some()
        };
        let formats = [vk::Format::D32_SFLOAT, vk::Format::D32_SFLOAT_S8_UINT, vk::Format::D24_UNORM_S8_UINT];
        assert_eq!(formats.map(depth_alone), [true, false, false], "stencil would need a layout of its own");
    }
}
