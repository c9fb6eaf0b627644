//! The attachments of a pass, as far as its mask needs to know them.

use super::Masks;
use super::parts::is_separate;
use crate::abi::copies::slice;
use crate::backend::mask::{ColorFacts, DepthFacts};
use crate::pass_detection::{ImageKey, Target, Unmasked};
use crate::vk::objects::{Objects, RenderPass};
use ash::vk;
use smallvec::SmallVec;

/// The attachments of a pass that begins.
#[derive(Debug, Default)]
pub struct Attachments {
    /// Depth, if there is any.
    pub depth: Option<DepthAttachment>,
    /// Colours that are drawn to or resolved to, each once.
    pub colors: SmallVec<[ColorAttachment; 8]>,
    /// Images of the other attachments: input attachments alone, and attachments without a use, whose layout may change.
    pub others: SmallVec<[ImageKey; 4]>,
}

/// Depth of a pass that begins.
#[derive(Debug, Clone, Copy)]
pub struct DepthAttachment {
    /// The attached image.
    pub target: Target,
    /// Its clear value, if it is cleared.
    pub clear: f32,
    /// Whether it is cleared, or loaded.
    pub is_cleared: bool,
    pub is_loaded: bool,
    /// Whether the pass can begin with depth that is loaded.
    pub is_loadable: bool,
    /// Whether stencil is stored.
    pub stores_stencil: bool,
    /// Whether a subpass reads it.
    pub is_input: bool,
    /// The layout in which the application's pass expects it, and the one in which its first subpass has it; equal ones of
    /// dynamic rendering. UNDEFINED as the second: stencil is in another layout.
    pub layouts: [vk::ImageLayout; 2],
    /// The layout in which it is after the pass.
    pub final_layout: vk::ImageLayout,
}

/// Colour of a pass that begins.
#[derive(Debug, Clone, Copy)]
pub struct ColorAttachment {
    /// The attached image.
    pub target: Target,
    /// The format in which it is drawn to.
    pub format: vk::Format,
    /// Whether it is loaded.
    pub is_loaded: bool,
    /// Whether it is stored.
    pub is_stored: bool,
    /// The layout in which it is after the pass.
    pub layout: vk::ImageLayout,
}

impl Attachments {
    /// Of an instance of a render pass with these attachments and clear values; `is_loadable` if there is a render pass that loads depth where
    /// it clears it.
    pub fn of_render_pass(
        pass: &RenderPass,
        targets: &[Option<Target>],
        clears: &[vk::ClearValue],
        is_loadable: bool,
    ) -> Self {
        let at = |index: u32| {
            let index = index as usize;
            Some((targets.get(index).copied().flatten()?, pass.attachments.get(index)?))
        };
        let colors = pass.colors.iter().chain(&pass.resolves).filter_map(|&index| {
            let (target, attachment) = at(index)?;
            Some(ColorAttachment {
                target,
                format: attachment.format,
                is_loaded: attachment.load == vk::AttachmentLoadOp::LOAD,
                is_stored: keeps_drawn(attachment.store),
                layout: attachment.final_layout,
            })
        });
        let depth = pass.depth.and_then(|index| {
            let (target, attachment) = at(index)?;
            let within = pass.subpasses.iter().find_map(|subpass| subpass.depth)?.1;
            Some(DepthAttachment {
                target,
                // SAFETY: every bit pattern is a number, also where it is a colour.
                clear: clears
                    .get(index as usize)
                    .map_or(f32::NAN, |value| unsafe { value.depth_stencil.depth }),
                is_cleared: attachment.load == vk::AttachmentLoadOp::CLEAR,
                is_loaded: attachment.load == vk::AttachmentLoadOp::LOAD,
                is_loadable: attachment.load == vk::AttachmentLoadOp::LOAD || is_loadable,
                stores_stencil: attachment.stores_stencil(),
                is_input: pass.subpasses.iter().any(|subpass| subpass.inputs.contains(&Some(index))),
                layouts: [attachment.initial_layout, within],
                final_layout: attachment.final_layout,
            })
        });
        let is_drawn = |index: &u32| {
            pass.colors.contains(index) || pass.resolves.contains(index) || pass.depth == Some(*index)
        };
        let others = (0..targets.len() as u32).filter(|index| !is_drawn(index)).filter_map(at);
        Self { depth, colors: colors.collect(), others: others.map(|(target, _)| target.image).collect() }
    }

    /// Whether the pass draws or resolves to an image.
    pub fn have(&self, image: ImageKey) -> bool {
        let targets =
            self.depth.iter().map(|depth| depth.target).chain(self.colors.iter().map(|color| color.target));
        targets.into_iter().any(|target| target.image == image)
    }

    /// Whether it is a pass that does nothing but clear, draw and store depth of several samples, for others to go on with.
    pub fn are_a_prepass(&self, objects: &Objects) -> Option<DepthAttachment> {
        let depth = self.depth.filter(|depth| depth.is_cleared && self.colors.is_empty())?;
        let image = objects.image_of(depth.target.image)?;
        (image.description.samples > 1).then_some(depth)
    }

