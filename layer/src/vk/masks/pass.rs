//! One pass with a mask, from its begin to its end.

use super::attachments::DepthAttachment;
use super::{Attachments, Masks, Pending, TargetMask, follow_graphics};
use crate::gpu::{AppCommands, GpuError, ImagePart};
use crate::mask::{DepthWork, Eligible, MaskFacts, MaskMap, Reason, Way, way};
use crate::scene::{ImageKey, Pass, PassFacts, Target};
use crate::vk::armed::Armed;
use crate::vk::backend::RateMap as _;
use crate::vk::candidates::Candidate;
use crate::vk::objects::Objects;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// A pass that is being recorded with a mask.
pub struct OpenMask {
    map: Arc<MaskMap>,
    way: OpenWay,
    /// Whether nothing is filled after it, because nothing is coarse.
    is_unfilled: bool,
    /// What is filled after it, with its format and layout then.
    fills: SmallVec<[(ImagePart, vk::Format, vk::ImageLayout); 4]>,
    /// The same of several samples, depth among it.
    pending: SmallVec<[Pending; 2]>,
}

/// How fragments are kept from being shaded in it.
enum OpenWay {
    Template(OpenDepth),
    Return(Return),
}

/// What fragment shaders of a pass return early by.
#[derive(Debug, Clone, Copy)]
pub struct Return {
    /// The set that they read.
    pub set: vk::DescriptorSet,
    /// Whether only those do that cover the same samples, with the same depth.
    pub keeps_coverage: bool,
    /// Why there is no template.
    instead: Reason,
}

/// Depth of a pass with a template.
struct OpenDepth {
    /// Its depth, as the template takes it.
    depth: ImagePart,
    /// Whether an earlier pass of the command buffer had the template, which still holds.
    is_covered: bool,
    /// Whether it has several samples.
    is_multisampled: bool,
    layouts: [vk::ImageLayout; 2],
    /// What else is done with that, in this area, and the layout in which it is after the pass.
    work: DepthWork,
    area: vk::Rect2D,
    final_layout: vk::ImageLayout,
}

impl OpenMask {
    /// Why it has no template, if it has none.
    fn instead(&self) -> Option<Reason> {
        self.returns().map(|by| by.instead)
    }

    /// The mask of a template.
    pub fn template(&self) -> Option<&Arc<MaskMap>> {
        match self.way {
            OpenWay::Template(_) => Some(&self.map),
            OpenWay::Return(_) => None,
        }
    }

    /// What of several samples is filled after it.
    pub fn pending(&self) -> &[Pending] {
        &self.pending
    }

    /// What fragment shaders return early by, if they do.
    pub fn returns(&self) -> Option<Return> {
        match self.way {
            OpenWay::Return(by) => Some(by),
            OpenWay::Template(_) => None,
        }
    }
}

/// What else a pass's mask depends on.
#[derive(Debug, Clone, Copy)]
struct How {
    /// Whether anything is coarse, or only left out.
    coarsens: bool,
    /// Whether it draws to several layers that are no views.
    is_layered: bool,
}

/// What holds where a pass begins.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    /// The command buffer is a primary one.
    pub is_primary: bool,
    /// What is bound for compute can be bound again.
    pub restores_compute: bool,
    /// What is bound for drawing is followed, and can be bound again.
    pub restores_graphics: bool,
    /// Whether it is followed.
    pub follows_graphics: bool,
    /// Whether conditional rendering is active: it would decide on our commands, too.
    pub is_conditional: bool,
    /// The pass's own render area.
    pub area: vk::Rect2D,
    /// The mask of an earlier pass of the command buffer whose template depth of several samples still holds.
    pub covered_by: Option<&'a Arc<MaskMap>>,
    /// How many passes of the command buffer cleared that depth for others to go on with.
    pub prepasses: u32,
}

