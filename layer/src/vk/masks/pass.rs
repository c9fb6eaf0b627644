//! One pass with a mask, from its begin to its end.

use super::attachments::DepthAttachment;
use super::{Attachments, Masks};
use crate::gpu::{AppCommands, ImagePart};
use crate::mask::{DepthWork, MaskFacts, MaskMap, Reason, eligible};
use crate::scene::{Pass, PassFacts, Target};
use crate::vk::armed::Armed;
use crate::vk::backend::RateMap as _;
use crate::vk::candidates::Candidate;
use crate::vk::objects::Objects;
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// A pass that is being recorded with a mask.
pub struct OpenMask {
    map: Arc<MaskMap>,
    /// Its depth, as the template takes it.
    depth: ImagePart,
    layouts: [vk::ImageLayout; 2],
    /// What else is done with that, in this area, and the layout in which it is after the pass.
    work: DepthWork,
    area: vk::Rect2D,
    final_layout: vk::ImageLayout,
    /// Whether nothing is filled after it, because nothing is coarse.
    is_unfilled: bool,
    /// What is filled after it, with its format and layout then.
    fills: SmallVec<[(ImagePart, vk::Format, vk::ImageLayout); 4]>,
}

/// What holds where a pass begins.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// The command buffer is a primary one.
    pub is_primary: bool,
    /// What is bound for compute can be bound again.
    pub restores_compute: bool,
    /// The pass's own render area.
    pub area: vk::Rect2D,
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
        place: Place,
    ) -> Result<OpenMask, Reason> {
        if !armed.frame.is_on() {
            return Err(Reason::Off);
        }
        let target = candidate.map.mask().ok_or(Reason::New)?;
        let (facts, pipelines) = target.evidence()?;
        let pass = PassFacts {
            is_queried: pass.facts.is_queried || facts.is_queried,
            clears_depth_later: pass.facts.clears_depth_later || facts.clears_depth_later,
            ..pass.facts
        };
        let coarsens = armed.frame.coarsens();
        let outcome = self.opened(&armed.objects, (target, coarsens), attachments, place, |colors| {
            MaskFacts { pass, depth: attachments.depth_facts(self, &armed.objects), colors, pipelines }
        });
        target.tell(outcome.as_ref().map(|_| ()).map_err(|reason| *reason));
        outcome
    }

    fn opened(
        &self,
        objects: &Objects,
        (target, coarsens): (&super::TargetMask, bool),
        attachments: &Attachments,
        place: Place,
        facts: impl for<'a> FnOnce(&'a [crate::mask::ColorFacts]) -> MaskFacts<'a>,
    ) -> Result<OpenMask, Reason> {
        if !place.is_primary {
            return Err(Reason::Secondary);
        }
        if !place.restores_compute {
            return Err(Reason::ComputeState);
        }
        let colors = attachments.color_facts(objects)?;
        let eligible = eligible(&facts(&colors))?;
        let depth = attachments.depth.ok_or(Reason::NoDepth)?;
        if depth.layouts[1] == vk::ImageLayout::UNDEFINED {
            return Err(Reason::Layouts);
        }
        if is_separate(objects, &depth) {
            return Err(Reason::Layouts);
        }
        let map = target.map(eligible)?;
        if eligible.work.is_any() && !map.prepare_depth() {
            return Err(Reason::Failed);
        }
        // A map that leaves tiles out has to be laid anew first.
        if !map.is_ready() || (eligible.work.is_any() && !target.note_depth()) {
            return Err(Reason::Undrawn);
        }
        if !map.takes(place.area) {
            return Err(Reason::Area);
        }
        let layers = target.layers();
        // Copying all of a picture there and back costs more than many a pass.
        let is_unfilled = target.leaves_out() && !coarsens;
        let mut fills = SmallVec::new();
        for color in attachments.colors.iter().filter(|color| color.is_stored) {
            map.prepare(color.format).map_err(|error| {
                error.tell("no mask for a render pass");
                Reason::Failed
            })?;
            let part = part(objects, color.target, vk::ImageAspectFlags::COLOR, layers)?;
            if !is_unfilled {
                fills.push((part, color.format, color.layout));
            }
        }
        let aspects = aspects(objects, depth.target)?;
        let depth_part = part(objects, depth.target, aspects, layers)?;
        Ok(OpenMask {
            map,
            depth: depth_part,
            layouts: depth.layouts,
            work: eligible.work,
            area: place.area,
            final_layout: depth.final_layout,
            is_unfilled,
            fills,
        })
    }

    /// Records what comes ahead of a pass that may have a mask, and returns that with what `loading` makes the pass begin
    /// with; nothing where it has none, for the reason that `pass` then says.
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
        place: Place,
        loading: impl FnOnce(DepthWork) -> Result<T, Reason>,
    ) -> Option<(OpenMask, T)> {
        self.note(attachments);
        let open = candidate
            .ok_or(Reason::New)
            .and_then(|candidate| self.open(armed, candidate, pass, attachments, place))
            .and_then(|open| {
                let loading = loading(open.work)?;
                Ok((open, loading))
            });
        let open = open.and_then(|(open, loading)| Ok((self.gpu().ok_or(Reason::Failed)?, open, loading)));
        match open {
            Ok((gpu, open, loading)) => {
                // SAFETY: the caller vouches for the command buffer; the map is kept by the candidate, which the command
                // buffer keeps.
                let commands = unsafe { AppCommands::new(gpu, commands) };
                pass.facts.is_unfilled = open.is_unfilled;
                if open.work.covers {
                    open.map.cover(&commands, open.depth, place.area, open.layouts[0]);
                } else {
                    open.map.begin(&commands, open.depth, place.area, open.layouts);
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
        if open.work.fills {
            open.map.fill_depth(&commands, open.depth, open.area, open.final_layout);
        }
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
