//! The commands of each command buffer of an armed device, as far as the rest needs to know them.
//!
//! Command buffers are recorded on several threads: each has a lock of its own, which no other thread takes meanwhile. Its lists keep their
//! memory when it is recorded again.

pub mod binding;
pub mod buffers;
pub mod compute;
pub mod descriptor_buffers;
pub mod dispatches;
pub mod drawing;
pub mod draws;
pub mod generated;
pub mod heaps;
pub mod image_layouts;
pub mod passes;
pub mod pending;
pub mod queries;
pub mod rects;
pub mod rendering;
mod sets;
pub mod stencil;
mod timed;
pub mod transfers;
mod untracked;
mod viewports;

use super::armed::Armed;
use super::candidates::Candidate;
use super::device;
use super::functions::ArmedTable;
use super::table::Table;
use super::timing::Timer;
use crate::backend::mask::{
    EarlyReturnSupport, Ended, OpenMask, Pending, PipelineFacts, Prepasses, follows_graphics,
};
use crate::pass_detection::{Event, Pass};
use ash::vk;
use compute::Bound;
use descriptor_buffers::BufferOffsets;
use drawing::Drawing;
use draws::Tally;
use smallvec::SmallVec;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use stencil::StencilTests;
use untracked::Recordings;
use viewports::Viewports;

/// Command buffers of all armed devices: their handles are addresses, so that no two live ones are the same.
static BUFFERS: LazyLock<Table<vk::CommandBuffer, Arc<Buffer>>> = LazyLock::new(Table::default);

/// A live command buffer.
pub struct Buffer {
    /// Its device.
    pub armed: Arc<Armed>,
    /// Whether it is a primary one.
    pub is_primary: bool,
    /// Its recordings so far.
    pub recordings: Recordings,
    recorded: Mutex<Recorded>,
}

/// The recorded commands of a command buffer.
#[derive(Default)]
pub struct Recorded {
    /// In the order of its commands.
    pub events: Vec<Event>,
    /// Targets of its passes that may be the scene.
    pub candidates: SmallVec<[Arc<Candidate>; 8]>,
    /// Swapchain images that the layer reads, with the layouts that commands left them in, in the order of those; `None`: as it was.
    pub layouts: SmallVec<[(vk::Image, Option<vk::ImageLayout>); 4]>,
    /// Timestamps around its work.
    pub timer: Timer,
    /// Bound compute state, where that is followed.
    pub compute: Bound,
    /// Bound graphics state, where that is followed.
    pub drawing: Drawing,
    /// Places of the descriptors of both that are in buffers.
    pub offsets: BufferOffsets,
    /// Stencil tests that commands have set.
    stencil: StencilTests,
    /// Fills that wait for a reader.
    pending: SmallVec<[Pending; 2]>,
    /// Passes that have cleared depth for others.
    prepasses: Prepasses,
    /// Index in `events` of the pass that is being recorded.
    open: Option<usize>,
    /// The candidate of that pass, if it has one.
    target: Option<Arc<Candidate>>,
    /// The mask that it has.
    mask: Option<OpenMask>,
    /// Facts of the bound graphics pipeline, which stays bound from one pass to the next.
    pipeline: PipelineFacts,
    /// For a secondary that continues a pass: facts that the pass must know.
    within: Within,
    /// Occlusion queries that are active.
    queries: u32,
    /// Whether conditional rendering is active.
    is_conditional: bool,
    /// Draws of the pass that is being recorded, or of a secondary that continues one.
    tally: Tally,
    viewports: Viewports,
}

/// Facts of a pass from the commands within.
#[derive(Debug, Clone, Copy, Default)]
struct Within {
    clears_depth: bool,
    is_queried: bool,
    /// By draws whose state commands have set.
    writes_stencil: bool,
    /// The pipelines that are bound within; `None`: the pipeline from before the pass draws.
    pipelines: Option<PipelineFacts>,
}

impl Buffer {
    fn new(armed: Arc<Armed>, is_primary: bool, timer: Timer) -> Self {
        let recorded = Mutex::new(Recorded { timer, ..Recorded::default() });
        Self { armed, is_primary, recordings: Recordings::default(), recorded }
    }

    /// Whether draws may be recorded in it: within a pass that is known, or in one that goes on from a primary.
    fn may_draw(&self) -> bool {
        !self.is_primary || self.recorded().is_within_pass()
    }