    /// Depth of several samples that a pass goes on with.
    pub fn loaded_samples(&self, objects: &Objects) -> Option<DepthAttachment> {
        let depth = self.depth.filter(|depth| depth.is_loaded)?;
        let image = objects.image_of(depth.target.image)?;
        (image.description.samples > 1).then_some(depth)
    }

    /// Facts about depth, where it is of a live image.
    pub fn depth_facts(&self, masks: &Masks, objects: &Objects, is_covered: bool) -> Option<DepthFacts> {
        let depth = self.depth.as_ref()?;
        let image = objects.image_of(depth.target.image)?;
        let usage =
            if depth.is_input { vk::ImageUsageFlags::INPUT_ATTACHMENT } else { vk::ImageUsageFlags::empty() };
        Some(DepthFacts {
            format: image.description.format,
            samples: vk::SampleCountFlags::from_raw(image.description.samples),
            usage: image.usage | usage,
            clear: match depth.is_cleared {
                true => depth.clear,
                false => masks.cleared.get(depth.target.image).unwrap_or(f32::NAN),
            },
            is_loaded: depth.is_loaded,
            is_loadable: depth.is_loadable,
            is_covered,
            is_read_within: depth.is_input || !is_written(depth.layouts[1]),
            stores_stencil: depth.stores_stencil,
            is_loaded_later: masks.loaded.get(depth.target.image).is_some(),
            is_submitted: image.description.swapchain.is_some(),
            is_separate: is_separate(image.description.format, depth),
            is_writable: image.granted.contains(vk::ImageUsageFlags::TRANSFER_DST),
            is_readable: image.granted.contains(vk::ImageUsageFlags::TRANSFER_SRC),
        })
    }

    /// Facts about the colours, in their order; a colour `is_loaded_later` if a pass was seen to load its image.
    ///
    /// # Errors
    ///
    /// One of them is of no live image.
    pub fn color_facts(
        &self,
        objects: &Objects,
        is_loaded_later: impl Fn(ImageKey) -> bool,
    ) -> Result<SmallVec<[ColorFacts; 8]>, Unmasked> {
        let facts = self.colors.iter().map(|color| {
            let image = objects.image_of(color.target.image).ok_or(Unmasked::Unknown)?;
            Ok(ColorFacts {
                format: color.format,
                samples: vk::SampleCountFlags::from_raw(image.description.samples),
                is_stored: color.is_stored
                    && (may_be_read(image.usage) || is_loaded_later(color.target.image)),
                is_fillable: image.granted.contains(match image.description.samples {
                    1 => crate::kernels::fill::USAGE,
                    _ => crate::kernels::samples::USAGE,
                }),
            })
        });
        facts.collect()
    }
}

/// Whether anything but an attachment that loads it may read an image (Vulkan specification, `VkImageUsageFlagBits`).
fn may_be_read(usage: vk::ImageUsageFlags) -> bool {
    use vk::ImageUsageFlags as Usage;
    !usage.contains(Usage::TRANSIENT_ATTACHMENT) || usage.contains(Usage::INPUT_ATTACHMENT)
}

/// Whether colour that a pass draws is there after it: NONE leaves it undefined, too (Vulkan specification, `VkAttachmentStoreOp`).
fn keeps_drawn(store: vk::AttachmentStoreOp) -> bool {
    store == vk::AttachmentStoreOp::STORE
}

/// Whether depth in this layout can be an attachment and nothing else (Vulkan specification, "Image Layouts").
pub(super) fn is_written(layout: vk::ImageLayout) -> bool {
    use vk::ImageLayout as Layout;
    matches!(
        layout,
        Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL
            | Layout::DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL
            | Layout::DEPTH_ATTACHMENT_OPTIMAL
            | Layout::ATTACHMENT_OPTIMAL
    )
}

