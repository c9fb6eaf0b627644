//! What we submit ahead of the application's submits to a queue: new maps, and what they are decided by.

use super::Outdated;
use super::slot::Slot;
use crate::gpu::GpuError;
use crate::gpu::functions::Functions;
use crate::scene::lay::{RateImage, refine_fresh};
use crate::vk::armed::Armed;
use crate::vk::backend::Upload;
use crate::vk::candidates::Need;
use crate::vk::perception::{Deciding, Kept, Place, Written};
use crate::vk::timing::Work;
use ash::vk;
use std::sync::{Mutex, PoisonError};

/// So many prologues of a queue may be under way: of three frames, each with two submits that draw the scene, and a picture of each eye
/// that is analysed, and one that is drawn over. Beyond that maps stay as they are, unless they have no content yet, or leave something
/// out, and pictures are left out.
const MOST_SLOTS: usize = 24;

/// Prologues of one queue.
#[derive(Default)]
pub struct Prologues {
    family: u32,
    slots: Mutex<Vec<Slot>>,
}

impl Prologues {
    /// For a queue of that family.
    pub fn new(family: u32) -> Self {
        Self { family, slots: Mutex::default() }
    }

    /// Submits new maps of all of `outdated`, after what is to be decided, if there is room; never waits.
    ///
    /// # Safety
    ///
    /// `queue` is the live queue of these prologues, and this thread may use it now; `functions` are those of `armed`.
    pub unsafe fn submit(
        &self,
        armed: &Armed,
        functions: &Functions,
        queue: vk::Queue,
        outdated: Outdated,
        deciding: Option<&Deciding>,
    ) {
        let is_urgent = outdated.iter().any(|candidate| {
            let content = candidate.content();
            content.need(u64::MAX) == Need::Initialise || content.leaves_out()
        });
        // SAFETY: the caller vouches for the queue; the slot is not pending.
        self.with_slot(armed, functions, is_urgent, |slot| unsafe {
            fill(slot, armed, functions, queue, outdated, deciding)
        });
    }

    /// Submits what `record` records, of which `kept` has to live until it has finished, if there is room; never waits. Whether
    /// that was done.
    ///
    /// # Safety
    ///
    /// As for [`Self::submit`], and what is recorded may be submitted to the queue.
    pub unsafe fn run(
        &self,
        armed: &Armed,
        functions: &Functions,
        queue: vk::Queue,
        kept: Kept,
        record: impl FnOnce(vk::CommandBuffer) -> Result<(), GpuError>,
    ) -> bool {
        let Some(submit) = armed.next.queue_submit else { return false };
        // SAFETY: the caller vouches for the queue; the slot is not pending.
        self.with_slot(armed, functions, false, |slot| unsafe {
            slot.begin(armed, functions, Work::Analysis, 0)?;
            record(slot.commands())?;
            slot.submit(armed, functions, submit, queue, (Outdated::new(), kept))
        })
    }

    /// Does something with a slot that is not pending; with a new one beyond [`MOST_SLOTS`] only where that is urgent. Whether it was
    /// done.
    fn with_slot(
        &self,
        armed: &Armed,
        functions: &Functions,
        is_urgent: bool,
        act: impl FnOnce(&mut Slot) -> Result<(), GpuError>,
    ) -> bool {
        // Taken out, so that no lock is held across a call down. A queue is one thread's at a time; where that rule is
        // broken, the other thread finds none and makes one.
        let mut slots = std::mem::take(&mut *self.lock());
        slots.iter_mut().for_each(|slot| slot.poll(&functions.device));
        // Before what they wrote is overwritten.
        armed.timing.read();
        let mut free = slots.iter().position(|slot| !slot.is_pending());
        if free.is_none() && (is_urgent || slots.len() < MOST_SLOTS) {
            // SAFETY: the device is live and has queues of this family.
            match unsafe { Slot::new(armed, functions, self.family) } {
                Ok(slot) => {
                    free = Some(slots.len());
                    slots.push(slot);
                }
                Err(error) => error.tell("shading rates stay unchanged"),
            }
        }
        let done = free.and_then(|index| slots.get_mut(index)).is_some_and(|slot| {
            act(slot).inspect_err(|error| error.tell("shading rates stay unchanged")).is_ok()
        });
        self.put_back(slots);
        done
    }

    /// Back with their memory, so that a steady frame asks for none; behind them what another thread has made meanwhile.
    fn put_back(&self, mut slots: Vec<Slot>) {
        let mut kept = self.lock();
        std::mem::swap(&mut *kept, &mut slots);
        kept.append(&mut slots);
    }