    /// Its recorded commands.
    pub fn recorded(&self) -> MutexGuard<'_, Recorded> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A live command buffer of an armed device.
pub fn buffer(handle: vk::CommandBuffer) -> Option<Arc<Buffer>> {
    BUFFERS.get(handle)
}

/// A live command buffer of an armed device; `None` if its commands are not tracked.
pub fn tracked(handle: vk::CommandBuffer) -> Option<Arc<Buffer>> {
    buffer(handle).filter(|known| !known.recordings.is_untracked())
}

/// Forgets a command buffer that is about to be freed.
fn forget(handle: vk::CommandBuffer) {
    let known = BUFFERS.remove(handle);
    if let Some(rates) = known.as_ref().and_then(|known| known.armed.rate_attachments.as_ref()) {
        rates.set_rates.forget(handle);
    }
    if known.is_none_or(|known| known.recordings.is_untracked()) {
        untracked::forget(handle);
    }
}

/// Forgets the command buffers of a device that is about to be destroyed.
pub fn forget_device(armed: &Arc<Armed>) {
    drop(BUFFERS.remove_where(|_, buffer| Arc::ptr_eq(&buffer.armed, armed)));
    untracked::forget_threads();
}

impl Recorded {
    /// Forgets all; the memory stays.
    fn clear(&mut self) {
        self.events.clear();
        self.candidates.clear();
        self.layouts.clear();
        self.timer.clear();
        self.compute.clear();
        self.drawing.forget();
        self.drawing.begin(follows_graphics());
        self.offsets.clear();
        self.stencil = StencilTests::default();
        self.pending.clear();
        self.prepasses.clear();
        self.open = None;
        self.target = None;
        self.mask = None;
        self.pipeline = PipelineFacts::default();
        self.within = Within::default();
        self.queries = 0;
        self.is_conditional = false;
        self.tally = Tally::default();
        self.viewports = Viewports::default();
    }

    /// A pass begins, with a mask or without; `pass` is `None` if its objects are unknown.
    fn begin(&mut self, pass: Option<Pass>, candidate: Option<Arc<Candidate>>, mask: Option<OpenMask>) {
        if let Some(candidate) = &candidate
            && !self.candidates.iter().any(|known| Arc::ptr_eq(known, candidate))
        {
            self.candidates.push(Arc::clone(candidate));
        }
        self.within = Within::default();
        self.viewports.pass_begins();
        self.stencil.pass_begins();
        self.target = candidate;
        self.mask = mask;
        self.open = pass.as_ref().map(|_| self.events.len());
        if let Some(mut pass) = pass {
            pass.facts.is_queried |= self.is_queried();
            self.events.push(Event::Pass(pass));
        }
    }

    /// The draws of the pass that is being recorded and ends are these. Its region is not known if some are lost, or pipelines may have
    /// viewports of their own.
    fn end_draws(&mut self, has_static_viewports: bool) {
        let region = self.viewports.finish(self.tally.counts());
        let draws = self.tally.finish();
        if let Some(Event::Pass(pass)) = self.open.and_then(|open| self.events.get_mut(open)) {
            pass.draws = draws;
            if pass.draws.is_some() && !has_static_viewports {
                pass.region = region.of_area(pass.area);
            }
        }
    }

    /// A secondary command buffer ends: all of its draws are counted.
    fn count_viewports(&mut self) {
        self.viewports.count(self.tally.counts());
    }

    /// The pass that is being recorded ends; returns the mask that it had.
    fn end(&mut self) -> Option<OpenMask> {
        let open = self.open.take().and_then(|open| self.events.get(open));
        let candidate = self.target.take();
        let target = candidate.as_ref().and_then(|candidate| candidate.mask());
        if let (Some(target), Some(Event::Pass(pass))) = (target, open) {
            target.recorded(Ended {
                facts: pass.facts,
                pipelines: self.pipelines(),
                restores_compute: self.restores_compute(),
                restores_graphics: self.restores_graphics(),
                has_depth: pass.depth.is_some(),
                is_prepass: pass.colors.is_empty(),
            });
        }
        self.mask.take()
    }

    /// Whether the compute state can be restored.
    fn restores_compute(&self) -> bool {
        self.compute.is_complete() && self.offsets.is_complete()
    }

    /// Whether the followed part of the graphics state can be restored.
    fn restores_graphics(&self) -> bool {
        self.drawing.is_complete() && self.offsets.is_complete()
    }

    /// Facts of the pipelines that draw in the pass which is being recorded.
    fn pipelines(&self) -> PipelineFacts {
        let pipelines = self.within.pipelines.unwrap_or(self.pipeline.without_dynamic_stencil());
        PipelineFacts { write_stencil: pipelines.write_stencil | self.within.writes_stencil, ..pipelines }
    }

