//! Rates by the content of pictures: their contrast stays on the GPU, and so do the decisions from it.
//!
//! Finished pictures are analysed on the queue of the session, before their images are the runtime's ([`Perception::analyze`]), and their
//! contrast counts from the end of their frame on ([`Perception::notify_view`]); ahead of the next submit with a pass of the scene on that
//! queue the rates of the tiles are decided, and resolved into the maps of its passes ([`Perception::deciding`]). Where any of it is
//! missing, the maps hold the plan's own rates, which are rings.

mod copied;
mod decision;
mod eye;
mod eye_buffers;
mod resolved_map;
mod tools;

pub use decision::{Deciding, Decision};
pub use resolved_map::{MapTarget, ResolvedMap, ResolvedTargets, Written};

use super::pre_submit::{Outcome, PreSubmitRing, Submission, Submitter};
use super::timing::Work;
use crate::gpu::{AppCommands, Later, RecordingKey};
use crate::kernels::analyze::{AnalyzeTarget, AnalyzedPicture};
use crate::link::{DeviceRecord, EyeBufferRecord, EyeViewRecord};
use ash::vk;
use eye::{Analyzed, Eye, EyeTiles, Measured, Parameters, Place};
use eye_buffers::EyeBuffers;
use smallvec::SmallVec;
use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tools::Tools;

/// Contrast of the pictures of a device, and the decisions by it.
#[derive(Default)]
pub struct Perception {
    tools: Mutex<Made>,
    state: Mutex<State>,
}

/// The kernels, compiled once they are needed.
#[derive(Default)]
enum Made {
    #[default]
    NotYet,
    /// Available once they were compiled.
    Asked(Later<Tools>),
    /// The device is about to be destroyed.
    Never,
}

#[derive(Default)]
struct State {
    /// Queue that analyses pictures: its family and index, and its handle.
    queue: Option<([u32; 2], vk::Queue)>,
    eyes: [Option<Eye>; 2],
    eye_buffers: EyeBuffers,
    /// Number of pictures whose contrast became known.
    measured: u64,
    /// The last decision: number of the plan, and of the last analysis.
    decided: Option<(u64, u64)>,
    /// The last logged reason why nothing is decided.
    logged: Option<&'static str>,
}

/// A picture that is to be analysed on a queue.
struct Prepared {
    tools: Arc<Tools>,
    queue: vk::Queue,
    ring: Arc<PreSubmitRing>,
    target: Arc<AnalyzeTarget>,
    tiles: Arc<EyeTiles>,
    layout: vk::ImageLayout,
    analyzed: Analyzed,
}

impl Prepared {
    /// Adds the picture to the key of an analysis.
    fn add_to(&self, key: &mut RecordingKey) {
        let layout = self.layout.as_raw() as u32;
        key.push(self.target.serial());
        key.push(u64::from(layout) << 32 | u64::from(self.analyzed.comparison.min(2)));
    }

    fn picture(&self) -> AnalyzedPicture<'_> {
        AnalyzedPicture { target: &self.target, layout: self.layout, comparison: self.analyzed.comparison }
    }
}

