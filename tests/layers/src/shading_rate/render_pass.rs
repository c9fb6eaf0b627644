//! Render passes: a rate attachment stays, as one that no subpass uses.

use super::barrier::check_stages;
use super::chain::{LeftOut, find, slice};
use super::findings::Findings;
use super::lower::{self, RATE_LAYOUT};
use super::physical_device::FORMAT;
use super::rate::SUBPASS_TEXEL;
use super::replay::reaches_rate_stage;
use super::{Emulator, emulator};
use ash::vk;
use std::sync::Arc;

/// A subpass's rate attachment.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct RateAttachment {
    pub attachment: u32,
    pub texel: [u32; 2],
}

/// An attachment's layouts before and after the render pass.
#[derive(Clone, Copy)]
pub(super) struct Layouts {
    pub initial: vk::ImageLayout,
    pub last: vk::ImageLayout,
}

pub(super) struct RenderPass {
    /// Of each subpass.
    pub rates: Vec<Option<RateAttachment>>,
    pub view_masks: Vec<u32>,
    pub layouts: Vec<Layouts>,
    /// The colour attachments of the first subpass.
    pub colours: Vec<u32>,
    /// Stages before the render pass that a dependency makes the rate stage wait for.
    pub waits_for: (vk::PipelineStageFlags2, vk::AccessFlags2),
}

/// Whether render passes with these rate attachments are compatible: the same subpasses have one, and each as
/// large texels. At which index it is does not matter.
pub(super) fn are_compatible(some: &[Option<RateAttachment>], others: &[Option<RateAttachment>]) -> bool {
    let texel = |rate: &Option<RateAttachment>| rate.map(|rate| rate.texel);
    some.iter().map(texel).eq(others.iter().map(texel))
}

const KIND: &str = "render_pass";

/// # Safety
/// As `vkCreateRenderPass`.
pub(super) unsafe extern "system" fn create(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    render_pass: *mut vk::RenderPass,
) -> vk::Result {
    // SAFETY: the application's valid arguments, with other layouts and stages.
    unsafe {
        let emulator = emulator(device);
        let mut lowered = *info;
        let mut attachments = slice(lowered.p_attachments, lowered.attachment_count).to_vec();
        for attachment in &mut attachments {
            attachment.initial_layout = lower::layout(attachment.initial_layout);
            attachment.final_layout = lower::layout(attachment.final_layout);
        }
        lowered.p_attachments = attachments.as_ptr();
        let mut dependencies = slice(lowered.p_dependencies, lowered.dependency_count).to_vec();
        for dependency in &mut dependencies {
            dependency.src_stage_mask = lower::stages(dependency.src_stage_mask);
            dependency.dst_stage_mask = lower::stages(dependency.dst_stage_mask);
            dependency.src_access_mask = lower::access(dependency.src_access_mask);
            dependency.dst_access_mask = lower::access(dependency.dst_access_mask);
        }
        lowered.p_dependencies = dependencies.as_ptr();
        let result = (emulator.v1_0().create_render_pass)(device, &lowered, allocator, render_pass);
        if result == vk::Result::SUCCESS {
            let subpasses = (*info).subpass_count as usize;
            let known = RenderPass {
                rates: vec![None; subpasses],
                view_masks: vec![0; subpasses],
                layouts: Vec::new(),
                colours: Vec::new(),
                waits_for: Default::default(),
            };
            emulator.state().render_passes.insert(*render_pass, Arc::new(known));
        }
        result
    }
}

