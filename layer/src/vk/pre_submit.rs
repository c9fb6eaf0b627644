//! Work of ours ahead of the application's submits to a queue: a ring of command buffers that are used again and again.

mod recorded;
mod slot;
mod staging;
#[cfg(test)]
mod stand_in;
mod submission;

pub use slot::Slot;
pub use staging::Staging;
pub use submission::Submission;

use super::frame::Frame;
use super::queue_locks::QueueLocks;
use super::table::Table;
use super::timing::{Timing, Work};
use crate::gpu::GpuError;
use crate::gpu::functions::Functions;
use crate::link::DeviceRecord;
use ash::vk;
use recorded::RecordedCommands;
use smallvec::SmallVec;
use std::any::Any;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Limit of the layer's pending command buffers for a queue: three frames, each with two submits that draw the scene, and with the analysis and the
/// overlay of each eye's image. Beyond the limit, images are not analysed, and maps stay unchanged unless they have no content yet or leave
/// tiles out.
const MOST_SLOTS: usize = 24;

/// Longest time for which a thread takes slots out, to record and submit commands.
const LONGEST_TAKEN: Duration = Duration::from_secs(1);

/// Memory and objects that a submit of ours uses until the GPU is done with them.
pub type Kept = SmallVec<[Arc<dyn Any + Send + Sync>; 20]>;

/// The parts of a device with which work of ours is submitted.
#[derive(Clone, Copy)]
pub struct Submitter<'a> {
    /// The device.
    pub record: &'a DeviceRecord,
    /// The next layer's functions for work of our own.
    pub functions: &'a Functions,
    /// The next layer's vkQueueSubmit.
    pub submit: vk::PFN_vkQueueSubmit,
    /// Held during a submit.
    pub locks: &'a QueueLocks,
    /// The GPU time of frames.
    pub timing: &'a Timing,
    /// The current frame.
    pub frame: &'a Frame,
    /// The rings of all queues.
    pub rings: &'a Table<vk::Queue, Arc<PreSubmitRing>>,
}

/// Outcome of [`PreSubmitRing::submit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The commands are submitted.
    Submitted,
    /// There were no commands.
    Empty,
    /// No slot was free.
    NoRoom,
    /// A call failed, and nothing was submitted.
    Failed,
}

impl Submitter<'_> {
    /// The ring of a queue of that family.
    pub fn ring(&self, queue: vk::Queue, family: u32) -> Arc<PreSubmitRing> {
        let new = || Arc::new(PreSubmitRing::new(family));
        self.rings.get(queue).unwrap_or_else(|| self.rings.get_or_insert(queue, new()))
    }
}

/// Command buffers of ours for one queue, which are used in turn.
#[derive(Default)]
pub struct PreSubmitRing {
    family: u32,
    slots: Mutex<Vec<Slot>>,
    /// `None` while a thread has taken them out.
    recorded: Mutex<Option<RecordedCommands>>,
    /// Number of threads that have taken slots out.
    takers: AtomicU32,
    /// Number of the newest submit.
    newest: AtomicU64,
}

impl PreSubmitRing {
    /// For a queue of that family.
    pub fn new(family: u32) -> Self {
        Self { family, recorded: Mutex::new(Some(RecordedCommands::default())), ..Self::default() }
    }

