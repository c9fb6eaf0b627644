//! New maps, and the decisions behind them, ahead of the application's submits to a queue.

use super::Outdated;
use crate::backend::{MapForm, Upload};
use crate::gpu::GpuError;
use crate::rate_map::RateImage;
use crate::vk::armed::Armed;
use crate::vk::candidates::{Candidate, Need, Parts, Texels};
use crate::vk::perception::{Deciding, MapTarget, Written};
use crate::vk::planned_texels::MapShape;
use crate::vk::pre_submit::{Kept, PreSubmitRing, Slot, Submitter};
use crate::vk::timing::Work;
use ash::vk;
use smallvec::SmallVec;
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

/// Records the decision, then for each candidate its map: resolved on the GPU from that decision, or else the plan's texels as a copy from
/// staging memory; and submits all of it.
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
    // SAFETY: the slot is not pending, as `# Safety` demands, and its device is that of `own`.
    unsafe { slot.begin(own, Work::Maps) }?;
    let mut kept = Kept::new();
    // SAFETY: the slot is recording since the begin above, for this queue, and holds `kept` and the candidates until it has finished.
    let recorded = unsafe { record(slot, armed, (own, queue), (&outdated, deciding), &mut kept) };
    let submitted = match recorded {
        Ok(false) => return Ok(()),
        Ok(true) => {
            kept.extend(outdated.iter().map(|candidate| Arc::clone(candidate) as Arc<dyn Any + Send + Sync>));
            // SAFETY: this thread may use the queue, as `# Safety` demands; the slot is recording since the begin above.
            unsafe { slot.submit(own, queue, kept) }
        }
        Err(error) => Err(error),
    };
    if submitted.is_err() {
        outdated.iter().for_each(|candidate| candidate.content().upload_failed());
    }
    submitted
}

/// Records the decision and the maps. Returns whether anything was recorded.
///
/// # Safety
///
/// The slot is recording, for the queue, and `kept` and the candidates live until that has finished; `own` is of `armed`.
unsafe fn record(
    slot: &mut Slot,
    armed: &Armed,
    (own, queue): (Submitter<'_>, vk::Queue),
    (outdated, deciding): (&Outdated, Option<&Deciding>),
    kept: &mut Kept,
) -> Result<bool, GpuError> {
    let commands = slot.commands();
    if let Some(deciding) = deciding {
        // SAFETY: the command buffer is recording for the queue of the decision, and `kept` lives until it has finished.
        unsafe { armed.perception.decide(&armed.frame, commands, deciding, &mut slot.words, kept) };
    }
    let mut has_maps = false;
    let mut unstaged: SmallVec<[(&Candidate, MapShape, Texels); 8]> = SmallVec::new();
    for candidate in outdated {
        // SAFETY: the command buffer is recording for this queue; `kept` and the candidates live until it has finished.
        if unsafe { resolve_on_gpu(armed, candidate, (queue, commands), kept) } {
            continue;
        }
        let Some((shape, texels)) = new_texels(armed, candidate) else { continue };
        has_maps = true;
        let staged = || armed.planned_texels.staged(&texels, slot.family(), own);
        let Some(staged) = takes_texels(candidate).then(staged).flatten() else {
            unstaged.push((candidate, shape, texels));
            continue;
        };
        let upload =
            Upload { commands, staging: staged.buffer(), offset: 0, len: candidate.map.staging_len() };
        kept.push(staged);
        // SAFETY: as above; the staging memory holds the map, and is kept.
        unsafe { candidate.map.record_upload(upload) };
    }
    let padded_len = |candidate: &Candidate| candidate.map.staging_len().next_multiple_of(ALIGNMENT);
    slot.reserve(own, unstaged.iter().map(|(candidate, ..)| padded_len(candidate)).sum())?;
    let mut offset = 0;
    for (candidate, MapShape { parts, image, .. }, texels) in &unstaged {
        let len = candidate.map.staging_len();
        slot.stage(offset, len, |staging| candidate.map.stage(parts, image, texels, staging));
        let upload = Upload { commands, staging: slot.buffer(), offset: offset as vk::DeviceSize, len };
        // SAFETY: as above; the slot's staging memory holds the map from the offset on.
        unsafe { candidate.map.record_upload(upload) };
        offset += padded_len(candidate);
    }
    Ok(has_maps || !kept.is_empty())
}

/// Whether a candidate's map takes texels as they are.
fn takes_texels(candidate: &Candidate) -> bool {
    matches!(candidate.map.form(), Some(MapForm::Texels))
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

/// The plan's texels for a candidate's map, with their shape; `None` where the map holds them already.
fn new_texels(armed: &Armed, candidate: &Candidate) -> Option<(MapShape, Texels)> {
    let (image, parts) = rate_image(candidate);
    let is_unfilled = candidate.content().is_unfilled();
    let skips_stale_tiles = candidate.map.skips_stale_tiles();
    let shape = MapShape { image, parts, skips_stale_tiles, is_unfilled };
    let mut content = candidate.content();
    let was_of_nothing = content.is_of_nothing();
    let texels = {
        let mut plan = armed.frame.plan();
        content.uploaded(plan.serial(), &shape.parts, plan.stale());
        if was_of_nothing && shape.parts.is_empty() {
            return None;
        }
        armed.planned_texels.of(&shape, &mut plan, &armed.offered_rates)
    };
    content.resolve(shape.image.area, &shape.parts, &texels).then_some((shape, texels))
}

/// Staged maps begin at multiples of this, which copies of any format accept.
const ALIGNMENT: usize = 16;