    /// Waits until the GPU is done with all that is under way.
    pub fn wait(&self, armed: &Armed) {
        let Some(functions) = armed.functions() else { return };
        let mut slots = std::mem::take(&mut *self.lock());
        slots.iter_mut().for_each(|slot| slot.wait(&functions.device));
        self.put_back(slots);
    }

    /// Waits for all, and destroys it, before the device is destroyed.
    pub fn destroy(&self, armed: &Armed) {
        let Some(functions) = armed.functions() else { return };
        for slot in std::mem::take(&mut *self.lock()) {
            slot.destroy(&functions.device);
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Slot>> {
        self.slots.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Records what is to be decided, then for each candidate its map: laid on the GPU from what was decided there, or else by the plan into
/// the slot's staging memory and copied; and submits that.
///
/// # Safety
///
/// As for [`Prologues::submit`], and the slot is not pending.
unsafe fn fill(
    slot: &mut Slot,
    armed: &Armed,
    functions: &Functions,
    queue: vk::Queue,
    outdated: Outdated,
    deciding: Option<&Deciding>,
) -> Result<(), GpuError> {
    let lengths = outdated.iter().map(|candidate| candidate.map.staging_len());
    let mut kept = Kept::new();
    // SAFETY: the slot is not pending, as the caller says; the queue is the caller's.
    unsafe {
        let len = lengths.map(|len| len.next_multiple_of(ALIGNMENT)).sum();
        slot.begin(armed, functions, Work::Maps, len)?;
        let commands = slot.commands();
        if let Some(deciding) = deciding {
            armed.perception.decide(armed, commands, deciding, &mut slot.words, &mut kept);
        }
        let mut offset = 0;
        for candidate in &outdated {
            let size = candidate.map.size();
            let len = candidate.map.staging_len();
            let ((area, parts), is_unfilled) = {
                let content = candidate.content();
                (content.whole(), content.is_unfilled())
            };
            let image = RateImage { area, texel: size.texel, tiles: size.tiles, layers: size.layers };
            let leaves_out = candidate.map.leaves_out();
            // What nothing fills may not be coarse.
            if let Some(laying) = candidate.map.laying().filter(|_| !is_unfilled) {
                let place = Place { queue, parts: &parts, image: &image, leaves_out };
                let mut laid = candidate.take_laid();
                let written = armed.perception.lay(armed, commands, &place, &laying, &mut laid, &mut kept);
                candidate.keep_laid(laid);
                if let Some(written) = written {
                    let mut content = candidate.content();
                    let plan = armed.frame.plan();
                    content.uploaded(plan.serial(), &parts, plan.stale());
                    // What is there now only the GPU knows.
                    content.lose();
                    drop((plan, content));
                    if let Written::Texels(staging) = written {
                        candidate.map.record_upload(Upload { commands, staging, offset: 0, len });
                    }
                    continue;
                }
            }
            let is_news = {
                let mut content = candidate.content();
                let mut plan = armed.frame.plan();
                plan.lay(&parts, &image, &armed.rates, &mut slot.texels);
                if !leaves_out && plan.leaves_out() {
                    armed.rates.coarsen_stale(&mut slot.texels);
                }
                if content.is_unfilled() {
                    refine_fresh(&mut slot.texels);
                }
                content.uploaded(plan.serial(), &parts, plan.stale());
                content.lay(area, &parts, &mut slot.texels)
            };
            if !is_news {
                continue;
            }
            let content = candidate.content();
            slot.stage(offset, len, |staging| candidate.map.stage(&parts, &image, content.texels(), staging));
            drop(content);
            let staging = slot.buffer();
            candidate.map.record_upload(Upload { commands, staging, offset: offset as vk::DeviceSize, len });
            offset += len.next_multiple_of(ALIGNMENT);
        }
        let has_work = offset > 0 || !kept.is_empty();
        let Some(submit) = armed.next.queue_submit.filter(|_| has_work) else { return Ok(()) };
        let submitted = slot.submit(armed, functions, submit, queue, (outdated.clone(), kept));
        if submitted.is_err() {
            outdated.iter().for_each(|candidate| candidate.content().lose());
        }
        submitted
    }
}

/// Staged maps begin at multiples of this: a multiple of what copies of any format ask for.
const ALIGNMENT: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_keep_their_memory() {
        let prologues = Prologues::new(0);
        let slots = Vec::with_capacity(4);
        let memory = slots.as_ptr();
        prologues.put_back(slots);
        assert_eq!(prologues.lock().as_ptr(), memory);
    }
}
