//! Descriptions of render passes, from either kind of their creation.

use super::{Attachment, RenderPass, Subpass};
use crate::pass_detection::PassFacts;
use crate::vk::chain::extension;
use ash::vk;
use smallvec::SmallVec;
use std::slice;

impl RenderPass {
    /// # Safety
    ///
    /// Valid usage of vkCreateRenderPass.
    pub unsafe fn of_version_1(info: &vk::RenderPassCreateInfo<'_>) -> Self {
        // SAFETY: the caller vouches for the structure and its chain; arrays have the lengths beside them.
        unsafe {
            let multiview = extension::<vk::RenderPassMultiviewCreateInfo<'_>>(info.p_next);
            let masks = multiview.map_or(&[][..], |found| array(found.p_view_masks, found.subpass_count));
            let has_density_map =
                extension::<vk::RenderPassFragmentDensityMapCreateInfoEXT<'_>>(info.p_next).is_some();
            let references = |first, count| indices(array::<vk::AttachmentReference>(first, count));
            let subpasses = array(info.p_subpasses, info.subpass_count).iter().enumerate().map(
                |(index, subpass): (usize, &vk::SubpassDescription<'_>)| Subpass {
                    colors: references(subpass.p_color_attachments, subpass.color_attachment_count),
                    resolves: references(subpass.p_resolve_attachments, subpass.color_attachment_count),
                    depth: subpass.p_depth_stencil_attachment.as_ref().and_then(AttachmentIndex::with_layout),
                    inputs: references(subpass.p_input_attachments, subpass.input_attachment_count),
                    view_mask: masks.get(index).copied().unwrap_or(0),
                    has_own_rates: has_density_map,
                    resolves_depth: false,
                },
            );
            let attachments = array(info.p_attachments, info.attachment_count).iter();
            Self::new(
                attachments
                    .map(|found: &vk::AttachmentDescription| Attachment {
                        format: found.format,
                        samples: found.samples,
                        load: found.load_op,
                        store: found.store_op,
                        stencil_load: found.stencil_load_op,
                        stencil_store: found.stencil_store_op,
                        initial_layout: found.initial_layout,
                        final_layout: found.final_layout,
                    })
                    .collect(),
                subpasses.collect(),
            )
        }
    }

    /// # Safety
    ///
    /// Valid usage of vkCreateRenderPass2.
    pub unsafe fn of_version_2(info: &vk::RenderPassCreateInfo2<'_>) -> Self {
        // SAFETY: the caller vouches for the structure and its chain; arrays have the lengths beside them.
        unsafe {
            let has_density_map =
                extension::<vk::RenderPassFragmentDensityMapCreateInfoEXT<'_>>(info.p_next).is_some();
            let references = |first, count| indices(array::<vk::AttachmentReference2<'_>>(first, count));
            let subpasses = array(info.p_subpasses, info.subpass_count).iter().map(
                |subpass: &vk::SubpassDescription2<'_>| Subpass {
                    colors: references(subpass.p_color_attachments, subpass.color_attachment_count),
                    resolves: references(subpass.p_resolve_attachments, subpass.color_attachment_count),
                    depth: subpass.p_depth_stencil_attachment.as_ref().and_then(AttachmentIndex::with_layout),
                    inputs: references(subpass.p_input_attachments, subpass.input_attachment_count),
                    view_mask: subpass.view_mask,
                    has_own_rates: has_density_map || has_rates(subpass),
                    resolves_depth: resolves_depth(subpass),
                },
            );
            let attachments = array(info.p_attachments, info.attachment_count).iter();
            Self::new(
                attachments
                    .map(|found: &vk::AttachmentDescription2<'_>| Attachment {
                        format: found.format,
                        samples: found.samples,
                        load: found.load_op,
                        store: found.store_op,
                        stencil_load: found.stencil_load_op,
                        stencil_store: found.stencil_store_op,
                        initial_layout: found.initial_layout,
                        final_layout: found.final_layout,
                    })
                    .collect(),
                subpasses.collect(),
            )
        }
    }

    fn new(attachments: Vec<Attachment>, subpasses: Vec<Subpass>) -> Self {
        let depth = subpasses.iter().find_map(|subpass| subpass.depth).map(|(index, _)| index);
        let described = depth.and_then(|index| attachments.get(index as usize));
        let facts = PassFacts {
            clears_depth: described.is_some_and(|depth| depth.load == vk::AttachmentLoadOp::CLEAR),
            stores_depth: described.is_some_and(|depth| depth.store != vk::AttachmentStoreOp::DONT_CARE),
            loads_stencil: described.is_some_and(|depth| {
                has_stencil(depth.format) && depth.stencil_load == vk::AttachmentLoadOp::LOAD
            }),
            has_own_rates: subpasses.iter().any(|subpass| subpass.has_own_rates),
            resolves_depth: subpasses.iter().any(|subpass| subpass.resolves_depth),
            ..PassFacts::default()
        };
        Self {
            colors: each_once(subpasses.iter().flat_map(|subpass| &subpass.colors)),
            resolves: each_once(subpasses.iter().flat_map(|subpass| &subpass.resolves)),
            depth,
            view_mask: subpasses.iter().fold(0, |mask, subpass| mask | subpass.view_mask),
            facts,
            attachments,
            subpasses,
        }
    }
}