    /// Submits the commands that `add` adds, if a slot is free; never waits. Beyond [`MOST_SLOTS`], only an urgent submit gets a new slot.
    ///
    /// # Safety
    ///
    /// `queue` is the live queue of this ring, and this thread may use it now; `own` is of its device. The commands may be submitted to the
    /// queue, and all their objects are kept by [`Submission::kept`], or valid until they have finished.
    pub unsafe fn submit(
        &self,
        (own, queue): (Submitter<'_>, vk::Queue),
        (work, is_urgent): (Work, bool),
        add: impl FnOnce(&mut Submission<'_>) -> Result<(), GpuError>,
    ) -> Outcome {
        // Taken out, so that no lock is held across a call down. A queue is one thread's at a time; where that rule is
        // broken, the other thread finds none and makes one.
        let (mut slots, _) = self.take_out();
        let mut recorded = lock(&self.recorded).take();
        find_finished(&mut slots, &own.functions.device);
        destroy_spare(&mut slots, &own.functions.device);
        let mut free = slots.iter().position(|slot| slot.pending().is_none());
        // Read before the slots' timestamps are overwritten.
        own.timing.read();
        if free.is_none() && (is_urgent || slots.len() < MOST_SLOTS) {
            // SAFETY: the device is live and has queues of this family.
            match unsafe { Slot::new(own, self.family) } {
                Ok(slot) => {
                    free = Some(slots.len());
                    slots.push(slot);
                }
                Err(error) => error.log("shading rates stay unchanged"),
            }
        }
        let outcome = free.and_then(|index| slots.get_mut(index)).map_or(Outcome::NoRoom, |slot| {
            let mut submission = Submission::new(slot, recorded.as_mut(), own, work);
            let submitted = add(&mut submission).and_then(|()| {
                // SAFETY: this thread may use the live queue, as `# Safety` demands.
                unsafe { submission.submit(queue, &self.newest) }
            });
            submitted.unwrap_or_else(|error| {
                error.log("shading rates stay unchanged");
                Outcome::Failed
            })
        });
        if recorded.is_some() {
            *lock(&self.recorded) = recorded;
        }
        self.put_back(slots);
        outcome
    }

    /// The slots of the ring, and the number of other threads with slots taken out.
    fn take_out(&self) -> (Vec<Slot>, u32) {
        let mut slots = lock(&self.slots);
        let others = self.takers.fetch_add(1, Ordering::Relaxed);
        (std::mem::take(&mut *slots), others)
    }

    /// Back with their memory, so that a steady frame asks for none; behind them the slots that another thread has made meanwhile.
    fn put_back(&self, mut slots: Vec<Slot>) {
        let mut kept = lock(&self.slots);
        std::mem::swap(&mut *kept, &mut slots);
        kept.append(&mut slots);
        self.takers.fetch_sub(1, Ordering::Relaxed);
    }

    /// Lets go of all that the GPU is done with: no submit may follow for long.
    pub fn poll(&self, functions: &Functions) {
        let (mut slots, _) = self.take_out();
        find_finished(&mut slots, &functions.device);
        self.put_back(slots);
    }

    /// Waits until the GPU is done with all pending work, that of slots which other threads have taken out included: these threads submit, and
    /// put them back.
    pub fn wait(&self, functions: &Functions) {
        let start = Instant::now();
        loop {
            let (mut slots, others) = self.take_out();
            // One wait for all: on a device that is far behind, each may take seconds.
            if let Some(newest) = slots.iter_mut().max_by_key(|slot| slot.pending()) {
                newest.wait(&functions.device);
            }
            find_finished(&mut slots, &functions.device);
            self.put_back(slots);
            // After a panic a thread puts nothing back.
            if others == 0 || start.elapsed() > LONGEST_TAKEN {
                return;
            }
            std::thread::yield_now();
        }
    }

    /// Waits for all, and destroys it, before the device is destroyed.
    pub fn destroy(&self, functions: &Functions) {
        for slot in std::mem::take(&mut *lock(&self.slots)) {
            slot.destroy(&functions.device);
        }
        if let Some(recorded) = lock(&self.recorded).take() {
            recorded.destroy(&functions.device);
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Destroys free slots beyond [`MOST_SLOTS`]: threads that submit at once make slots of their own.
fn destroy_spare(slots: &mut Vec<Slot>, device: &ash::Device) {
    while slots.len() > MOST_SLOTS
        && let Some(spare) = slots.iter().rposition(|slot| slot.pending().is_none())
    {
        slots.swap_remove(spare).destroy(device);
    }
}

/// Finishes the slots that the GPU is done with. The fences of a queue are signalled in the order of its submits: on a device that keeps up,
/// that of the newest answers for all; on another, the search ends at the oldest unfinished one.
fn find_finished(slots: &mut [Slot], device: &ash::Device) {
    let mut pending: SmallVec<[(u64, usize); MOST_SLOTS]> =
        slots.iter().enumerate().filter_map(|(index, slot)| Some((slot.pending()?, index))).collect();
    pending.sort_unstable();
    let Some(&(_, newest)) = pending.last() else { return };
    let have_all_finished = slots[newest].has_finished(device);
    for (_, index) in pending {
        if !have_all_finished && !slots[index].has_finished(device) {
            return;
        }
        slots[index].finish();
    }
}

#[cfg(test)]
mod tests;
