//! The decision on the mask of a pass that begins, by evidence of earlier frames.

use super::open_mask::{OpenDepth, OpenEarlyReturn, OpenMask, OpenMethod};
use super::parts::{aspects, part};
use super::{Attachments, Masks, Pending, TargetMask, follow_graphics};
use crate::backend::RateMap as _;
use crate::backend::mask::{Eligible, MaskFacts, MaskMap, MaskMethod, method};
use crate::gpu::{GpuError, ImagePart};
use crate::kernels::samples::SampleKind;
use crate::pass_detection::{Pass, PassFacts, Target, Unmasked};
use crate::vk::frame::Frame;
use crate::vk::objects::Objects;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Further conditions of a pass's mask.
#[derive(Debug, Clone, Copy)]
struct How {
    /// Whether anything is coarse, or only left out.
    coarsens: bool,
    /// Whether it draws to several layers that are not views.
    is_layered: bool,
}

/// The state where a pass begins.
#[derive(Clone, Copy)]
pub struct PassContext<'a> {
    /// The frame under way.
    pub frame: &'a Frame,
    /// The application's objects.
    pub objects: &'a Objects,
    /// The command buffer is a primary one.
    pub is_primary: bool,
    /// The bound compute state can be bound again.
    pub restores_compute: bool,
    /// The bound graphics state is followed, and can be bound again.
    pub restores_graphics: bool,
    /// Whether descriptors in buffers are in use.
    pub has_offsets: bool,
    /// Whether it is followed.
    pub follows_graphics: bool,
    /// Whether conditional rendering is active: it would decide on our commands, too.
    pub is_conditional: bool,
    /// Whether commands of the pass may be recorded inline, not in secondary command buffers alone.
    pub is_inline: bool,
    /// The pass's own render area.
    pub area: vk::Rect2D,
    /// The mask of an earlier pass of the command buffer whose template depth of several samples still holds.
    pub covered_by: Option<&'a Arc<MaskMap>>,
    /// Number of the command buffer's passes that cleared that depth for others to go on with.
    pub prepasses: u32,
    /// Whether a query that counts samples goes on around the pass.
    pub is_queried: bool,
}

impl Masks {
    /// The mask of a pass that begins.
    ///
    /// # Errors
    ///
    /// Reason why it has none.
    pub(super) fn open(
        &self,
        (color, target): (Target, Option<&TargetMask>),
        pass: &Pass,
        attachments: &Attachments,
        context: PassContext<'_>,
    ) -> Result<OpenMask, Unmasked> {
        if !context.frame.is_on() {
            return Err(Unmasked::Off);
        }
        let target = target.ok_or(Unmasked::New)?;
        if attachments.colors.is_empty() {
            return self.decided(target, pass, attachments, context);
        }
        if let Some(depth) = attachments.loaded_samples(context.objects)
            && context.covered_by.is_none()
        {
            let key = (depth.target.image, context.prepasses);
            let known = self.chains.get(key);
            if known != Some(color) {
                // In later frames the pass that clears it has a template for this one.
                self.chains.insert(key, color);
            }
            if known.is_none() {
                return Err(Unmasked::New);
            }
        }
        let outcome = match self.decided(target, pass, attachments, context) {
            Err(Unmasked::DepthLoaded) => Err(target.prepass_refusal().unwrap_or(Unmasked::DepthLoaded)),
            outcome => outcome,
        };
        target.log_outcome(outcome.as_ref().map(OpenMask::instead).map_err(|reason| *reason));
        outcome
    }