impl Masks {
    /// Notes what a pass does that matters to others.
    fn note(&self, attachments: &Attachments) {
        if let Some(depth) = attachments.depth.filter(|depth| depth.is_cleared)
            && self.cleared.get(depth.target.image) != Some(depth.clear)
        {
            self.cleared.insert(depth.target.image, depth.clear);
        }
        if let Some(depth) = attachments.depth.filter(|depth| depth.is_loaded)
            && self.loaded.get(depth.target.image).is_none()
        {
            self.loaded.insert(depth.target.image, ());
        }
    }

    /// The mask of a pass that begins.
    ///
    /// # Errors
    ///
    /// Why it has none.
    fn open(
        &self,
        armed: &Armed,
        candidate: &Candidate,
        pass: &Pass,
        attachments: &Attachments,
        place: Place<'_>,
    ) -> Result<OpenMask, Reason> {
        if !armed.frame.is_on() {
            return Err(Reason::Off);
        }
        let target = candidate.map.mask().ok_or(Reason::New)?;
        if attachments.colors.is_empty() {
            return self.judged(armed, target, pass, attachments, place);
        }
        if let Some(depth) = attachments.loaded_samples(&armed.objects)
            && place.covered_by.is_none()
        {
            let key = (depth.target.image, place.prepasses);
            let known = self.chains.get(key);
            if known != Some(candidate.target) {
                // In later frames the pass that clears it has a template for this one.
                self.chains.insert(key, candidate.target);
            }
            if known.is_none() {
                return Err(Reason::New);
            }
        }
        let outcome = match self.judged(armed, target, pass, attachments, place) {
            Err(Reason::DepthLoaded) => Err(target.prepass_refusal().unwrap_or(Reason::DepthLoaded)),
            outcome => outcome,
        };
        target.tell(outcome.as_ref().map(OpenMask::instead).map_err(|reason| *reason));
        outcome
    }

    /// The mask of a pass, by what earlier ones to its target have shown.
    fn judged(
        &self,
        armed: &Armed,
        target: &TargetMask,
        pass: &Pass,
        attachments: &Attachments,
        place: Place<'_>,
    ) -> Result<OpenMask, Reason> {
        let (facts, pipelines) = target.evidence(attachments.colors.is_empty())?;
        let is_layered = pass.view_mask == 0 && target.layers() > 1;
        let pass = PassFacts {
            is_queried: pass.facts.is_queried || facts.is_queried,
            clears_depth_later: pass.facts.clears_depth_later || facts.clears_depth_later,
            ..pass.facts
        };
        let how = How { coarsens: armed.frame.coarsens(), is_layered };
        // Measured with llvmpipe of Mesa 26.2.6 (tests/baselines/engines.md).
        let prefers_return = self.is_cpu && pipelines.returns.keeping_coverage && !target.fails_to_return();
        if prefers_return && attachments.colors.is_empty() {
            // Passes that go on with its depth find it as it is.
            return Err(Reason::ShadesHidden);
        }
        self.opened(&armed.objects, (target, how), attachments, place, |colors| MaskFacts {
            pass,
            depth: attachments.depth_facts(self, &armed.objects, place.covered_by.is_some()),
            colors,
            pipelines,
            prefers_return,
        })
    }

