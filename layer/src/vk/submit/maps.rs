//! New maps, and the decisions behind them, ahead of the application's submits to a queue.

use super::Outdated;
use crate::backend::Upload;
use crate::gpu::GpuError;
use crate::rate_map::{RateImage, refine_fresh};
use crate::vk::armed::Armed;
use crate::vk::candidates::{Candidate, Need, Parts};
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
        candidate.need(u64::MAX) == Need::Initialise || candidate.content().has_stale_tiles()
    });
    // SAFETY: this thread may use the live queue, as `# Safety` demands; the slot is not pending.
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
    let len = lengths.map(|len| len.next_multiple_of(ALIGNMENT)).sum();
    // SAFETY: the slot is not pending, as `# Safety` demands, and its device is that of `own`.
    unsafe { slot.begin(own, Work::Maps, len) }?;
    let (commands, mut kept) = (slot.commands(), Kept::new());
    if let Some(deciding) = deciding {
        // SAFETY: the command buffer began above, for the queue of the decision; the slot holds `kept` until it has finished.
        unsafe { armed.perception.decide(&armed.frame, commands, deciding, &mut slot.words, &mut kept) };
    }
    let mut offset = 0;
    for candidate in &outdated {
        // SAFETY: the command buffer began above, for this queue; the slot holds `kept` and the candidates until it has finished.
        if unsafe { resolve_on_gpu(armed, candidate, (queue, commands), &mut kept) } {
            continue;
        }
        let len = candidate.map.staging_len();
        if stage_plan(slot, armed, candidate, offset) {
            let upload = Upload { commands, staging: slot.buffer(), offset: offset as vk::DeviceSize, len };
            // SAFETY: as above; the slot's staging memory holds the map from there on.
            unsafe { candidate.map.record_upload(upload) };
            offset += len.next_multiple_of(ALIGNMENT);
        }
    }
    if offset == 0 && kept.is_empty() {
        return Ok(());
    }
    kept.extend(outdated.iter().map(|candidate| Arc::clone(candidate) as Arc<dyn Any + Send + Sync>));
    // SAFETY: this thread may use the queue, as `# Safety` demands; the slot is recording since the begin above.
    let submitted = unsafe { slot.submit(own, queue, kept) };
    if submitted.is_err() {
        outdated.iter().for_each(|candidate| candidate.content().upload_failed());
    }
    submitted
}

/// The rate image of a candidate, and the shown parts of it.
fn rate_image(candidate: &Candidate) -> (RateImage, Parts) {
    let (area, parts) = candidate.content().whole();
    let size = candidate.map.size();
    (RateImage { area, texel: size.texel, tiles: size.tiles, layers: size.layers }, parts)
}

/// Records the resolve of a candidate's map from the GPU's decision; false, and nothing is recorded, where the plan's own rates hold.
///
/// # Safety
///
/// The command buffer is recording, outside of a render pass, for the queue; `kept` and the candidate live until it has finished.
unsafe fn resolve_on_gpu(
    armed: &Armed,
    candidate: &Candidate,
    (queue, commands): (vk::Queue, vk::CommandBuffer),
    kept: &mut Kept,
) -> bool {
    // Tiles that nothing fills may not be coarse.
    let is_unfilled = candidate.content().is_unfilled();
    let Some(form) = candidate.map.form().filter(|_| !is_unfilled) else { return false };
    let (image, parts) = rate_image(candidate);
    let skips_stale_tiles = candidate.map.skips_stale_tiles();
    let target = MapTarget { queue, parts: &parts, image: &image, skips_stale_tiles };
    let mut resolved = candidate.take_resolved();
    let plan = (&armed.frame, &armed.offered_rates);
    // SAFETY: the command buffer is recording, and `kept` lives until it has finished, as `# Safety` demands.
    let written = unsafe { armed.perception.resolve(plan, commands, &target, &form, &mut resolved, kept) };
    candidate.keep_resolved(resolved);
    let Some(written) = written else { return false };
    {
        let mut content = candidate.content();
        let plan = armed.frame.plan();
        content.uploaded(plan.serial(), &parts, plan.stale());
        // Only the GPU knows the new content.
        content.lose();
    }
    if let Written::Texels(staging) = written {
        let upload = Upload { commands, staging, offset: 0, len: candidate.map.staging_len() };
        // SAFETY: as above; the buffer holds the resolved texels, and is kept with them.
        unsafe { candidate.map.record_upload(upload) };
    }
    true
}

/// Resolves the plan over a candidate's map, and writes that to the slot's staging memory at `offset`; false where the map holds it already.
fn stage_plan(slot: &mut Slot, armed: &Armed, candidate: &Candidate, offset: usize) -> bool {
    let (image, parts) = rate_image(candidate);
    let is_new = {
        let mut content = candidate.content();
        let mut plan = armed.frame.plan();
        plan.resolve(&parts, &image, &armed.offered_rates, &mut slot.texels);
        if !candidate.map.skips_stale_tiles() && plan.has_stale_tiles() {
            armed.offered_rates.coarsen_stale(&mut slot.texels);
        }
        if content.is_unfilled() {
            refine_fresh(&mut slot.texels);
        }
        content.uploaded(plan.serial(), &parts, plan.stale());
        content.resolve(image.area, &parts, &mut slot.texels)
    };
    if is_new {
        let content = candidate.content();
        slot.stage(offset, candidate.map.staging_len(), |staging| {
            candidate.map.stage(&parts, &image, content.texels(), staging);
        });
    }
    is_new
}

/// Staged maps begin at multiples of this, which copies of any format accept.
const ALIGNMENT: usize = 16;
