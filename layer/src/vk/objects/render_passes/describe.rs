//! Descriptions of render passes, from either kind of their creation.

use super::{Attachment, RenderPass, Subpass};
use crate::abi::copies::slice;
use crate::pass_detection::PassFacts;
use crate::vk::chain::extension;
use ash::vk;
use smallvec::SmallVec;
use std::ffi::c_void;

impl RenderPass {
    /// # Safety
    ///
    /// Valid usage of vkCreateRenderPass.
    pub unsafe fn of_version_1(info: &vk::RenderPassCreateInfo<'_>) -> Self {
        // SAFETY: valid usage demands a valid chain.
        let multiview = unsafe { extension::<vk::RenderPassMultiviewCreateInfo<'_>>(info.p_next) };
        // SAFETY: valid usage demands so many masks, attachments and subpasses.
        let (masks, attachments, subpasses) = unsafe {
            (
                multiview.map_or(&[][..], |found| slice(found.p_view_masks, found.subpass_count)),
                slice(info.p_attachments, info.attachment_count),
                slice(info.p_subpasses, info.subpass_count),
            )
        };
        // SAFETY: as above.
        let has_own_rates = unsafe { has_density_map(info.p_next) };
        let attachments = attachments.iter().map(|found| Attachment {
            format: found.format,
            samples: found.samples,
            load: found.load_op,
            store: found.store_op,
            stencil_load: found.stencil_load_op,
            stencil_store: found.stencil_store_op,
            initial_layout: found.initial_layout,
            final_layout: found.final_layout,
        });
        let subpasses = subpasses.iter().enumerate().map(|(index, found)| {
            let colors = [found.p_color_attachments, found.p_resolve_attachments];
            let inputs = (found.p_input_attachments, found.input_attachment_count);
            // SAFETY: valid usage demands so many references, or null for the references of resolves and depth.
            let described = unsafe {
                described((colors, found.color_attachment_count), found.p_depth_stencil_attachment, inputs)
            };
            Subpass { view_mask: masks.get(index).copied().unwrap_or(0), has_own_rates, ..described }
        });
        Self::new(attachments.collect(), subpasses.collect())
    }

    /// # Safety
    ///
    /// Valid usage of vkCreateRenderPass2.
    pub unsafe fn of_version_2(info: &vk::RenderPassCreateInfo2<'_>) -> Self {
        // SAFETY: valid usage demands so many attachments and subpasses.
        let (attachments, subpasses) = unsafe {
            (slice(info.p_attachments, info.attachment_count), slice(info.p_subpasses, info.subpass_count))
        };
        // SAFETY: valid usage demands a valid chain.
        let has_density_map = unsafe { has_density_map(info.p_next) };
        let attachments = attachments.iter().map(|found| Attachment {
            format: found.format,
            samples: found.samples,
            load: found.load_op,
            store: found.store_op,
            stencil_load: found.stencil_load_op,
            stencil_store: found.stencil_store_op,
            initial_layout: found.initial_layout,
            final_layout: found.final_layout,
        });
        let subpasses = subpasses.iter().map(|found| {
            let colors = [found.p_color_attachments, found.p_resolve_attachments];
            let inputs = (found.p_input_attachments, found.input_attachment_count);
            // SAFETY: valid usage demands so many references, or null for the references of resolves and depth.
            let described = unsafe {
                described((colors, found.color_attachment_count), found.p_depth_stencil_attachment, inputs)
            };
            // SAFETY: valid usage demands valid subpasses.
            let (has_rates, resolves_depth) = unsafe { (has_rates(found), resolves_depth(found)) };
            let has_own_rates = has_density_map || has_rates;
            Subpass { view_mask: found.view_mask, has_own_rates, resolves_depth, ..described }
        });
        Self::new(attachments.collect(), subpasses.collect())
    }

    fn new(attachments: Vec<Attachment>, subpasses: Vec<Subpass>) -> Self {
        let depth = subpasses.iter().find_map(|subpass| subpass.depth).map(|(index, _)| index);
        let described = depth.and_then(|index| attachments.get(index as usize));
        let first = subpasses.iter().find_map(|subpass| subpass.colors.first().copied().flatten());
        let first = first.and_then(|index| attachments.get(index as usize));
        let facts = PassFacts {
            loads_color: first.is_some_and(|color| color.load == vk::AttachmentLoadOp::LOAD),
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
    /// The attachment; `None` if it is unused.
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

/// A subpass of these references: colours and their resolves, and inputs, with their counts, and depth. The rest is as without extensions.
///
/// # Safety
///
/// Each pointer is null, or to as many references as its count; `depth` is null or to one.
unsafe fn described<R: AttachmentIndex>(
    (colors, color_count): ([*const R; 2], u32),
    depth: *const R,
    (inputs, input_count): (*const R, u32),
) -> Subpass {
    let indices = |references: &[R]| references.iter().map(AttachmentIndex::index).collect();
    // SAFETY: so many references are there, as `# Safety` demands.
    let ([colors, resolves], inputs) =
        unsafe { (colors.map(|first| slice(first, color_count)), slice(inputs, input_count)) };
    Subpass {
        colors: indices(colors),
        resolves: indices(resolves),
        // SAFETY: the pointer is null or valid, as `# Safety` demands.
        depth: unsafe { depth.as_ref() }.and_then(AttachmentIndex::with_layout),
        inputs: indices(inputs),
        view_mask: 0,
        has_own_rates: false,
        resolves_depth: false,
    }
}

/// Whether the creation of a render pass has a fragment density map.
///
/// # Safety
///
/// The chain is valid.
unsafe fn has_density_map(p_next: *const c_void) -> bool {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe { extension::<vk::RenderPassFragmentDensityMapCreateInfoEXT<'_>>(p_next) }.is_some()
}
