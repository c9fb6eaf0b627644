//! Render passes of Vulkan 1.0 in the form of `VK_KHR_create_renderpass2`, which can have a rate attachment.

use super::LeftAlone;
use crate::abi::copies::{Copies, find, slice};
use ash::vk::{self, TaggedStructure};

/// The same render pass in the second version's structures.
///
/// # Errors
///
/// [`LeftAlone::Unknown`] where it has a structure that is not known here.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateRenderPass). The result points to memory of `info` and of `copies`.
pub unsafe fn convert<'c>(
    info: &vk::RenderPassCreateInfo<'c>,
    copies: &mut Copies<'_>,
) -> Result<vk::RenderPassCreateInfo2<'c>, LeftAlone> {
    // SAFETY: valid usage demands a valid chain.
    let extensions = unsafe { Extensions::of(info)? };
    // SAFETY: valid usage demands so many attachments, subpasses and dependencies.
    let (attachments, described, dependencies) = unsafe {
        (
            slice(info.p_attachments, info.attachment_count),
            slice(info.p_subpasses, info.subpass_count),
            slice(info.p_dependencies, info.dependency_count),
        )
    };
    let mut subpasses = Vec::with_capacity(described.len());
    for (index, subpass) in (0u32..).zip(described) {
        // SAFETY: valid usage demands valid subpasses.
        subpasses.push(unsafe { extensions.subpass(index, subpass, attachments, copies) });
    }
    let dependencies: Vec<_> =
        (0..).zip(dependencies).map(|(index, dependency)| extensions.dependency(index, dependency)).collect();
    let masks = extensions.correlation_masks;
    Ok(vk::RenderPassCreateInfo2 {
        flags: info.flags,
        attachment_count: info.attachment_count,
        p_attachments: copies.many(attachments.iter().map(attachment)),
        subpass_count: info.subpass_count,
        p_subpasses: copies.many(subpasses.iter().copied()),
        dependency_count: info.dependency_count,
        p_dependencies: copies.many(dependencies.iter().copied()),
        correlated_view_mask_count: masks.len() as u32,
        p_correlated_view_masks: masks.as_ptr(),
        ..Default::default()
    })
}

fn attachment(of: &vk::AttachmentDescription) -> vk::AttachmentDescription2<'static> {
    vk::AttachmentDescription2::default()
        .flags(of.flags)
        .format(of.format)
        .samples(of.samples)
        .load_op(of.load_op)
        .store_op(of.store_op)
        .stencil_load_op(of.stencil_load_op)
        .stencil_store_op(of.stencil_store_op)
        .initial_layout(of.initial_layout)
        .final_layout(of.final_layout)
}

/// Structures in the chain of the first version.
struct Extensions<'c> {
    view_masks: &'c [u32],
    view_offsets: &'c [i32],
    correlation_masks: &'c [u32],
    aspects: &'c [vk::InputAttachmentAspectReference],
}