    fn opened(
        &self,
        objects: &Objects,
        (target, how): (&TargetMask, How),
        attachments: &Attachments,
        place: Place<'_>,
        facts: impl for<'a> FnOnce(&'a [crate::mask::ColorFacts]) -> MaskFacts<'a>,
    ) -> Result<OpenMask, Reason> {
        if !place.is_primary {
            return Err(Reason::Secondary);
        }
        if !place.restores_compute {
            return Err(Reason::ComputeState);
        }
        let colors = attachments.color_facts(objects)?;
        let (map, way) = match way(&facts(&colors))? {
            Way::Template(eligible) => self.template(objects, target, attachments, place, eligible)?,
            // Of several layers that are no views, the shader does not know which it draws to.
            Way::Return { instead, .. } if how.is_layered => return Err(instead),
            Way::Return { keeps_coverage, instead } => {
                self.early_return(target, place, keeps_coverage, instead)?
            }
        };
        let layers = target.layers();
        // Copying all of a picture there and back costs more than many a pass.
        let is_unfilled = target.leaves_out() && !how.coarsens;
        let failed = |error: GpuError| {
            error.tell("no mask for a render pass");
            Reason::Failed
        };
        let (mut fills, mut pending) = (SmallVec::new(), SmallVec::new());
        for (color, facts) in attachments.colors.iter().zip(&colors).filter(|(color, _)| color.is_stored) {
            let part = part(objects, color.target, vk::ImageAspectFlags::COLOR, layers)?;
            if facts.samples == vk::SampleCountFlags::TYPE_1 {
                map.prepare(color.format).map_err(failed)?;
            }
            if is_unfilled {
                continue;
            }
            match facts.samples {
                vk::SampleCountFlags::TYPE_1 => fills.push((part, color.format, color.layout)),
                _ => pending.push(self.pending(
                    objects,
                    (&map, target),
                    (color.target, part),
                    place,
                    color.layout,
                )?),
            }
        }
        if let OpenWay::Template(depth) = &way
            && let Some(attachment) = attachments.depth
            && depth.is_multisampled
            && depth.work.fills
        {
            let of = (attachment.target, depth.depth);
            pending.push(self.pending(objects, (&map, target), of, place, depth.final_layout)?);
        }
        Ok(OpenMask { map, way, is_unfilled, fills, pending })
    }

    /// The fill, after a pass, of an image of several samples.
    fn pending(
        &self,
        objects: &Objects,
        (map, target): (&Arc<MaskMap>, &TargetMask),
        (of, part): (Target, ImagePart),
        place: Place<'_>,
        layout: vk::ImageLayout,
    ) -> Result<Pending, Reason> {
        if !place.follows_graphics {
            // From the next command buffers on.
            follow_graphics();
            return Err(Reason::New);
        }
        if !place.restores_graphics || target.loses_graphics() || self.extends_dynamic.load(Ordering::Relaxed)
        {
            return Err(Reason::GraphicsState);
        }
        let image = objects.image_of(of.image).ok_or(Reason::Unknown)?.description;
        let [width, height] = map.extent();
        if of.level != 0 || image.extent[0] < width || image.extent[1] < height {
            return Err(Reason::Area);
        }
        let samples = vk::SampleCountFlags::from_raw(image.samples);
        let fill = map.prepare_samples(of, part, (image.format, samples)).map_err(|error| {
            error.tell("no mask for a render pass");
            Reason::Failed
        })?;
        Ok(Pending { map: Arc::clone(map), target: of, part, format: image.format, layout, fill })
    }

    /// The map of a pass with an early return.
    fn early_return(
        &self,
        target: &TargetMask,
        place: Place<'_>,
        keeps_coverage: bool,
        instead: Reason,
    ) -> Result<(Arc<MaskMap>, OpenWay), Reason> {
        if place.is_conditional {
            return Err(instead);
        }
        // Behind a pass with a template, a pass without depth mostly maps tones or scales: it costs little, and reads a filled picture.
        if instead == Reason::NoDepth && self.has_template.load(Ordering::Relaxed) {
            return Err(instead);
        }
        if !place.follows_graphics {
            // From the next command buffers on.
            follow_graphics();
            return Err(Reason::New);
        }
        if !place.restores_graphics {
            return Err(Reason::GraphicsState);
        }
        // What temporal filters keep they read again: what is filled would go on from frame to frame.
        if instead == Reason::NoDepth && target.is_history() {
            return Err(Reason::History);
        }
        if instead == Reason::ShadesHidden {
            // Where no shader can, there is a template, of another kind.
            target.returns_early(keeps_coverage, Reason::New)?;
            self.has_template.store(true, Ordering::Relaxed);
        }
        let map = target.map_to_return(instead)?;
        target.returns_early(keeps_coverage, instead)?;
        let set = self.return_layout().and_then(|layout| map.return_set(&layout)).ok_or(Reason::Failed)?;
        Ok((map, OpenWay::Return(Return { set, keeps_coverage, instead })))
    }

    /// The map of a pass with a template, and what is done with its depth.
    fn template(
        &self,
        objects: &Objects,
        target: &TargetMask,
        attachments: &Attachments,
        place: Place<'_>,
        eligible: Eligible,
    ) -> Result<(Arc<MaskMap>, OpenWay), Reason> {
        let depth = attachments.depth.ok_or(Reason::NoDepth)?;
        if depth.layouts[1] == vk::ImageLayout::UNDEFINED {
            return Err(Reason::Layouts);
        }
        if is_separate(objects, &depth) {
            return Err(Reason::Layouts);
        }
        let map = target.map(eligible)?;
        let is_multisampled = eligible.drawn.is_some();
        if place
            .covered_by
            .is_some_and(|by| is_multisampled && eligible.work.covers && !Arc::ptr_eq(by, &map))
        {
            return Err(Reason::DepthLoaded);
        }
        if eligible.work.is_any() && !is_multisampled && !map.prepare_depth() {
            return Err(Reason::Failed);
        }
        // A map that leaves tiles out has to be laid anew first.
        if !map.is_ready() || (eligible.work.is_any() && !target.note_depth()) {
            return Err(Reason::Undrawn);
        }
        if !map.takes(place.area) {
            return Err(Reason::Area);
        }
        let aspects = aspects(objects, depth.target)?;
        let open = OpenDepth {
            depth: part(objects, depth.target, aspects, target.layers())?,
            is_covered: is_multisampled && eligible.work.covers,
            is_multisampled,
            layouts: depth.layouts,
            work: eligible.work,
            area: place.area,
            final_layout: depth.final_layout,
        };
        self.has_template.store(true, Ordering::Relaxed);
        Ok((map, OpenWay::Template(open)))
    }

    /// Records what comes ahead of a pass that may have a mask, and returns that with what `loading` makes the pass begin
    /// with, which is nothing where it begins as the application says; nothing where it has no mask, for the reason that `pass` then
    /// says. `settle` is called before, with the mask if it has a template: what waits in what it draws to is filled, or goes on waiting.
    ///
    /// # Safety
    ///
    /// `commands` is recording, outside of a render pass, on this thread; what the pass draws to is live until it has run.
    #[allow(clippy::too_many_arguments, reason = "what is known of a pass comes from four sides")]
    pub unsafe fn begin_pass<T>(
        &self,
        armed: &Armed,
        commands: vk::CommandBuffer,
        candidate: Option<&Candidate>,
        pass: &mut Pass,
        attachments: &Attachments,
        place: Place<'_>,
        (loading, settle): (impl FnOnce(DepthWork) -> Result<T, Reason>, impl FnOnce(Option<&Arc<MaskMap>>)),
    ) -> Option<(OpenMask, Option<T>)> {
        self.note(attachments);
        let open = candidate
            .ok_or(Reason::New)
            .and_then(|candidate| self.open(armed, candidate, pass, attachments, place))
            .and_then(|open| {
                let loading = match &open.way {
                    OpenWay::Template(depth) => Some(loading(depth.work)?),
                    OpenWay::Return(_) => None,
                };
                Ok((open, loading))
            });
        let open = open.and_then(|(open, loading)| Ok((self.gpu().ok_or(Reason::Failed)?, open, loading)));
        if attachments.colors.is_empty()
            && let Some(target) = candidate.and_then(|candidate| candidate.map.mask())
        {
            target.note_prepass(open.as_ref().map(drop).map_err(|reason| *reason));
        }
        settle(open.as_ref().ok().and_then(|(_, open, _)| open.template()));
        match open {
            Ok((gpu, open, loading)) => {
                // SAFETY: the caller vouches for the command buffer; the map is kept by the candidate, which the command
                // buffer keeps.
                let commands = unsafe { AppCommands::new(gpu, commands) };
                pass.facts.is_unfilled = open.is_unfilled;
                match &open.way {
                    OpenWay::Template(depth) if depth.is_covered => {}
                    OpenWay::Template(depth) if depth.work.covers => {
                        open.map.cover(&commands, depth.depth, place.area, depth.layouts[0]);
                    }
                    OpenWay::Template(depth) => {
                        open.map.begin(&commands, depth.depth, place.area, depth.layouts);
                    }
                    OpenWay::Return(_) => {}
                }
                Some((open, loading))
            }
            Err(reason) => {
                pass.unmasked = Some(reason);
                None
            }
        }
    }

    /// Records what comes after a pass, which changes what is bound for compute.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin_pass`].
    pub unsafe fn end_pass(&self, open: &OpenMask, commands: vk::CommandBuffer) {
        let Some(gpu) = self.gpu() else { return };
        // SAFETY: as above.
        let commands = unsafe { AppCommands::new(gpu, commands) };
        for &(part, format, layout) in &open.fills {
            open.map.end(&commands, part, format, layout);
        }
        if let OpenWay::Template(depth) = &open.way
            && depth.work.fills
            && !depth.is_multisampled
        {
            open.map.fill_depth(&commands, depth.depth, depth.area, depth.final_layout);
        }
    }

    /// The colour of the passes that are to go on with the depth of a pre-pass, if earlier frames have shown one: by the depth that it clears, and
    /// how many passes of the command buffer cleared that before, this one counted.
    pub fn chained(&self, depth: ImageKey, prepasses: u32) -> Option<Target> {
        self.chains.get((depth, prepasses))
    }

    /// The begin of a render pass that loads depth.
    ///
    /// # Errors
    ///
    /// There is no render pass for that.
    pub fn loading_begin<'a>(
        &self,
        info: &vk::RenderPassBeginInfo<'a>,
    ) -> Result<vk::RenderPassBeginInfo<'a>, Reason> {
        let render_pass = self.loading(info.render_pass).ok_or(Reason::RenderPass)?;
        Ok(vk::RenderPassBeginInfo { render_pass, ..*info })
    }
}

