//! Submits of the application: the events of their command buffers are recognised, and the maps of their candidates are brought up to date
//! ahead of them, on the same queue.

mod maps;

use super::armed::Armed;
use super::candidates::{Candidate, Need};
use super::device::Device;
use super::{device, recording, runtime_section};
use crate::abi::copies::slice;
use crate::abi::guard;
use crate::pass_detection::{Event, How, Part, Pass, Unmasked};
use ash::vk;
use smallvec::SmallVec;
use std::sync::Arc;

/// `vkQueueSubmit`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    hook!("vkQueueSubmit", device::with, queue_submit(queue, count, submits, fence), |known, next| {
        if let Some(armed) = &known.armed {
            // SAFETY: valid usage demands so many structures, each with so many command buffers.
            let buffers = unsafe { slice(submits, count) }
                .iter()
                // SAFETY: as above.
                .flat_map(|submit| unsafe { slice(submit.p_command_buffers, submit.command_buffer_count) });
            // SAFETY: the queue is live, and this thread may use it: vkQueueSubmit demands external synchronisation.
            unsafe { prepare_or_leave(armed, known.is_active(), queue, buffers.copied()) };
        }
        let result = alone(&known, queue, next);
        if let Some(armed) = &known.armed {
            armed.timing.returned(queue, result);
        }
        result
    })
}

/// `vkQueueSubmit2`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn submit2(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    hook!("vkQueueSubmit2", device::with, queue_submit2(queue, count, submits, fence), |known, next| {
        if let Some(armed) = &known.armed {
            // SAFETY: valid usage demands so many structures, each with so many command buffers.
            let buffers = unsafe { slice(submits, count) }.iter().flat_map(|submit| unsafe {
                slice(submit.p_command_buffer_infos, submit.command_buffer_info_count)
            });
            // SAFETY: the queue is live, and this thread may use it: vkQueueSubmit demands external synchronisation.
            unsafe {
                prepare_or_leave(armed, known.is_active(), queue, buffers.map(|info| info.command_buffer))
            };
        }
        let result = alone(&known, queue, next);
        if let Some(armed) = &known.armed {
            armed.timing.returned(queue, result);
        }
        result
    })
}

/// `vkQueueSubmit` of the next layer, for work of the OpenXR half.
///
/// # Safety
///
/// The valid usage of the call; other threads may use the queue meanwhile.
pub unsafe extern "system" fn submit_own(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    hook!("vkQueueSubmit", device::with, queue_submit(queue, count, submits, fence), |known, next| {
        alone(&known, queue, next)
    })
}

/// Submits to a queue by `next`; on an armed device, one submit at a time.
fn alone<T>(known: &Device, queue: vk::Queue, next: impl FnOnce() -> T) -> T {
    match &known.armed {
        Some(armed) => armed.queue_locks.with(queue, next),
        None => next(),
    }
}

/// Candidates whose maps have to be written, the urgent ones too.
type Outdated = SmallVec<[Arc<Candidate>; 8]>;

/// As [`prepare`]; if that panics, the submit continues without it.
///
/// # Safety
///
/// As for [`prepare`].
unsafe fn prepare_or_leave(
    armed: &Armed,
    is_active: bool,
    queue: vk::Queue,
    buffers: impl Iterator<Item = vk::CommandBuffer>,
) {
    // SAFETY: this thread may use the live queue, as `# Safety` demands.
    guard("the maps of a submission", || (), |_| unsafe { prepare(armed, is_active, queue, buffers) });
}

/// Takes the command buffers of a submit, and brings the maps of its candidates up to date.
///
/// # Safety
///
/// The queue is a live one of the device, and this thread may use it now.
unsafe fn prepare(
    armed: &Armed,
    is_active: bool,
    queue: vk::Queue,
    buffers: impl Iterator<Item = vk::CommandBuffer>,
) {
    // Submits of the runtime or of the layer do not belong to the application's frame.
    let is_applications = !runtime_section::in_runtime_section();
    let is_followed = is_active && is_applications;
    if !is_followed && armed.backend.is_none() {
        return;
    }
    if is_followed {
        armed.frame.awaited.finish();
    }
    let mut touched = Outdated::new();
    let mut followed = Outdated::new();
    for buffer in buffers.filter_map(recording::buffer) {
        let is_first = buffer.recordings.submit();
        if buffer.recordings.is_untracked() {
            if is_first && is_followed && !armed.frame.rests() {
                armed.frame.log().miss();
            }
            continue;
        }
        let recorded = buffer.recorded();
        if is_followed && !recorded.layouts.is_empty() {
            armed.layouts.submitted(armed.objects.queue(queue), &recorded.layouts);
        }
        // Maps that are still coarse after the last session become 1x1.
        let is_left = || {
            is_applications && recorded.candidates.iter().any(|candidate| candidate.content().shows_scene())
        };
        if armed.follows_passes() && (is_followed || is_left()) {
            recognise_passes(armed, queue, &recorded, &mut followed);
        }
        for candidate in &recorded.candidates {
            add(&mut touched, candidate);
        }
    }
    // SAFETY: this thread may use the live queue, as `# Safety` demands.
    unsafe { update(armed, (is_followed, is_applications), queue, touched) };
    if followed.iter().any(|candidate| candidate.content().has_stale_tiles()) {
        let mut log = armed.frame.log();
        for candidate in &followed {
            log.add_stale(candidate.content().stale());
        }
    }
}