/// # Safety
/// As `vkCreateRenderPass2`.
pub(super) unsafe extern "system" fn create2(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo2<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    render_pass: *mut vk::RenderPass,
) -> vk::Result {
    // SAFETY: the application's valid arguments, without the extension's structures; the copies, of which the
    // barriers are not moved any more once they are chained, live until the removed structures are put back.
    unsafe {
        let emulator = emulator(device);
        let Some(next) = emulator.functions.create_render_pass2 else { return vk::Result::ERROR_UNKNOWN };
        let known = describe(&*info);
        let mut lowered = *info;
        let mut attachments = slice(lowered.p_attachments, lowered.attachment_count).to_vec();
        for attachment in &mut attachments {
            attachment.initial_layout = lower::layout(attachment.initial_layout);
            attachment.final_layout = lower::layout(attachment.final_layout);
        }
        lowered.p_attachments = attachments.as_ptr();
        let mut subpasses = slice(lowered.p_subpasses, lowered.subpass_count).to_vec();
        let mut dependencies = slice(lowered.p_dependencies, lowered.dependency_count).to_vec();
        let mut barriers: Vec<_> = dependencies.iter().map(barrier_of).collect();
        let mut left_out = LeftOut::new();
        for subpass in &mut subpasses {
            left_out.leave_out(subpass, vk::StructureType::FRAGMENT_SHADING_RATE_ATTACHMENT_INFO_KHR);
        }
        lowered.p_subpasses = subpasses.as_ptr();
        for (dependency, barrier) in dependencies.iter_mut().zip(&mut barriers) {
            dependency.src_stage_mask = lower::stages(dependency.src_stage_mask);
            dependency.dst_stage_mask = lower::stages(dependency.dst_stage_mask);
            dependency.src_access_mask = lower::access(dependency.src_access_mask);
            dependency.dst_access_mask = lower::access(dependency.dst_access_mask);
            if find::<vk::MemoryBarrier2<'_>>(dependency.p_next).is_some() {
                left_out.leave_out(dependency, vk::StructureType::MEMORY_BARRIER_2);
                barrier.src_stage_mask = lower::stages2(barrier.src_stage_mask);
                barrier.dst_stage_mask = lower::stages2(barrier.dst_stage_mask);
                barrier.src_access_mask = lower::access2(barrier.src_access_mask);
                barrier.dst_access_mask = lower::access2(barrier.dst_access_mask);
                barrier.p_next = dependency.p_next;
                dependency.p_next = std::ptr::from_ref(barrier).cast();
            }
        }
        lowered.p_dependencies = dependencies.as_ptr();
        let result = next(device, &lowered, allocator, render_pass);
        drop(left_out);
        let created = result == vk::Result::SUCCESS;
        let handle = if created { *render_pass } else { vk::RenderPass::null() };
        let mut state = emulator.state();
        check(&emulator, &mut state.findings, &*info, handle);
        if created {
            state.render_passes.insert(handle, Arc::new(known));
        }
        result
    }
}

/// The masks of a dependency; a chained VkMemoryBarrier2's take precedence.
///
/// # Safety
///
/// The dependency's chain is valid.
unsafe fn masks_of<'a>(dependency: &vk::SubpassDependency2<'a>) -> vk::MemoryBarrier2<'a> {
    // SAFETY: the caller vouches for it.
    let chained = unsafe { find::<vk::MemoryBarrier2<'_>>(dependency.p_next) };
    chained.copied().unwrap_or_else(|| {
        let wide = |stages: vk::PipelineStageFlags| vk::PipelineStageFlags2::from_raw(stages.as_raw().into());
        let wide_access = |access: vk::AccessFlags| vk::AccessFlags2::from_raw(access.as_raw().into());
        vk::MemoryBarrier2::default()
            .src_stage_mask(wide(dependency.src_stage_mask))
            .src_access_mask(wide_access(dependency.src_access_mask))
            .dst_stage_mask(wide(dependency.dst_stage_mask))
            .dst_access_mask(wide_access(dependency.dst_access_mask))
    })
}

fn barrier_of<'a>(dependency: &vk::SubpassDependency2<'a>) -> vk::MemoryBarrier2<'a> {
    // SAFETY: called with the application's valid structures only.
    unsafe { masks_of(dependency) }
}

/// The rate attachment of a subpass, and its layout.
///
/// # Safety
///
/// The subpass and its chain are valid.
unsafe fn rate_of(subpass: &vk::SubpassDescription2<'_>) -> Option<(RateAttachment, vk::ImageLayout)> {
    // SAFETY: the caller vouches for it.
    unsafe {
        let info = find::<vk::FragmentShadingRateAttachmentInfoKHR<'_>>(subpass.p_next)?;
        let reference = info.p_fragment_shading_rate_attachment.as_ref()?;
        let texel = info.shading_rate_attachment_texel_size;
        let rate = RateAttachment { attachment: reference.attachment, texel: [texel.width, texel.height] };
        (rate.attachment != vk::ATTACHMENT_UNUSED).then_some((rate, reference.layout))
    }
}

/// # Safety
///
/// The structure and everything it points to are valid.
unsafe fn describe(info: &vk::RenderPassCreateInfo2<'_>) -> RenderPass {
    // SAFETY: the caller vouches for it.
    unsafe {
        let attachments = slice(info.p_attachments, info.attachment_count);
        let subpasses = slice(info.p_subpasses, info.subpass_count);
        let rates = subpasses.iter().map(|subpass| rate_of(subpass).map(|(rate, _)| rate)).collect();
        let colours = subpasses
            .first()
            .map_or(&[][..], |subpass| slice(subpass.p_color_attachments, subpass.color_attachment_count));
        let mut waits_for = (vk::PipelineStageFlags2::NONE, vk::AccessFlags2::NONE);
        for dependency in slice(info.p_dependencies, info.dependency_count) {
            let masks = masks_of(dependency);
            let from_before = dependency.src_subpass == vk::SUBPASS_EXTERNAL;
            if from_before && reaches_rate_stage(masks.dst_stage_mask, masks.dst_access_mask) {
                waits_for.0 |= masks.src_stage_mask;
                waits_for.1 |= masks.src_access_mask;
            }
        }
        RenderPass {
            rates,
            view_masks: subpasses.iter().map(|subpass| subpass.view_mask).collect(),
            layouts: attachments
                .iter()
                .map(|attachment| Layouts {
                    initial: attachment.initial_layout,
                    last: attachment.final_layout,
                })
                .collect(),
            colours: colours.iter().map(|colour| colour.attachment).collect(),
            waits_for,
        }
    }
}