/// Whether a format has stencil beside depth, or alone.
pub fn has_stencil(format: vk::Format) -> bool {
    matches!(
        format,
        vk::Format::S8_UINT
            | vk::Format::D16_UNORM_S8_UINT
            | vk::Format::D24_UNORM_S8_UINT
            | vk::Format::D32_SFLOAT_S8_UINT
    )
}

/// # Safety
///
/// A valid subpass.
unsafe fn has_rates(subpass: &vk::SubpassDescription2<'_>) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands; the reference is null or valid.
    unsafe {
        extension::<vk::FragmentShadingRateAttachmentInfoKHR<'_>>(subpass.p_next)
            .and_then(|rates| rates.p_fragment_shading_rate_attachment.as_ref())
            .is_some_and(|reference| reference.attachment != vk::ATTACHMENT_UNUSED)
    }
}

/// # Safety
///
/// A valid subpass.
unsafe fn resolves_depth(subpass: &vk::SubpassDescription2<'_>) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands; the reference is null or valid.
    unsafe {
        extension::<vk::SubpassDescriptionDepthStencilResolve<'_>>(subpass.p_next)
            .and_then(|resolve| resolve.p_depth_stencil_resolve_attachment.as_ref())
            .is_some_and(|reference| reference.attachment != vk::ATTACHMENT_UNUSED)
    }
}

fn each_once<const N: usize>(
    indices: impl Iterator<Item = impl std::borrow::Borrow<Option<u32>>>,
) -> SmallVec<[u32; N]>
where
    [u32; N]: smallvec::Array<Item = u32>,
{
    let mut found = SmallVec::new();
    for index in indices.filter_map(|index| *index.borrow()) {
        if !found.contains(&index) {
            found.push(index);
        }
    }
    found
}

/// A reference to an attachment, of either version.
trait AttachmentIndex {
    /// The attachment; `None` where it is unused.
    fn index(&self) -> Option<u32>;
    /// The attachment with its layout.
    fn with_layout(&self) -> Option<(u32, vk::ImageLayout)>;
}

impl AttachmentIndex for vk::AttachmentReference {
    fn index(&self) -> Option<u32> {
        (self.attachment != vk::ATTACHMENT_UNUSED).then_some(self.attachment)
    }

    fn with_layout(&self) -> Option<(u32, vk::ImageLayout)> {
        Some((self.index()?, self.layout))
    }
}

impl AttachmentIndex for vk::AttachmentReference2<'_> {
    fn index(&self) -> Option<u32> {
        (self.attachment != vk::ATTACHMENT_UNUSED).then_some(self.attachment)
    }

    fn with_layout(&self) -> Option<(u32, vk::ImageLayout)> {
        Some((self.index()?, self.layout))
    }
}

fn indices<R: AttachmentIndex>(references: &[R]) -> SmallVec<[Option<u32>; 4]> {
    references.iter().map(AttachmentIndex::index).collect()
}

/// An array of a creation; empty where there is none.
///
/// # Safety
///
/// `first` is null, or `count` values are there for `'a`.
unsafe fn array<'a, T>(first: *const T, count: u32) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: the values are there, as `# Safety` demands.
    unsafe { slice::from_raw_parts(first, count as usize) }
}