    /// Adds facts from commands within a pass.
    fn add(&mut self, more: Within) {
        self.within.clears_depth |= more.clears_depth;
        self.within.is_queried |= more.is_queried;
        self.within.writes_stencil |= more.writes_stencil;
        if let Some(pipelines) = more.pipelines {
            self.within.pipelines.get_or_insert_default().see(pipelines);
        }
        if let Some(Event::Pass(pass)) = self.open.and_then(|open| self.events.get_mut(open)) {
            pass.facts.clears_depth_later |= more.clears_depth;
            pass.facts.is_queried |= more.is_queried;
        }
    }

    /// Whether a pass is being recorded that is known.
    fn is_within_pass(&self) -> bool {
        self.open.is_some()
    }

    fn is_queried(&self) -> bool {
        self.queries > 0 || self.is_conditional
    }

    /// A graphics pipeline, or its substitute, is bound.
    pub fn use_pipeline(&mut self, pipelines: PipelineFacts) {
        self.pipeline = pipelines;
        let pipelines = Some(pipelines.without_dynamic_stencil());
        self.add(Within { pipelines, ..Within::default() });
    }

    /// A secondary is executed: its events follow, and its commands within the pass count for that.
    fn execute(&mut self, secondary: &Self) {
        let is_queried = self.is_queried();
        let events = secondary.events.iter().cloned().map(|mut event| {
            if let Event::Pass(pass) = &mut event {
                pass.facts.is_queried |= is_queried;
            }
            event
        });
        self.events.extend(events);
        self.layouts.extend(secondary.layouts.iter().copied());
        for candidate in &secondary.candidates {
            if !self.candidates.iter().any(|known| Arc::ptr_eq(known, candidate)) {
                self.candidates.push(Arc::clone(candidate));
            }
        }
        // Pipelines that secondary command buffers bind stay the application's own.
        let pipelines = secondary
            .within
            .pipelines
            .map(|facts| PipelineFacts { returns: EarlyReturnSupport::default(), ..facts });
        self.add(Within { pipelines, ..secondary.within });
        // Of the pass that is open here, or continued by this buffer, a secondary too; of others, none are left.
        self.tally.execute(&secondary.tally);
        self.viewports.execute(&secondary.viewports, secondary.tally.counts());
        self.drawing.forget();
        self.offsets.forget_offsets();
    }
}

/// A command buffer with the next layer's function that `choose` names. Its [`Buffer`] is missing if its device is not armed, it did not come
/// through this layer, or its commands are not tracked.
///
/// # Safety
///
/// `handle` is a live command buffer.
pub unsafe fn with_buffer<F>(
    handle: vk::CommandBuffer,
    choose: impl FnOnce(&ArmedTable) -> Option<F>,
) -> Option<(Option<Arc<Buffer>>, F)> {
    if untracked::is_here(handle) {
        // SAFETY: the handle is live, as `# Safety` demands.
        if let Some(armed) = unsafe { draws::cached_device(handle) } {
            return Some((None, choose(&armed.next)?));
        }
    }
    // SAFETY: as above.
    let (known, next) = unsafe { with_any(handle, choose) }?;
    Some((known.filter(|known| !known.recordings.is_untracked()), next))
}

/// The same, whether or not its commands are tracked.
///
/// # Safety
///
/// `handle` is a live command buffer.
unsafe fn with_any<F>(
    handle: vk::CommandBuffer,
    choose: impl FnOnce(&ArmedTable) -> Option<F>,
) -> Option<(Option<Arc<Buffer>>, F)> {
    if let Some(known) = buffer(handle) {
        let next = choose(&known.armed.next)?;
        return Some((Some(known), next));
    }
    // SAFETY: the handle is live, as `# Safety` demands.
    let (_, next) = unsafe { device::with(handle, choose) }?;
    Some((None, next))
}

/// x, y, width, height; pixels left of or above the corner are cut.
fn area(rect: vk::Rect2D) -> [u32; 4] {
    [
        rect.offset.x.max(0).cast_unsigned(),
        rect.offset.y.max(0).cast_unsigned(),
        rect.extent.width,
        rect.extent.height,
    ]
}

/// Begins to keep a primary command buffer, and returns it.
#[cfg(test)]
pub fn keep(armed: &Arc<Armed>, handle: vk::CommandBuffer) -> Arc<Buffer> {
    let buffer = Arc::new(Buffer::new(Arc::clone(armed), true, Timer::default()));
    BUFFERS.insert(handle, Arc::clone(&buffer));
    buffer
}

#[cfg(test)]
mod tests;
