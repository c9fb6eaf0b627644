//! New maps, and the decisions behind them, ahead of the application's submits to a queue.

use super::Outdated;
use crate::backend::{MapForm, Upload};
use crate::gpu::{GpuError, RecordingKey};
use crate::rate_map::RateImage;
use crate::vk::armed::Armed;
use crate::vk::candidates::{Candidate, Need, Parts, Texels};
use crate::vk::perception::{Deciding, Decision, MapTarget, ResolvedTargets, Written};
use crate::vk::planned_texels::MapShape;
use crate::vk::pre_submit::{Kept, Outcome, PreSubmitRing, Staging, Submission, Submitter};
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
    let add = |submission: &mut Submission<'_>| {
        add(submission, armed, (own, queue), &outdated, deciding)?;
        let candidates = outdated.iter().map(|candidate| Arc::clone(candidate) as Arc<dyn Any + Send + Sync>);
        submission.kept.extend(candidates);
        Ok(())
    };
    // SAFETY: this thread may use the live queue, as `# Safety` demands; the objects of the commands are kept.
    let outcome = unsafe { ring.submit((own, queue), (Work::Maps, is_urgent), add) };
    if outcome == Outcome::Failed {
        outdated.iter().for_each(|candidate| candidate.content().upload_failed());
    }
}

/// A step of a submit with commands that depend on nothing but their objects and the content of memory.
enum Step<'a> {
    /// The decision on the tiles of an eye.
    Decide(Decision),
    /// A candidate's map from a decision.
    Resolve(&'a Candidate, ResolvedTargets),
    /// A candidate's map from staged texels.
    Copy(&'a Candidate, Arc<Staging>),
}

impl Step<'_> {
    /// Adds the step to a key; `None` if its commands may differ from one time to the next.
    fn add_to(&self, key: &mut RecordingKey) -> Option<()> {
        key.extend(match self {
            Self::Decide(decision) => decision.key(),
            Self::Resolve(candidate, targets) => [targets.serial()?, candidate.map.serial()?],
            Self::Copy(candidate, staging) => [staging.serial(), candidate.map.serial()?],
        });
        Some(())
    }

    /// # Safety
    ///
    /// The command buffer is recording, outside of a render pass, for the queue of the step; its objects live until it has finished.
    unsafe fn record(&self, commands: vk::CommandBuffer) {
        let upload = |candidate: &Candidate, staging| {
            let upload = Upload { commands, staging, offset: 0, len: candidate.map.staging_len() };
            // SAFETY: as `# Safety` demands; the buffer holds the texels of the map.
            unsafe { candidate.map.record_upload(upload) };
        };
        match self {
            // SAFETY: as `# Safety` demands, after the written parameters.
            Self::Decide(decision) => unsafe { decision.record(commands) },
            Self::Resolve(candidate, targets) => {
                // SAFETY: as `# Safety` demands.
                let written = unsafe { targets.record(commands) };
                if let Written::Texels(texels) = written {
                    upload(candidate, texels);
                }
            }
            Self::Copy(candidate, staging) => upload(candidate, staging.buffer()),
        }
    }
}

/// Adds the decision, then for each candidate its map: resolved on the GPU from that decision, or else the plan's texels as a copy from
/// staging memory.
fn add(
    submission: &mut Submission<'_>,
    armed: &Armed,
    (own, queue): (Submitter<'_>, vk::Queue),
    outdated: &Outdated,
    deciding: Option<&Deciding>,
) -> Result<(), GpuError> {
    let mut steps: SmallVec<[Step<'_>; 8]> = SmallVec::new();
    if let Some(deciding) = deciding {
        let commands = submission.commands()?;
        let mut words = std::mem::take(&mut submission.slot().words);
        let memory = (&mut words, &mut submission.kept);
        let each = |decision| steps.push(Step::Decide(decision));
        // SAFETY: the command buffer is recording for the queue of the decision, and `kept` lives until it has finished.
        unsafe { armed.perception.decide(&armed.frame, commands, deciding, memory, each) };
        submission.slot().words = words;
    }
    let mut unstaged: SmallVec<[(&Candidate, MapShape, Texels); 8]> = SmallVec::new();
    for candidate in outdated {
        if let Some(targets) = resolved_targets(armed, candidate, queue, &mut submission.kept) {
            steps.push(Step::Resolve(candidate, targets));
            continue;
        }
        let Some((shape, texels)) = new_texels(armed, candidate) else { continue };
        let family = submission.slot().family();
        let staged = || armed.planned_texels.staged(&texels, family, own);
        match takes_texels(candidate).then(staged).flatten() {
            Some(staged) => {
                submission.kept.push(staged.clone());
                steps.push(Step::Copy(candidate, staged));
            }
            None => unstaged.push((candidate, shape, texels)),
        }
    }
    add_unstaged(submission, own, &unstaged)?;
    if steps.is_empty() {
        return Ok(());
    }
    let mut key = RecordingKey::new();
    let is_same = steps.iter().all(|step| step.add_to(&mut key).is_some());
    // SAFETY: the command buffer is recording for the queue, and all objects are kept, or are the candidates'.
    let record = |commands| steps.iter().for_each(|step| unsafe { step.record(commands) });
    submission.repeat(is_same.then_some(&key), record)
}

/// Adds copies of texels that are staged for this submit alone.
fn add_unstaged(
    submission: &mut Submission<'_>,
    own: Submitter<'_>,
    unstaged: &[(&Candidate, MapShape, Texels)],
) -> Result<(), GpuError> {
    if unstaged.is_empty() {
        return Ok(());
    }
    let commands = submission.commands()?;
    let padded_len = |candidate: &Candidate| candidate.map.staging_len().next_multiple_of(ALIGNMENT);
    let slot = submission.slot();
    slot.reserve(own, unstaged.iter().map(|(candidate, ..)| padded_len(candidate)).sum())?;
    let mut offset = 0;
    for (candidate, MapShape { parts, image, .. }, texels) in unstaged {
        let len = candidate.map.staging_len();
        slot.stage(offset, len, |staging| candidate.map.stage(parts, image, texels, staging));
        let upload = Upload { commands, staging: slot.buffer(), offset: offset as vk::DeviceSize, len };
        // SAFETY: the command buffer is recording, and the candidate is kept; the slot's staging memory holds the map from the offset on.
        unsafe { candidate.map.record_upload(upload) };
        offset += padded_len(candidate);
    }
    Ok(())
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

/// The targets that resolve a candidate's map from the GPU's decision, kept by `kept`; `None` where the plan's own rates hold.
fn resolved_targets(
    armed: &Armed,
    candidate: &Candidate,
    queue: vk::Queue,
    kept: &mut Kept,
) -> Option<ResolvedTargets> {
    // Tiles that nothing fills may not be coarse.
    let is_unfilled = candidate.content().is_unfilled();
    let form = candidate.map.form().filter(|_| !is_unfilled)?;
    let (image, parts) = rate_image(candidate);
    let skips_stale_tiles = candidate.map.skips_stale_tiles();
    let target = MapTarget { queue, parts: &parts, image: &image, skips_stale_tiles };
    let mut resolved = candidate.take_resolved();
    let plan = (&armed.frame, &armed.offered_rates);
    let targets = armed.perception.resolve(plan, &target, &form, &mut resolved, kept);
    candidate.keep_resolved(resolved);
    let targets = targets?;
    let mut content = candidate.content();
    let plan = armed.frame.plan();
    content.uploaded(plan.serial(), &parts, plan.stale());
    // Only the GPU knows the new content.
    content.lose();
    Some(targets)
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
