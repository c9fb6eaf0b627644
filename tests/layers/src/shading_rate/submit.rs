//! Submits: recorded commands take effect, and their maps are read after completion.
//!
//! Behind each submit with a captured map goes an empty one with a fence of the layer's own. Maps are read, in
//! the order of submission, at a later submit, before the command buffer is used again, or when the device is
//! destroyed.

use super::chain::slice;
use super::lines::{SHADING_RATE_FILE_VARIABLE, ShadingRateLine};
use super::lower;
use super::map;
use super::recording::RecordedPass;
use super::replay::{Event, Masks, global_barrier, replay};
use super::state::State;
use super::{Emulator, emulator};
use crate::report;
use ash::vk;

/// A submit that may not have completed.
pub(super) struct InFlight {
    fence: vk::Fence,
    /// The command buffers executed, secondary ones too.
    buffers: Vec<vk::CommandBuffer>,
    passes: Vec<RecordedPass>,
}

/// Longest wait for the fence of a submit. It takes longer only if the submit waits for something that the
/// application does later. Software devices that compile on a busy machine take seconds.
const PATIENCE_NS: u64 = 120_000_000_000;

/// A wait for a semaphore makes everything before visible at its stages.
fn waited(state: &mut State, stages: vk::PipelineStageFlags2) {
    let all = vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE;
    let masks = Masks {
        src: (vk::PipelineStageFlags2::ALL_COMMANDS, all),
        dst: (stages, vk::AccessFlags2::MEMORY_READ),
    };
    global_barrier(&mut state.images, masks);
}

/// Executes a command buffer: adds its captures.
fn executed(state: &mut State, buffer: vk::CommandBuffer, to: &mut InFlight) {
    let State { recordings, images, findings, passes_executed, .. } = state;
    let Some(recording) = recordings.get(&buffer) else { return };
    replay(recordings, images, findings, &recording.events);
    let secondaries = recording.events.iter().filter_map(|event| match event {
        Event::Execute(secondary) => Some(*secondary),
        _ => None,
    });
    for buffer in std::iter::once(buffer).chain(secondaries) {
        to.buffers.push(buffer);
        for pass in recordings.get(&buffer).into_iter().flat_map(|recording| &recording.passes) {
            let mut line = pass.line.clone();
            line.index = *passes_executed;
            *passes_executed += 1;
            to.passes.push(RecordedPass { line, ..*pass });
        }
    }
}

/// Submits with `submit`, after maps of the same buffers were read, and has the new ones watched.
///
/// # Safety
///
/// `queue` is live and no other code uses it; `buffers` are the submitted ones.
unsafe fn submitted(
    emulator: &Emulator,
    queue: vk::Queue,
    batches: &[(vk::PipelineStageFlags2, Vec<vk::CommandBuffer>)],
    submit: impl FnOnce() -> vk::Result,
) -> vk::Result {
    let mut state = emulator.state();
    let state = &mut *state;
    // SAFETY: the caller vouches for the queue; the fence is not in use.
    unsafe {
        for buffer in batches.iter().flat_map(|(_, buffers)| buffers) {
            read_submits_of(emulator, state, *buffer);
        }
        read_completed(emulator, state);
        let result = submit();
        if result != vk::Result::SUCCESS {
            return result;
        }
        let mut new = InFlight { fence: vk::Fence::null(), buffers: Vec::new(), passes: Vec::new() };
        for (waits, buffers) in batches {
            if !waits.is_empty() {
                waited(state, *waits);
            }
            for buffer in buffers {
                executed(state, *buffer, &mut new);
            }
        }
        if !new.passes.is_empty() {
            let device = &emulator.next.functions;
            let fence = state.fences.pop().map_or_else(|| device.create_fence(&Default::default(), None), Ok);
            let watched = fence.and_then(|fence| device.queue_submit(queue, &[], fence).map(|()| fence));
            match watched {
                Ok(fence) => new.fence = fence,
                Err(error) => return error,
            }
            state.in_flight.push_back(new);
        }
        result
    }
}

/// Reads, in order, the completed captures.
///
/// # Safety
///
/// The device is live.
unsafe fn read_completed(emulator: &Emulator, state: &mut State) {
    let device = &emulator.next.functions;
    while let Some(first) = state.in_flight.front() {
        // SAFETY: the caller vouches for the device; the fence was submitted.
        if !matches!(unsafe { device.get_fence_status(first.fence) }, Ok(true)) {
            return;
        }
        // SAFETY: it has completed.
        unsafe { read_first(emulator, state, true) };
    }
}

/// Waits for and reads the submits up to the last that executed a buffer, which has completed.
///
/// # Safety
///
/// The device is live; nothing submits the buffer meanwhile.
pub(super) unsafe fn read_submits_of(emulator: &Emulator, state: &mut State, buffer: vk::CommandBuffer) {
    while state.in_flight.iter().any(|submit| submit.buffers.contains(&buffer)) {
        // SAFETY: the caller vouches for the device.
        unsafe { wait_for_first(emulator, state) };
    }
}

/// # Safety
///
/// The device is live.
unsafe fn wait_for_first(emulator: &Emulator, state: &mut State) {
    let Some(first) = state.in_flight.front() else { return };
    let device = &emulator.next.functions;
    // SAFETY: the caller vouches for the device; the fence was submitted.
    unsafe {
        let completed = device.wait_for_fences(&[first.fence], true, PATIENCE_NS).is_ok();
        read_first(emulator, state, completed);
    }
}