impl Perception {
    /// Analyses finished pictures whose contrast counts, each with its layout, for the decisions of later frames. It never waits: with too
    /// much work in progress, they are left out.
    ///
    /// # Safety
    ///
    /// As [`EyeBufferRecord`] demands: the images are live and in the state described there, and this thread may use the queue, the same for
    /// all of them.
    pub unsafe fn analyze(&self, own: Submitter<'_>, pictures: &[(&EyeBufferRecord, vk::ImageLayout)]) {
        let mut prepared: SmallVec<[Prepared; 2]> = SmallVec::new();
        // SAFETY: the record names the queue of the device's session, which was created with the device.
        let prepare =
            |(record, layout): &(&EyeBufferRecord, _)| unsafe { self.prepare(own, record, *layout) };
        prepared.extend(pictures.iter().filter_map(prepare));
        let Some(Prepared { tools, queue, ring, .. }) = prepared.first() else { return };
        let mut key = RecordingKey::new();
        prepared.iter().for_each(|picture| picture.add_to(&mut key));
        let record = |commands: vk::CommandBuffer| {
            // SAFETY: the command buffer is recording for that queue, which supports graphics; all objects that it uses are kept.
            let commands = unsafe { AppCommands::new(&tools.gpu, commands) };
            let pictures: SmallVec<[AnalyzedPicture<'_>; 2]> =
                prepared.iter().map(Prepared::picture).collect();
            tools.analyze.record(&commands, &pictures);
        };
        let add = |submission: &mut Submission<'_>| {
            for Prepared { target, tiles, .. } in &prepared {
                submission.kept.push(target.clone());
                // The target names images of the tiles: the tiles must outlive the work.
                submission.kept.push(Arc::clone(tiles) as Arc<dyn Any + Send + Sync>);
            }
            submission.repeat(Some(&key), record)
        };
        // SAFETY: this thread may use the live queue, as `# Safety` demands, and the objects of the commands are kept.
        let outcome = unsafe { ring.submit((own, *queue), (Work::Analysis, false), add) };
        if outcome == Outcome::Submitted {
            let mut state = self.state();
            for Prepared { tiles, analyzed, .. } in &prepared {
                if let Some(eye) = &mut state.eyes[tiles.eye] {
                    eye.analyzed = Some(*analyzed);
                }
            }
        }
    }

    /// Prepares the analysis of a picture on a queue; `None` if its contrast does not count, or is not known yet.
    ///
    /// # Safety
    ///
    /// The device was created with the record's queue, and the image is live.
    unsafe fn prepare(
        &self,
        own: Submitter<'_>,
        record: &EyeBufferRecord,
        layout: vk::ImageLayout,
    ) -> Option<Prepared> {
        let eye = record.eye as usize;
        if eye > 1 {
            return None;
        }
        let (received, decision, [extent, texel, tiles]) = {
            let plan = own.frame.plan();
            (plan.received(), plan.decision(eye).copied(), plan.shape(eye))
        };
        let Some(decision) = decision.filter(|_| own.frame.is_on()) else {
            self.forget_eye(eye);
            return None;
        };
        let tools = self.tools(own.record)?;
        let [_, _, width, height] = record.rect;
        if [width, height] != extent {
            self.log_once("the size of the eye buffers differs from the planned one");
            self.forget_eye(eye);
            return None;
        }
        // SAFETY: as `# Safety` demands.
        let (queue, ring) = unsafe { self.queue(own, record.queue) }?;
        let eye_tiles = self.eye(&tools, eye, tiles, extent)?;
        if decision.judged.is_none() {
            self.forget_contrast(eye);
            return None;
        }
        let target = self.picture(&tools, (record, queue), texel, &eye_tiles)?;
        let by = Parameters::new(record, texel);
        let last = self.state().eyes[eye].as_ref().and_then(|eye| eye.measured);
        let comparison = last.map_or(0, |last| last.next_comparison(by));
        let analyzed = Analyzed { place: Place::of(record), received, by, comparison };
        Some(Prepared { tools, queue, ring, target, tiles: eye_tiles, layout, analyzed })
    }

    /// A frame shows an eye buffer in a view: the contrast of its picture counts from now on, if it was analysed since the last call.
    pub fn notify_view(&self, record: &EyeViewRecord) {
        let mut state = self.state();
        let Some(Some(eye)) = state.eyes.get_mut(record.eye as usize) else { return };
        let Some(analyzed) = eye.analyzed.take() else { return };
        eye.measured = Measured::new(record, &analyzed, eye.measured.as_ref());
        let is_measured = eye.measured.is_some();
        state.measured += u64::from(is_measured);
    }

    /// Forgets a swapchain that is about to be destroyed. Returns the queue that may still read its images and must be waited for, if any.
    pub fn forget_swapchain(&self, swapchain: u64) -> Option<vk::Queue> {
        self.state().eye_buffers.forget(swapchain)
    }

    /// The session ends: nothing is known any more, but which swapchains pending work may read.
    pub fn forget(&self) {
        let mut state = self.state();
        let (eyes, known) = (std::mem::take(&mut state.eyes), state.eye_buffers.take_all());
        state.decided = None;
        drop(state);
        drop((eyes, known));
    }

    /// The device is about to be destroyed, and the GPU is done with everything.
    pub fn end(&self) {
        self.forget();
        let tools = std::mem::replace(&mut *self.kept_tools(), Made::Never);
        drop(tools);
    }