impl<'c> Extensions<'c> {
    /// # Safety
    ///
    /// The structure and its chain are valid.
    unsafe fn of(info: &vk::RenderPassCreateInfo<'c>) -> Result<Self, LeftAlone> {
        type Multiview<'a> = vk::RenderPassMultiviewCreateInfo<'a>;
        type Aspects<'a> = vk::RenderPassInputAttachmentAspectCreateInfo<'a>;
        let mut at: *const vk::BaseInStructure<'_> = info.p_next.cast();
        // SAFETY: null, or the next structure of a valid chain, as `# Safety` demands.
        while let Some(structure) = unsafe { at.as_ref() } {
            if ![Multiview::STRUCTURE_TYPE, Aspects::STRUCTURE_TYPE].contains(&structure.s_type) {
                return Err(LeftAlone::Unknown(structure.s_type));
            }
            at = structure.p_next;
        }
        let mut extensions =
            Self { view_masks: &[], view_offsets: &[], correlation_masks: &[], aspects: &[] };
        // SAFETY: the chain is valid, as `# Safety` demands, with so many elements in each array.
        unsafe {
            if let Some(multiview) = find::<Multiview<'_>>(info.p_next) {
                extensions.view_masks = slice(multiview.p_view_masks, multiview.subpass_count);
                extensions.view_offsets = slice(multiview.p_view_offsets, multiview.dependency_count);
                extensions.correlation_masks =
                    slice(multiview.p_correlation_masks, multiview.correlation_mask_count);
            }
            if let Some(aspects) = find::<Aspects<'_>>(info.p_next) {
                extensions.aspects = slice(aspects.p_aspect_references, aspects.aspect_reference_count);
            }
        }
        Ok(extensions)
    }

    /// # Safety
    ///
    /// The subpass is valid.
    unsafe fn subpass(
        &self,
        index: u32,
        of: &vk::SubpassDescription<'c>,
        attachments: &[vk::AttachmentDescription],
        copies: &mut Copies<'_>,
    ) -> vk::SubpassDescription2<'c> {
        let other = |from: &vk::AttachmentReference| reference(from, vk::ImageAspectFlags::empty());
        // SAFETY: a valid subpass has so many references, of resolves as many as of colours or null, and of depth one or null.
        let (inputs, colours, resolves, depth) = unsafe {
            (
                slice(of.p_input_attachments, of.input_attachment_count),
                slice(of.p_color_attachments, of.color_attachment_count),
                slice(of.p_resolve_attachments, of.color_attachment_count),
                of.p_depth_stencil_attachment.as_ref(),
            )
        };
        let inputs: Vec<_> = (0u32..)
            .zip(inputs)
            .map(|(input, from)| reference(from, self.aspect(index, input, from, attachments)))
            .collect();
        vk::SubpassDescription2 {
            flags: of.flags,
            pipeline_bind_point: of.pipeline_bind_point,
            view_mask: self.view_masks.get(index as usize).copied().unwrap_or(0),
            input_attachment_count: of.input_attachment_count,
            p_input_attachments: copies.many(inputs.iter().copied()),
            color_attachment_count: of.color_attachment_count,
            p_color_attachments: copies.many(colours.iter().map(other)),
            p_resolve_attachments: if resolves.is_empty() {
                std::ptr::null()
            } else {
                copies.many(resolves.iter().map(other)).cast_const()
            },
            p_depth_stencil_attachment: depth
                .map_or(std::ptr::null(), |depth| copies.one(other(depth)).cast_const()),
            preserve_attachment_count: of.preserve_attachment_count,
            p_preserve_attachments: of.p_preserve_attachments,
            ..Default::default()
        }
    }

    /// Aspects of an input attachment: from the chain, or else all of its format (`VkRenderPassInputAttachmentAspectCreateInfo`).
    fn aspect(
        &self,
        subpass: u32,
        input: u32,
        from: &vk::AttachmentReference,
        attachments: &[vk::AttachmentDescription],
    ) -> vk::ImageAspectFlags {
        let said =
            self.aspects.iter().find(|said| said.subpass == subpass && said.input_attachment_index == input);
        let format = attachments.get(from.attachment as usize).map(|attachment| attachment.format);
        said.map(|said| said.aspect_mask).or(format.map(aspects_of)).unwrap_or(vk::ImageAspectFlags::empty())
    }

    fn dependency(&self, index: usize, of: &vk::SubpassDependency) -> vk::SubpassDependency2<'static> {
        vk::SubpassDependency2::default()
            .src_subpass(of.src_subpass)
            .dst_subpass(of.dst_subpass)
            .src_stage_mask(of.src_stage_mask)
            .dst_stage_mask(of.dst_stage_mask)
            .src_access_mask(of.src_access_mask)
            .dst_access_mask(of.dst_access_mask)
            .dependency_flags(of.dependency_flags)
            .view_offset(self.view_offsets.get(index).copied().unwrap_or(0))
    }
}

fn reference(
    of: &vk::AttachmentReference,
    aspect: vk::ImageAspectFlags,
) -> vk::AttachmentReference2<'static> {
    vk::AttachmentReference2::default().attachment(of.attachment).layout(of.layout).aspect_mask(aspect)
}

/// All aspects of a format.
fn aspects_of(format: vk::Format) -> vk::ImageAspectFlags {
    use vk::{Format, ImageAspectFlags as Aspects};
    match format {
        Format::D16_UNORM | Format::X8_D24_UNORM_PACK32 | Format::D32_SFLOAT => Aspects::DEPTH,
        Format::S8_UINT => Aspects::STENCIL,
        Format::D16_UNORM_S8_UINT | Format::D24_UNORM_S8_UINT | Format::D32_SFLOAT_S8_UINT => {
            Aspects::DEPTH | Aspects::STENCIL
        }
        _ => Aspects::COLOR,
    }
}

#[cfg(test)]
mod tests;