/// Reads the maps of the first submit in flight, if it has completed, and forgets it.
///
/// # Safety
///
/// The device is live; `completed` is true only if the submit has.
unsafe fn read_first(emulator: &Emulator, state: &mut State, completed: bool) {
    let Some(submit) = state.in_flight.pop_front() else { return };
    for RecordedPass { mut line, image, capture } in submit.passes {
        if let Some((capture, shape)) = capture.filter(|_| completed) {
            // SAFETY: the copy has completed; its buffer is submitted again only after this.
            let (map, illegal) = map::read(&shape, unsafe { capture.bytes() }, emulator.profile);
            let rule = "every texel is a rate of the device";
            state.findings.require(illegal.is_none(), "execution", rule, image, || {
                format!("{:#04x}", illegal.unwrap_or_default())
            });
            line.map = Some(map);
        }
        report::append(SHADING_RATE_FILE_VARIABLE, &ShadingRateLine::Pass(line));
    }
    if completed {
        // SAFETY: the fence is signalled, so that nothing uses it.
        let reset = unsafe { emulator.next.functions.reset_fences(&[submit.fence]) };
        if reset.is_ok() {
            state.fences.push(submit.fence);
        }
    }
}

/// Reports the submits in flight without their maps, calling nothing of Vulkan.
pub(super) fn leave(emulator: &Emulator) {
    let mut state = emulator.state();
    while !state.in_flight.is_empty() {
        // SAFETY: maps are read and fences reset of completed submits only.
        unsafe { read_first(emulator, &mut state, false) };
    }
}

/// Before the device is destroyed: reads the remaining captures, and destroys the layer's objects.
pub(super) fn finish(emulator: &Emulator) {
    let mut state = emulator.state();
    let state = &mut *state;
    let device = &emulator.next.functions;
    // SAFETY: the device is still live, and nothing is submitted any more.
    unsafe {
        while !state.in_flight.is_empty() {
            wait_for_first(emulator, state);
        }
        for pass in state.recordings.drain().flat_map(|(_, recording)| recording.passes) {
            if let Some((capture, _)) = pass.capture {
                state.captures.give_back(capture);
            }
        }
        state.captures.destroy(device);
        for fence in state.fences.drain(..) {
            device.destroy_fence(fence, None);
        }
    }
}

/// # Safety
/// As `vkQueueSubmit`.
pub(super) unsafe extern "system" fn queue_submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments, with other stages.
    unsafe {
        let emulator = emulator(queue);
        let submits = slice(submits, count);
        let stages = |submit: &vk::SubmitInfo<'_>| {
            slice(submit.p_wait_dst_stage_mask, submit.wait_semaphore_count).to_vec()
        };
        let batches: Vec<_> = submits
            .iter()
            .map(|submit| {
                let waits = stages(submit).into_iter().fold(Default::default(), |all, stage| all | stage);
                let waits = vk::PipelineStageFlags2::from_raw(vk::PipelineStageFlags::as_raw(waits).into());
                (waits, slice(submit.p_command_buffers, submit.command_buffer_count).to_vec())
            })
            .collect();
        let lowered: Vec<Vec<_>> =
            submits.iter().map(|submit| stages(submit).into_iter().map(lower::stages).collect()).collect();
        let infos: Vec<_> = submits
            .iter()
            .zip(&lowered)
            .map(|(submit, stages)| vk::SubmitInfo { p_wait_dst_stage_mask: stages.as_ptr(), ..*submit })
            .collect();
        submitted(&emulator, queue, &batches, || {
            (emulator.v1_0().queue_submit)(queue, count, infos.as_ptr(), fence)
        })
    }
}

/// # Safety
/// As `vkQueueSubmit2`.
pub(super) unsafe extern "system" fn queue_submit2(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments, with other stages.
    unsafe {
        let emulator = emulator(queue);
        let Some(next) = emulator.functions.queue_submit2 else { return vk::Result::ERROR_DEVICE_LOST };
        let submits = slice(submits, count);
        let lower = |first, count| {
            let mut semaphores = slice::<vk::SemaphoreSubmitInfo<'_>>(first, count).to_vec();
            for semaphore in &mut semaphores {
                semaphore.stage_mask = lower::stages2(semaphore.stage_mask);
            }
            semaphores
        };
        let batches: Vec<_> = submits
            .iter()
            .map(|submit| {
                let waits = slice(submit.p_wait_semaphore_infos, submit.wait_semaphore_info_count);
                let stages =
                    waits.iter().fold(vk::PipelineStageFlags2::NONE, |all, wait| all | wait.stage_mask);
                let buffers = slice(submit.p_command_buffer_infos, submit.command_buffer_info_count);
                (stages, buffers.iter().map(|info| info.command_buffer).collect())
            })
            .collect();
        let lowered: Vec<_> = submits
            .iter()
            .map(|submit| {
                let waits = lower(submit.p_wait_semaphore_infos, submit.wait_semaphore_info_count);
                (waits, lower(submit.p_signal_semaphore_infos, submit.signal_semaphore_info_count))
            })
            .collect();
        let infos: Vec<_> = submits
            .iter()
            .zip(&lowered)
            .map(|(submit, (waits, signals))| vk::SubmitInfo2 {
                p_wait_semaphore_infos: waits.as_ptr(),
                p_signal_semaphore_infos: signals.as_ptr(),
                ..*submit
            })
            .collect();
        submitted(&emulator, queue, &batches, || next(queue, count, infos.as_ptr(), fence))
    }
}
