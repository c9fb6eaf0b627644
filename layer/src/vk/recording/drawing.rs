//! Bound graphics state and its substitutes: in a pass whose fragment shaders return early, a pipeline of ours for each of the application's,
//! and a set behind the sets of its layout.
//!
//! That set is bound again whenever the application binds sets, as that may disturb it. It may itself disturb sets of higher numbers, or of
//! another layout, so the application's sets are bound again before another layout counts, and after the pass. Both pipelines have the same
//! state, dynamic or not, and the same push constants.

use super::Buffer;
use super::rects::Rects;
use super::sets::BoundSets;
use crate::backend::mask::EarlyReturnPipeline;
use crate::vk::functions::ArmedTable;
use ash::vk;
use std::sync::Arc;

const GRAPHICS: vk::PipelineBindPoint = vk::PipelineBindPoint::GRAPHICS;

/// The bound graphics state.
#[derive(Default)]
pub struct Drawing {
    /// Whether it is followed since recording began.
    is_followed: bool,
    /// The application's pipeline.
    pipeline: vk::Pipeline,
    sets: BoundSets,
    /// Its viewports and scissors, from number 0 on, as far as they were set.
    pub rects: Rects,
    /// The substitute of the pipeline.
    in_place: Option<InPlace>,
}

#[derive(Clone)]
struct InPlace {
    returning: Arc<EarlyReturnPipeline>,
    set: vk::DescriptorSet,
}

impl Drawing {
    /// Recording begins.
    pub fn begin(&mut self, is_followed: bool) {
        self.is_followed = is_followed;
    }

    /// Forgets the bound state, as secondary command buffers leave none; the memory stays.
    pub fn forget(&mut self) {
        self.pipeline = vk::Pipeline::null();
        self.sets.clear();
        self.rects.clear();
        self.in_place = None;
    }

    /// Whether it is followed.
    pub fn is_followed(&self) -> bool {
        self.is_followed
    }

    /// Whether all of it can be bound again.
    pub fn is_complete(&self) -> bool {
        self.sets.is_complete()
    }

    /// Something is bound that is not kept.
    pub fn bind_more(&mut self) {
        if self.is_followed {
            self.sets.bind_more();
        }
    }

    /// Sets are bound from number `first` on.
    pub fn bind_sets(
        &mut self,
        layout: vk::PipelineLayout,
        first: u32,
        sets: &[vk::DescriptorSet],
        offsets: &[u32],
    ) {
        if self.is_followed {
            self.sets.bind(layout, first, sets, offsets);
        }
    }
}

/// The bound graphics state outside of passes.
pub struct Bound {
    pipeline: vk::Pipeline,
    sets: BoundSets,
    rects: Rects,
}

impl Drawing {
    /// The state that may have to be bound again after a pipeline of ours, which draws with one viewport and one scissor.
    pub fn bound(&self) -> Bound {
        Bound { pipeline: self.pipeline, sets: self.sets.clone(), rects: self.rects.clone() }
    }
}

impl Bound {
    /// Binds it again, with the next layer's functions: state that is not dynamic in a pipeline counts from its binding on.
    ///
    /// # Safety
    ///
    /// `commands` is recording, outside of a render pass, and this was its bound state.
    pub unsafe fn restore(&self, next: &ArmedTable, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is recording, as `# Safety` demands; the bound objects stay valid as long as it does.
        unsafe {
            self.rects.restore(next, commands);
            if let Some(bind) = next.cmd_bind_pipeline
                && self.pipeline != vk::Pipeline::null()
            {
                bind(commands, GRAPHICS, self.pipeline);
            }
            self.sets.restore(next, commands, GRAPHICS);
        }
    }
}

/// The application binds a pipeline: `bind` binds it, or its substitute.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording; the pipeline may be bound.
pub unsafe fn bind(
    buffer: &Buffer,
    handle: vk::CommandBuffer,
    pipeline: vk::Pipeline,
    bind: impl Fn(vk::Pipeline),
) {
    let (was, returns) = {
        let mut recorded = buffer.recorded();
        let returns = recorded.mask.as_ref().and_then(super::OpenMask::returns);
        let drawing = &mut recorded.drawing;
        if !drawing.is_followed {
            drop(recorded);
            return bind(pipeline);
        }
        drawing.pipeline = pipeline;
        let was = drawing.in_place.take();
        // Where something cannot be bound again, nothing must take its place.
        let is_complete = drawing.is_complete();
        (was, returns.filter(|_| is_complete && recorded.offsets.is_empty()))
    };
    if returns.is_none() {
        prepare(buffer, pipeline);
    }
    let masks = buffer.armed.masks.as_ref();
    let in_place = returns.zip(masks).and_then(|(by, masks)| {
        let returning = masks.returning(pipeline, by.keeps_coverage)?;
        Some(InPlace { returning, set: by.set })
    });
    let layout = |place: &InPlace| place.returning.layout().handle();
    let steps = steps(was.as_ref().map(layout), in_place.as_ref().map(layout));
    if steps.binds_own {
        bind(pipeline);
    }
    if steps.restores_sets {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe { restore_sets(buffer, handle) };
    }
    if let Some(place) = in_place {
        bind(place.returning.pipeline().unwrap_or(pipeline));
        // SAFETY: as above.
        unsafe { place.bind_set(buffer, handle) };
        buffer.recorded().drawing.in_place = Some(place);
    }
}

/// The steps before a pipeline's substitute is bound, if it has one.
#[derive(Debug, PartialEq, Eq)]
struct Steps {
    /// The application's pipeline is bound.
    binds_own: bool,
    /// Its sets are bound again, which ours may have disturbed.
    restores_sets: bool,
}

