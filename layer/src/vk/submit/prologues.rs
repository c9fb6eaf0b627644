//! What we submit ahead of the application's submits to a queue: copies of new maps.

use super::Outdated;
use super::slot::Slot;
use crate::gpu::functions::Functions;
use crate::scene::lay::{RateImage, refine_fresh};
use crate::vk::armed::Armed;
use crate::vk::backend::Upload;
use crate::vk::candidates::Need;
use ash::vk;
use std::sync::{Mutex, PoisonError};

/// So many prologues of a queue may be under way. Beyond that maps stay as they are, unless they have no content yet, or leave
/// something out.
const MOST_SLOTS: usize = 8;

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

    /// Submits copies of new maps to all of `outdated`, if there is room; never waits.
    ///
    /// # Safety
    ///
    /// `queue` is the live queue of these prologues, and this thread may use it now; `functions` are those of `armed`.
    pub unsafe fn submit(&self, armed: &Armed, functions: &Functions, queue: vk::Queue, outdated: Outdated) {
        // Taken out, so that no lock is held across a call down. A queue is one thread's at a time; where that rule is
        // broken, the other thread finds none and makes one.
        let mut slots = std::mem::take(&mut *self.lock());
        slots.iter_mut().for_each(|slot| slot.poll(&functions.device));
        let is_urgent = outdated.iter().any(|candidate| {
            let content = candidate.content();
            content.need(u64::MAX) == Need::Initialise || content.leaves_out()
        });
        let mut free = slots.iter().position(|slot| !slot.is_pending());
        if free.is_none() && (is_urgent || slots.len() < MOST_SLOTS) {
            // SAFETY: the device is live and has queues of this family.
            match unsafe { Slot::new(armed, functions, self.family) } {
                Ok(slot) => {
                    free = Some(slots.len());
                    slots.push(slot);
                }
                Err(error) => tracing::warn!("maps of shading rates stay as they are: {error}"),
            }
        }
        if let Some(slot) = free.and_then(|index| slots.get_mut(index)) {
            // SAFETY: the caller vouches for the queue; the slot is not pending.
            if let Err(error) = unsafe { fill(slot, armed, functions, queue, outdated) } {
                tracing::warn!("maps of shading rates stay as they are: {error}");
            }
        }
        self.lock().append(&mut slots);
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

/// Lays the plan for each candidate into the slot's staging memory, and submits the copies.
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
) -> Result<(), crate::gpu::GpuError> {
    let lengths = outdated.iter().map(|candidate| candidate.map.staging_len());
    // SAFETY: the slot is not pending, as the caller says; the queue is the caller's.
    unsafe {
        slot.begin(functions, lengths.map(|len| len.next_multiple_of(ALIGNMENT)).sum())?;
        let mut offset = 0;
        for candidate in &outdated {
            let size = candidate.map.size();
            let len = candidate.map.staging_len();
            let (image, parts, is_news) = {
                let mut content = candidate.content();
                let (area, parts) = content.whole();
                let image = RateImage { area, texel: size.texel, tiles: size.tiles, layers: size.layers };
                let mut plan = armed.frame.plan();
                plan.lay(&parts, &image, &armed.rates, &mut slot.texels);
                if !candidate.map.leaves_out() {
                    armed.rates.coarsen_stale(&mut slot.texels);
                }
                if content.is_unfilled() {
                    refine_fresh(&mut slot.texels);
                }
                content.uploaded(plan.serial(), &parts, plan.stale());
                let is_news = content.lay(area, &parts, &slot.texels);
                (image, parts, is_news)
            };
            if !is_news {
                continue;
            }
            slot.stage(offset, len, |texels, staging| candidate.map.stage(&parts, &image, texels, staging));
            let (commands, staging) = (slot.commands(), slot.buffer());
            candidate.map.record_upload(Upload { commands, staging, offset: offset as vk::DeviceSize, len });
            offset += len.next_multiple_of(ALIGNMENT);
        }
        let Some(submit) = armed.next.queue_submit.filter(|_| offset > 0) else { return Ok(()) };
        let submitted = slot.submit(functions, submit, queue, outdated.clone());
        if submitted.is_err() {
            outdated.iter().for_each(|candidate| candidate.content().lose());
        }
        submitted
    }
}

/// Staged maps begin at multiples of this: a multiple of what copies of any format ask for.
const ALIGNMENT: usize = 16;