/// Adds a candidate once.
fn add(to: &mut Outdated, candidate: &Arc<Candidate>) {
    if !to.iter().any(|known| Arc::ptr_eq(known, candidate)) {
        to.push(Arc::clone(candidate));
    }
}

/// Brings outdated maps of candidates up to date; in submits of the application that are not followed, only maps that become 1x1, and in those
/// of the runtime only maps without content.
///
/// # Safety
///
/// As for [`prepare`].
unsafe fn update(
    armed: &Armed,
    (is_followed, is_applications): (bool, bool),
    queue: vk::Queue,
    mut touched: Outdated,
) {
    let shows_scene = || touched.iter().any(|candidate| candidate.content().shows_scene());
    let deciding =
        if is_followed && shows_scene() { armed.perception.deciding(&armed.frame, queue) } else { None };
    let plan = if deciding.is_some() { armed.frame.decided() } else { armed.frame.plan_serial() };
    touched.retain(|candidate| {
        candidate.map.staging_len() > 0
            && match candidate.need(plan) {
                Need::None => false,
                Need::Upload => is_followed || (is_applications && !candidate.content().shows_scene()),
                Need::Initialise => true,
            }
    });
    if touched.is_empty() {
        return;
    }
    let Some(own) = armed.submitter() else { return };
    let ring = match own.rings.get(queue) {
        Some(known) => known,
        None => match armed.objects.queue(queue) {
            Some(id) => own.ring(queue, id.family),
            None => return,
        },
    };
    // SAFETY: this thread may use the live queue, as `# Safety` demands.
    unsafe { maps::submit(&ring, armed, own, queue, touched, deciding.as_ref()) };
}

/// Whether a pass is known to draw nothing: engines clear the scene's image in a pass of its own.
fn is_empty(pass: &Pass) -> bool {
    pass.draws.as_ref().is_some_and(|draws| draws.quads + draws.meshes == 0)
}

/// Takes the events of a command buffer of the application, and recognises its passes; adds to `followed` the candidates with maps that its
/// passes obey.
fn recognise_passes(
    armed: &Armed,
    queue: vk::Queue,
    recorded: &recording::Recorded,
    followed: &mut Outdated,
) {
    let mut log = armed.frame.log();
    let is_on = armed.frame.is_on();
    // A map that is still coarse becomes 1x1, whether or not the frame is followed.
    let is_coarse = || recorded.candidates.iter().any(|candidate| candidate.content().shows_scene());
    let events = if log.follows() || is_coarse() { &recorded.events[..] } else { &[] };
    for event in events {
        let candidate = match event {
            Event::Pass(pass) => recorded.candidates.iter().find(|known| known.is_of(pass)).zip(Some(pass)),
            Event::Transfer(_) => None,
        };
        let verdict = log.push(&armed.objects, event, candidate.map(|(candidate, _)| candidate));
        if let Some((candidate, pass)) = candidate {
            let matched = verdict.and_then(Result::ok);
            if matched.as_ref().is_some_and(|found| !found.parts.is_empty()) {
                log.has_eye_pass(&armed.objects, pass);
            }
            let how = matched.as_ref().map(|found| found.how);
            candidate.map.submitted(how, pass.depth.is_some(), log.frame());
            // A pass without a mask obeys no map, and one without draws needs none: both do not affect the content of the map.
            if pass.unmasked.is_some_and(|reason| reason != Unmasked::Undrawn) || is_empty(pass) {
                continue;
            }
            add(followed, candidate);
            let has_layers = candidate.map.size().layers > 1;
            let matched = matched.filter(|found| is_on && (has_layers || found.shows_all_layers(pass)));
            let parts: &[Part] = matched.as_ref().map_or(&[], |found| &found.parts);
            if !parts.is_empty() {
                log.has_rates();
            }
            let mut content = candidate.content();
            // Other evidence places pictures in their images, wherever a pass draws.
            let is_whole = how == Some(How::Shape);
            let area = if is_whole { pass.picture_area() } else { pass.area };
            content.note(queue, log.frame(), area, parts);
            content.note_fill(log.frame(), pass.facts.is_unfilled);
        }
    }
    if !recorded.events.is_empty() || recorded.timer.is_complete() {
        armed.timing.submits(&recorded.timer, log.frame(), queue);
    }
}