/// From something in place with one layout, or nothing, to another.
fn steps(was: Option<vk::PipelineLayout>, is: Option<vk::PipelineLayout>) -> Steps {
    let restores_sets = was.is_some() && was != is;
    Steps { binds_own: is.is_none(), restores_sets }
}

/// Has the substitute of a pipeline made for later frames, where a pass waits for it.
fn prepare(buffer: &Buffer, pipeline: vk::Pipeline) {
    let target = buffer.recorded().target.clone();
    let target = target.as_ref().and_then(|candidate| candidate.mask());
    let Some((target, masks)) = target.zip(buffer.armed.masks.as_ref()) else { return };
    for keeps_coverage in [false, true] {
        if target.waits_for_return(keeps_coverage)
            && let Some(is_there) = masks.prepare_return(pipeline, keeps_coverage)
        {
            target.prepared_return(keeps_coverage, is_there);
        }
    }
}

impl InPlace {
    /// # Safety
    ///
    /// As for [`bind`].
    unsafe fn bind_set(&self, buffer: &Buffer, handle: vk::CommandBuffer) {
        let Some(bind) = buffer.armed.next.cmd_bind_descriptor_sets else { return };
        let layout = self.returning.layout();
        // SAFETY: the command buffer is recording, as `# Safety` demands; set and layout belong together, and the map and the pipeline,
        // whose they are, live as long as it.
        unsafe {
            bind(handle, GRAPHICS, layout.handle(), layout.set(), 1, &self.set, 0, std::ptr::null());
        }
    }
}

/// # Safety
///
/// As for [`bind`].
unsafe fn restore_sets(buffer: &Buffer, handle: vk::CommandBuffer) {
    let sets = buffer.recorded().drawing.sets.clone();
    // SAFETY: the command buffer is recording, as `# Safety` demands.
    unsafe { sets.restore(&buffer.armed.next, handle, GRAPHICS) };
}

/// The application has bound sets: ours is bound behind them again, if it is.
///
/// # Safety
///
/// As for [`bind`].
pub unsafe fn bind_ours_again(buffer: &Buffer, handle: vk::CommandBuffer) {
    let in_place = buffer.recorded().drawing.in_place.clone();
    if let Some(place) = in_place {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe { place.bind_set(buffer, handle) };
    }
}

/// A pass begins, with or without shaders that return early: the bound pipeline may get a substitute.
///
/// # Safety
///
/// As for [`bind`], and the pass was begun.
pub unsafe fn pass_begins(buffer: &Buffer, handle: vk::CommandBuffer) {
    let (returns, pipeline) = {
        let recorded = buffer.recorded();
        (recorded.mask.as_ref().and_then(super::OpenMask::returns), recorded.drawing.pipeline)
    };
    let next = buffer.armed.next.cmd_bind_pipeline;
    if returns.is_none() && pipeline != vk::Pipeline::null() {
        prepare(buffer, pipeline);
    }
    if let (Some(_), Some(next)) = (returns, next)
        && pipeline != vk::Pipeline::null()
        && buffer.armed.masks.as_ref().is_some_and(|masks| masks.can_return(pipeline))
    {
        // SAFETY: the command buffer is recording, as `# Safety` demands; the pipeline or its substitute is bound.
        unsafe { bind(buffer, handle, pipeline, |pipeline| next(handle, GRAPHICS, pipeline)) };
    }
}

/// The substitute of the application's pipeline goes: the pass has ended, or shaders are bound without one.
///
/// # Safety
///
/// As for [`bind`].
pub unsafe fn leave(buffer: &Buffer, handle: vk::CommandBuffer) {
    let (was, pipeline) = {
        let mut recorded = buffer.recorded();
        (recorded.drawing.in_place.take(), recorded.drawing.pipeline)
    };
    if let (Some(_), Some(next)) = (was, buffer.armed.next.cmd_bind_pipeline) {
        // SAFETY: the command buffer is recording, as `# Safety` demands; the pipeline was bound by the application.
        unsafe {
            next(handle, GRAPHICS, pipeline);
            restore_sets(buffer, handle);
        }
    }
}

/// As [`leave`], before a command with another effect under the substitute or its set; nothing without masks.
///
/// # Safety
///
/// As for [`bind`].
pub unsafe fn leave_for_command(buffer: Option<&Buffer>, handle: vk::CommandBuffer) {
    if let Some(buffer) = buffer.filter(|buffer| buffer.armed.masks.is_some()) {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe { leave(buffer, handle) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;

    #[test]
    fn sets_are_restored_before_another_layout_counts() {
        let layout = |number| Some(vk::PipelineLayout::from_raw(number));
        let [own, restored] = [true, true];
        let of = |was, is| {
            let Steps { binds_own, restores_sets } = steps(was, is);
            (binds_own, restores_sets)
        };
        assert_eq!(of(None, None), (own, !restored));
        assert_eq!(of(None, layout(1)), (!own, !restored));
        assert_eq!(of(layout(1), layout(1)), (!own, !restored), "ours stays where it is");
        assert_eq!(of(layout(1), layout(2)), (!own, restored));
        assert_eq!(of(layout(1), None), (own, restored));
    }

    #[test]
    fn nothing_is_kept_unless_it_is_followed() {
        let mut drawing = Drawing::default();
        drawing.bind_more();
        drawing.bind_sets(vk::PipelineLayout::null(), 0, &[vk::DescriptorSet::null()], &[]);
        assert!(drawing.is_complete() && !drawing.is_followed());
        drawing.begin(true);
        drawing.bind_more();
        assert!(!drawing.is_complete() && drawing.is_followed());
        drawing.forget();
        assert!(drawing.is_complete(), "after secondary command buffers nothing is bound");
    }
}
