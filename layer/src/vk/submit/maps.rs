//! New maps, and the decisions behind them, ahead of the application's submits to a queue.

use super::Outdated;
use crate::backend::Upload;
use crate::gpu::GpuError;
use crate::rate_map::{RateImage, refine_fresh};
use crate::vk::armed::Armed;
use crate::vk::candidates::Need;
use crate::vk::perception::{Deciding, MapTarget, Written};
use crate::vk::pre_submit::{Kept, PreSubmitRing, Slot, Submitter};
use crate::vk::timing::Work;
use ash::vk;
use std::any::Any;
use std::sync::Arc;

/// Submits new maps of all of `outdated`, after their decision, if there is room; never waits.
///
/// # Safety
///
/// `queue` is the live queue of the ring, and this thread may use it now; `own` is of `armed`.
pub unsafe fn submit(
    ring: &PreSubmitRing,
    armed: &Armed,
    own: Submitter<'_>,
    queue: vk::Queue,
    outdated: Outdated,
    deciding: Option<&Deciding>,
) {
    let is_urgent = outdated.iter().any(|candidate| {
        let content = candidate.content();
        content.need(u64::MAX) == Need::Initialise || content.leaves_out()
    });
    // SAFETY: the caller vouches for the queue; the slot is not pending.
    ring.with_slot(own, is_urgent, |slot| unsafe { fill(slot, armed, own, queue, outdated, deciding) });
}

/// Records the decision, then for each candidate its map: resolved on the GPU from that decision, or else by the plan into the slot's
/// staging memory and copied; and submits all of it.
///
/// # Safety
///
/// As for [`submit`], and the slot is not pending.
unsafe fn fill(
    slot: &mut Slot,
    armed: &Armed,
    own: Submitter<'_>,
    queue: vk::Queue,
    outdated: Outdated,
    deciding: Option<&Deciding>,
) -> Result<(), GpuError> {
    let lengths = outdated.iter().map(|candidate| candidate.map.staging_len());
    let mut kept = Kept::new();
    // SAFETY: the slot is not pending, as the caller says; the queue is the caller's.
    unsafe {
        let len = lengths.map(|len| len.next_multiple_of(ALIGNMENT)).sum();
        slot.begin(own, Work::Maps, len)?;
        let commands = slot.commands();
        if let Some(deciding) = deciding {
            armed.perception.decide(&armed.frame, commands, deciding, &mut slot.words, &mut kept);
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
            if let Some(form) = candidate.map.form().filter(|_| !is_unfilled) {
                let place = MapTarget { queue, parts: &parts, image: &image, leaves_out };
                let mut laid = candidate.take_resolved();
                let written = armed.perception.resolve(
                    (&armed.frame, &armed.rates),
                    commands,
                    &place,
                    &form,
                    &mut laid,
                    &mut kept,
                );
                candidate.keep_resolved(laid);
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
                plan.resolve(&parts, &image, &armed.rates, &mut slot.texels);
                if !leaves_out && plan.leaves_out() {
                    armed.rates.coarsen_stale(&mut slot.texels);
                }
                if content.is_unfilled() {
                    refine_fresh(&mut slot.texels);
                }
                content.uploaded(plan.serial(), &parts, plan.stale());
                content.resolve(area, &parts, &mut slot.texels)
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
        if !has_work {
            return Ok(());
        }
        kept.extend(outdated.iter().map(|candidate| Arc::clone(candidate) as Arc<dyn Any + Send + Sync>));
        let submitted = slot.submit(own, queue, kept);
        if submitted.is_err() {
            outdated.iter().for_each(|candidate| candidate.content().lose());
        }
        submitted
    }
}

/// Staged maps begin at multiples of this, which copies of any format accept.
const ALIGNMENT: usize = 16;