/// Whether a layout is of depth alone, beside which stencil has one that barriers here do not name.
fn is_separate(objects: &Objects, depth: &DepthAttachment) -> bool {
    let is_alone = |layout: &vk::ImageLayout| {
        matches!(
            *layout,
            vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL | vk::ImageLayout::DEPTH_READ_ONLY_OPTIMAL
        )
    };
    let has_stencil =
        aspects(objects, depth.target).is_ok_and(|aspects| aspects.contains(vk::ImageAspectFlags::STENCIL));
    has_stencil && (depth.layouts.iter().any(is_alone) || is_alone(&depth.final_layout))
}

/// A target as barriers and copies name it, as far as the mask has layers.
fn part(
    objects: &Objects,
    target: Target,
    aspects: vk::ImageAspectFlags,
    layers: u32,
) -> Result<ImagePart, Reason> {
    let image = objects.image_of(target.image).ok_or(Reason::Unknown)?;
    if target.layers < layers {
        return Err(Reason::Unknown);
    }
    Ok(ImagePart {
        image: image.handle,
        aspects,
        level: target.level,
        first_layer: target.base_layer,
        layers,
    })
}

/// All aspects of a depth image: barriers without separate layouts name both.
fn aspects(objects: &Objects, target: Target) -> Result<vk::ImageAspectFlags, Reason> {
    let format = objects.image_of(target.image).ok_or(Reason::Unknown)?.description.format;
    let depth = vk::ImageAspectFlags::DEPTH;
    Ok(match format {
        vk::Format::D16_UNORM_S8_UINT | vk::Format::D24_UNORM_S8_UINT | vk::Format::D32_SFLOAT_S8_UINT => {
            depth | vk::ImageAspectFlags::STENCIL
        }
        _ => depth,
    })
}