    /// The mask of a pass, by evidence of earlier passes to its target.
    fn decided(
        &self,
        target: &TargetMask,
        pass: &Pass,
        attachments: &Attachments,
        context: PassContext<'_>,
    ) -> Result<OpenMask, Unmasked> {
        let (facts, pipelines) =
            target.evidence(attachments.colors.is_empty(), attachments.depth.is_some())?;
        let is_layered = pass.view_mask == 0 && target.layers() > 1;
        let pass = PassFacts {
            is_queried: pass.facts.is_queried || facts.is_queried,
            clears_depth_later: pass.facts.clears_depth_later || facts.clears_depth_later,
            ..pass.facts
        };
        context.frame.awaited.finish();
        let how = How { coarsens: context.frame.coarsens(), is_layered };
        // Measured with llvmpipe of Mesa 26.2.6 (tests/baselines/engines.md).
        let prefers_return = self.is_cpu && pipelines.returns.keeping_coverage && !target.fails_to_return();
        if prefers_return && attachments.colors.is_empty() {
            // Passes that go on with its depth find it as it is.
            return Err(Unmasked::ShadesHidden);
        }
        self.opened((target, how), attachments, context, |colors| MaskFacts {
            pass,
            depth: attachments.depth_facts(self, context.objects, context.covered_by.is_some()),
            colors,
            pipelines,
            prefers_return,
        })
    }