/// # Safety
///
/// The structure and everything it points to are valid.
unsafe fn check(
    emulator: &Emulator,
    findings: &mut Findings,
    info: &vk::RenderPassCreateInfo2<'_>,
    render_pass: vk::RenderPass,
) {
    // SAFETY: the caller vouches for it.
    unsafe {
        let attachments = slice(info.p_attachments, info.attachment_count);
        let subpasses = slice(info.p_subpasses, info.subpass_count);
        let other_uses: Vec<u32> = subpasses.iter().flat_map(|subpass| other_uses(subpass)).collect();
        for dependency in slice(info.p_dependencies, info.dependency_count) {
            let masks = masks_of(dependency);
            check_stages(
                emulator,
                findings,
                masks.src_stage_mask,
                "VkSubpassDependency2-srcStageMask-07318",
                render_pass,
            );
            check_stages(
                emulator,
                findings,
                masks.dst_stage_mask,
                "VkSubpassDependency2-dstStageMask-07318",
                render_pass,
            );
        }
        for subpass in subpasses {
            let chained = find::<vk::FragmentShadingRateAttachmentInfoKHR<'_>>(subpass.p_next).is_some();
            let mut require = |holds, rule: &str, message: String| {
                findings.require(holds, KIND, rule, render_pass, || message);
            };
            let rule = "VUID-VkSubpassDescription2-pNext-pNext";
            require(!chained || emulator.enabled.extension, rule, "the extension is not enabled".to_owned());
            let Some((rate, layout)) = rate_of(subpass) else { continue };
            let message = "rate attachment".to_owned();
            require(emulator.enabled.attachment, "attachmentFragmentShadingRate", message);
            let rule = "VUID-VkFragmentShadingRateAttachmentInfoKHR-pFragmentShadingRateAttachment-04524";
            let allowed = [vk::ImageLayout::GENERAL, RATE_LAYOUT].contains(&layout);
            require(allowed, rule, format!("{layout:?}"));
            let index = rate.attachment as usize;
            let Some(attachment) = attachments.get(index) else {
                let rule = "VUID-VkRenderPassCreateInfo2-attachment-03051";
                require(false, rule, format!("attachment {index} of {}", attachments.len()));
                continue;
            };
            let rule = "VUID-VkRenderPassCreateInfo2-pAttachments-04585";
            let both = format!("attachment {index} is used otherwise too");
            require(!other_uses.contains(&rate.attachment), rule, both);
            let rule = "VUID-VkRenderPassCreateInfo2-pAttachments-04586";
            require(attachment.format == FORMAT, rule, format!("{:?}", attachment.format));
            let kept = attachment.load_op == vk::AttachmentLoadOp::LOAD
                && attachment.initial_layout != vk::ImageLayout::UNDEFINED;
            let message = format!("{:?} from {:?}", attachment.load_op, attachment.initial_layout);
            require(kept, "rate attachment is loaded", message);
            let [width, height] = rate.texel;
            SUBPASS_TEXEL.check(emulator, findings, vk::Extent2D { width, height }, render_pass);
        }
    }
}

/// The attachments that a subpass uses, other than for rates.
///
/// # Safety
///
/// The subpass is valid.
unsafe fn other_uses(subpass: &vk::SubpassDescription2<'_>) -> Vec<u32> {
    // SAFETY: the caller vouches for it; there are as many resolve as colour attachments, or none.
    unsafe {
        let colours = subpass.color_attachment_count;
        [
            slice(subpass.p_color_attachments, colours),
            slice(subpass.p_resolve_attachments, colours),
            slice(subpass.p_input_attachments, subpass.input_attachment_count),
            slice(subpass.p_depth_stencil_attachment, 1),
        ]
        .concat()
        .iter()
        .map(|reference| reference.attachment)
        .collect()
    }
}

/// # Safety
/// As `vkDestroyRenderPass`.
pub(super) unsafe extern "system" fn destroy(
    device: vk::Device,
    render_pass: vk::RenderPass,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(device);
        emulator.state().render_passes.remove(&render_pass);
        (emulator.v1_0().destroy_render_pass)(device, render_pass, allocator);
    }
}