    /// The kernels, once they were compiled; asks for them the first time.
    fn tools(&self, record: &DeviceRecord) -> Option<Arc<Tools>> {
        let is_new = matches!(*self.kept_tools(), Made::NotYet);
        if is_new {
            // Asked for without the lock, which is not held across calls down.
            let asked = Made::Asked(Tools::ask(record));
            *self.kept_tools() = asked;
        }
        self.made()
    }

    fn made(&self) -> Option<Arc<Tools>> {
        match &*self.kept_tools() {
            Made::Asked(tools) => tools.get().cloned(),
            Made::NotYet | Made::Never => None,
        }
    }

    fn kept_tools(&self) -> MutexGuard<'_, Made> {
        self.tools.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Logs why rates are not decided, once for each reason.
    fn log_once(&self, reason: &'static str) {
        if self.state().logged.replace(reason) != Some(reason) {
            tracing::info!("rings instead of rates by contrast: {reason}");
        }
    }

    /// No pass gets rates for now, so that nothing is analysed or decided.
    pub fn rest(&self) {
        [0, 1].into_iter().for_each(|eye| self.forget_eye(eye));
    }

    /// Forgets the state of an eye, and frees its memory once the GPU is done with it.
    fn forget_eye(&self, eye: usize) {
        let mut state = self.state();
        let forgotten = (state.eyes[eye].take(), state.eye_buffers.take_others(eye, None));
        drop(state);
        drop(forgotten);
    }

    fn forget_contrast(&self, eye: usize) {
        if let Some(eye) = &mut self.state().eyes[eye] {
            (eye.analyzed, eye.measured) = (None, None);
        }
    }

    /// The queue of a session, which may draw and compute, and its ring.
    ///
    /// # Safety
    ///
    /// The device was created with that queue.
    unsafe fn queue(&self, own: Submitter<'_>, id: [u32; 2]) -> Option<(vk::Queue, Arc<PreSubmitRing>)> {
        let known = self.state().queue.filter(|(known, _)| *known == id);
        let queue = match known {
            Some((_, queue)) => queue,
            None => {
                // SAFETY: the device was created with that queue, as `# Safety` demands; the loader's callback may see it again, and writes the same pointer.
                let queue = unsafe {
                    let queue = own.functions.device.get_device_queue(id[0], id[1]);
                    crate::gpu::functions::init_dispatch(own.record, queue).ok()?;
                    queue
                };
                self.state().queue = Some((id, queue));
                queue
            }
        };
        Some((queue, own.ring(queue, id[0])))
    }

    /// The state of an eye with that many tiles and pixels; a state of other sizes is forgotten.
    fn eye(&self, tools: &Tools, eye: usize, tiles: [u32; 2], extent: [u32; 2]) -> Option<Arc<EyeTiles>> {
        let is_it = |known: &&Eye| known.tiles.view.tiles() == tiles && known.tiles.extent == extent;
        if let Some(known) = self.state().eyes[eye].as_ref().filter(is_it) {
            return Some(Arc::clone(&known.tiles));
        }
        match EyeTiles::new(tools, eye, tiles, extent) {
            Ok(new) => {
                let new = Arc::new(new);
                let mut state = self.state();
                let next = Eye { tiles: Arc::clone(&new), analyzed: None, measured: None };
                let forgotten =
                    (state.eyes[eye].replace(next), state.eye_buffers.take_others(eye, Some(&new)));
                drop(state);
                drop(forgotten);
                Some(new)
            }
            Err(error) => {
                error.log("rings instead of rates by contrast");
                None
            }
        }
    }

    fn picture(
        &self,
        tools: &Tools,
        (record, queue): (&EyeBufferRecord, vk::Queue),
        texel: [u32; 2],
        tiles: &Arc<EyeTiles>,
    ) -> Option<Arc<AnalyzeTarget>> {
        if let Some(known) = self.state().eye_buffers.find(record, tiles) {
            return Some(known);
        }
        match eye_buffers::target(tools, record, texel, tiles) {
            Ok(new) => Some(self.state().eye_buffers.keep(record, queue, tiles, new)),
            Err(error) => {
                error.log("the contrast of an image cannot be measured");
                None
            }
        }
    }
}