    fn opened(
        &self,
        (target, how): (&TargetMask, How),
        attachments: &Attachments,
        context: PassContext<'_>,
        facts: impl for<'a> FnOnce(&'a [crate::backend::mask::ColorFacts]) -> MaskFacts<'a>,
    ) -> Result<OpenMask, Unmasked> {
        if !context.is_primary {
            return Err(Unmasked::Secondary);
        }
        if context.has_offsets && !context.follows_graphics {
            // Sets that are bound for drawing beside them are followed from the next command buffers on.
            return Err(Unmasked::New);
        }
        if !context.restores_compute {
            return Err(Unmasked::ComputeState);
        }
        let colors = attachments.color_facts(context.objects, |image| self.loaded.get(image).is_some())?;
        let (map, method) = match method(&facts(&colors))? {
            MaskMethod::Template(eligible) => self.template(target, attachments, context, eligible)?,
            // Of several layers that are not views, the shader does not know which it draws to.
            MaskMethod::Return { instead, .. } if how.is_layered => return Err(instead),
            MaskMethod::Return { keeps_coverage, instead } => {
                self.early_return(target, context, keeps_coverage, instead)?
            }
        };
        let layers = target.layers();
        // Copying all of a picture there and back costs more than many a pass.
        let is_unfilled = target.skips_stale_tiles() && !how.coarsens;
        let failed = |error: GpuError| {
            error.log("no mask for a render pass");
            Unmasked::Failed
        };
        let (mut fills, mut pending) = (SmallVec::new(), SmallVec::new());
        for (color, facts) in attachments.colors.iter().zip(&colors).filter(|(_, facts)| facts.is_stored) {
            let size = (map.extent(), layers);
            let part = part(context.objects, color.target, vk::ImageAspectFlags::COLOR, size)?;
            if facts.samples == vk::SampleCountFlags::TYPE_1 {
                map.prepare(color.format).map_err(failed)?;
            }
            if is_unfilled {
                continue;
            }
            match facts.samples {
                vk::SampleCountFlags::TYPE_1 => fills.push((part, color.format, color.layout)),
                _ => {
                    pending.push(self.pending((&map, target), (color.target, part), context, color.layout)?)
                }
            }
        }
        if let OpenMethod::Template(depth) = &method
            && let Some(attachment) = attachments.depth
            && depth.is_multisampled
            && depth.work.fills
        {
            let of = (attachment.target, depth.depth);
            pending.push(self.pending((&map, target), of, context, depth.final_layout)?);
        }
        Ok(OpenMask { map, method, is_unfilled, fills, pending })
    }

    /// The fill, after a pass, of an image of several samples.
    fn pending(
        &self,
        (map, target): (&Arc<MaskMap>, &TargetMask),
        (of, part): (Target, ImagePart),
        context: PassContext<'_>,
        layout: vk::ImageLayout,
    ) -> Result<Pending, Unmasked> {
        if context.is_queried {
            // It would count the samples of the fill, which is drawn.
            return Err(Unmasked::Queried);
        }
        if !context.follows_graphics {
            // From the next command buffers on.
            follow_graphics();
            return Err(Unmasked::New);
        }
        if !context.restores_graphics
            || target.loses_graphics()
            || self.extends_dynamic.load(Ordering::Relaxed)
        {
            return Err(Unmasked::GraphicsState);
        }
        let image = context.objects.image_of(of.image).ok_or(Unmasked::Unknown)?.description;
        if of.level != 0 {
            return Err(Unmasked::Area);
        }
        let kind = SampleKind {
            format: image.format,
            samples: vk::SampleCountFlags::from_raw(image.samples),
            is_color: part.aspects == vk::ImageAspectFlags::COLOR,
        };
        let kernel = self.sample_kernel(kind)?;
        self.filled.insert(of.image, ());
        let fill = map.prepare_samples(of, part, (&kernel, image.format)).map_err(|error| {
            error.log("no mask for a render pass");
            Unmasked::Failed
        })?;
        Ok(Pending { map: Arc::clone(map), target: of, part, format: image.format, layout, fill })
    }

    /// The map of a pass with an early return.
    fn early_return(
        &self,
        target: &TargetMask,
        context: PassContext<'_>,
        keeps_coverage: bool,
        instead: Unmasked,
    ) -> Result<(Arc<MaskMap>, OpenMethod), Unmasked> {
        // Nothing of ours can be bound in a pass of secondary command buffers.
        if context.is_conditional || !context.is_inline {
            return Err(instead);
        }
        // Behind a pass with a template, a pass without depth mostly maps tones or scales: it costs little, and reads a filled picture.
        if instead == Unmasked::NoDepth && self.has_template.load(Ordering::Relaxed) {
            return Err(instead);
        }
        if !context.follows_graphics {
            // From the next command buffers on.
            follow_graphics();
            return Err(Unmasked::New);
        }
        // A set of ours behind others would end offsets.
        if !context.restores_graphics || context.has_offsets {
            return Err(Unmasked::GraphicsState);
        }
        // Temporal filters read their history again: filled pixels would carry over from frame to frame.
        if instead == Unmasked::NoDepth && target.is_history() {
            return Err(Unmasked::History);
        }
        if instead == Unmasked::ShadesHidden {
            // Where no shader can, there is a template, of another kind.
            target.returns_early(keeps_coverage, Unmasked::New)?;
            self.has_template.store(true, Ordering::Relaxed);
        }
        let map = target.map_to_return(instead)?;
        target.returns_early(keeps_coverage, instead)?;
        let set = self.return_layout().and_then(|layout| map.return_set(&layout)).ok_or(Unmasked::Failed)?;
        Ok((map, OpenMethod::Return(OpenEarlyReturn { set, keeps_coverage, instead })))
    }

    /// The map of a pass with a template, and the work on its depth.
    fn template(
        &self,
        target: &TargetMask,
        attachments: &Attachments,
        context: PassContext<'_>,
        eligible: Eligible,
    ) -> Result<(Arc<MaskMap>, OpenMethod), Unmasked> {
        let depth = attachments.depth.ok_or(Unmasked::NoDepth)?;
        let map = target.map(eligible)?;
        let is_multisampled = eligible.drawn.is_some();
        if context
            .covered_by
            .is_some_and(|by| is_multisampled && eligible.work.covers && !Arc::ptr_eq(by, &map))
        {
            return Err(Unmasked::DepthLoaded);
        }
        if eligible.work.is_any() && !is_multisampled && !map.prepare_depth() {
            return Err(Unmasked::Failed);
        }
        // A map that leaves tiles out must be resolved again first.
        if !map.is_ready() || (eligible.work.is_any() && !target.note_depth()) {
            return Err(Unmasked::Undrawn);
        }
        if !map.takes(context.area) {
            return Err(Unmasked::Area);
        }
        let aspects = aspects(context.objects, depth.target)?;
        let open = OpenDepth {
            depth: part(context.objects, depth.target, aspects, (map.extent(), target.layers()))?,
            is_covered: is_multisampled && eligible.work.covers,
            is_multisampled,
            layouts: depth.layouts,
            work: eligible.work,
            area: context.area,
            final_layout: depth.final_layout,
        };
        self.has_template.store(true, Ordering::Relaxed);
        Ok((map, OpenMethod::Template(open)))
    }
}