/// The attachments of dynamic rendering.
///
/// # Safety
///
/// Valid usage of vkCmdBeginRendering.
pub unsafe fn rendering_attachments(objects: &Objects, info: &vk::RenderingInfo<'_>) -> Attachments {
    // SAFETY: valid usage demands so many colours, and that depth and stencil are null or valid.
    let (colors, depth, stencil) = unsafe {
        let colors = slice(info.p_color_attachments, info.color_attachment_count);
        (colors, info.p_depth_attachment.as_ref(), info.p_stencil_attachment.as_ref())
    };
    let one = |view: vk::ImageView, layout, [is_loaded, is_stored]: [bool; 2]| {
        let known = objects.view(view)?;
        let mut target = known.target;
        if info.view_mask == 0 {
            target.layers = target.layers.min(info.layer_count);
        }
        Some(ColorAttachment { target, format: known.format, is_loaded, is_stored, layout })
    };
    let drawn = colors.iter().filter_map(|found| {
        let is_loaded = found.load_op == vk::AttachmentLoadOp::LOAD;
        one(found.image_view, found.image_layout, [is_loaded, keeps_drawn(found.store_op)])
    });
    let resolved = colors.iter().filter(|found| found.resolve_mode != vk::ResolveModeFlags::NONE);
    let resolved =
        resolved.filter_map(|found| one(found.resolve_image_view, found.resolve_image_layout, [false, true]));
    let stencil = stencil.filter(|found| found.image_view != vk::ImageView::null());
    let depth = depth.and_then(|found| {
        let target = one(found.image_view, found.image_layout, [false; 2])?.target;
        let is_one = stencil.is_none_or(|stencil| stencil.image_layout == found.image_layout);
        let within = if is_one { found.image_layout } else { vk::ImageLayout::UNDEFINED };
        Some(DepthAttachment {
            target,
            // SAFETY: the clear value of depth is one of depth; all bits are a number.
            clear: unsafe { found.clear_value.depth_stencil.depth },
            is_cleared: found.load_op == vk::AttachmentLoadOp::CLEAR,
            is_loaded: found.load_op == vk::AttachmentLoadOp::LOAD,
            is_loadable: true,
            stores_stencil: stencil.is_some_and(|found| found.store_op == vk::AttachmentStoreOp::STORE),
            is_input: false,
            layouts: [found.image_layout, within],
            final_layout: found.image_layout,
        })
    });
    Attachments { depth, colors: drawn.chain(resolved).collect(), others: SmallVec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::PassFacts;
    use crate::vk::objects::Image;
    use crate::vk::objects::render_passes::Attachment;
    use ash::vk::Handle;
    use smallvec::smallvec;

    /// Samples that are resolved, with this store.
    fn attachment(store: vk::AttachmentStoreOp) -> Attachment {
        Attachment {
            format: vk::Format::R8G8B8A8_SRGB,
            samples: vk::SampleCountFlags::TYPE_4,
            load: vk::AttachmentLoadOp::CLEAR,
            store,
            stencil_load: vk::AttachmentLoadOp::DONT_CARE,
            stencil_store: vk::AttachmentStoreOp::DONT_CARE,
            initial_layout: vk::ImageLayout::UNDEFINED,
            final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }
    }

    #[test]
    fn only_colour_that_is_there_after_a_pass_is_stored() {
        use vk::AttachmentStoreOp as Store;
        let pass = RenderPass {
            attachments: [Store::STORE, Store::DONT_CARE, Store::NONE].map(attachment).to_vec(),
            subpasses: vec![],
            colors: smallvec![0, 1, 2],
            resolves: smallvec![],
            depth: None,
            view_mask: 0,
            facts: PassFacts::default(),
        };
        let target = |image| Some(Target { image: ImageKey(image), level: 0, base_layer: 0, layers: 1 });
        let attachments = Attachments::of_render_pass(&pass, &[1, 2, 3].map(target), &[], false);
        let stored: Vec<_> = attachments.colors.iter().map(|color| color.is_stored).collect();
        assert_eq!(stored, [true, false, false]);
    }

    /// A pass of deferred lighting reads the samples of an earlier pass.
    #[test]
    fn input_attachments_alone_are_among_the_others() {
        let pass = RenderPass {
            attachments: [vk::AttachmentStoreOp::STORE; 4].map(attachment).to_vec(),
            subpasses: vec![],
            colors: smallvec![1],
            resolves: smallvec![3],
            depth: None,
            view_mask: 0,
            facts: PassFacts::default(),
        };
        let target = |image| Some(Target { image: ImageKey(image), level: 0, base_layer: 0, layers: 1 });
        let attachments = Attachments::of_render_pass(&pass, &[5, 6, 7, 8].map(target), &[], false);
        assert_eq!(attachments.others.as_slice(), [5, 7].map(ImageKey));
        assert_eq!([5, 6, 7, 8].map(|image| attachments.have(ImageKey(image))), [false, true, false, true]);
    }

    #[test]
    fn transient_colour_is_stored_for_passes_that_load_it_and_shaders_that_read_it() {
        use vk::ImageUsageFlags as Usage;
        let transient = Usage::COLOR_ATTACHMENT | Usage::TRANSIENT_ATTACHMENT;
        let is_stored = |usage: Usage, is_loaded_later: bool| {
            let objects = Objects::default();
            let info = vk::ImageCreateInfo::default().usage(usage).samples(vk::SampleCountFlags::TYPE_4);
            let image = Image::created(vk::Image::from_raw(1), &info, usage);
            objects.add_image(image);
            let color = ColorAttachment {
                target: Target { image: image.description.key, level: 0, base_layer: 0, layers: 1 },
                format: vk::Format::R8G8B8A8_SRGB,
                is_loaded: false,
                is_stored: true,
                layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            };
            let attachments = Attachments { colors: smallvec![color], ..Attachments::default() };
            attachments.color_facts(&objects, |_| is_loaded_later).unwrap()[0].is_stored
        };
        assert!(!is_stored(transient, false));
        assert!(is_stored(transient, true));
        assert!(is_stored(transient | Usage::INPUT_ATTACHMENT, false));
        assert!(is_stored(Usage::COLOR_ATTACHMENT, false));
    }
}
