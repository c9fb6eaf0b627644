//! Command buffers with their recorded commands.

use super::capture::Capture;
use super::chain::slice;
use super::findings::Findings;
use super::lines::ShadingRatePass;
use super::map::Shape;
use super::pipeline::Pipeline;
use super::rate::Rate;
use super::render_pass::{RenderPass, are_compatible};
use super::replay::Event;
use super::state::State;
use super::{emulator, submit};
use ash::vk;
use std::sync::Arc;

/// A command buffer, with the commands recorded since its begin.
#[derive(Default)]
pub(super) struct Recording {
    pub events: Vec<Event>,
    pub passes: Vec<RecordedPass>,
    pub current: Option<Current>,
    pub pipeline: Option<Arc<Pipeline>>,
    /// Rate of vkCmdSetFragmentShadingRateKHR, while no pipeline with a rate of its own was bound.
    pub set_rate: Option<Rate>,
    /// Draws of a secondary buffer in the pass of a primary one.
    continued: Draws,
}

/// A pass with a rate attachment.
pub(super) struct RecordedPass {
    /// Without number and map.
    pub line: ShadingRatePass,
    pub image: vk::Image,
    pub capture: Option<(Capture, Shape)>,
}

/// The pass that commands are in.
pub(super) enum Current {
    RenderPass {
        render_pass: Arc<RenderPass>,
        subpass: usize,
        /// For each subpass, its place in [`Recording::passes`].
        passes: Vec<Option<usize>>,
    },
    Rendering {
        pass: Option<usize>,
        /// Whether there is a rate attachment; not known in a secondary buffer.
        attachment: Option<bool>,
    },
}

#[derive(Clone, Copy, Default)]
struct Draws {
    all: u32,
    obeying: u32,
    /// Whether one had a pipeline without the flag.
    unflagged: bool,
}

const KIND: &str = "command";

impl Recording {
    /// The one of [`Self::passes`] that contains the next commands.
    fn current_pass(&mut self) -> Option<&mut RecordedPass> {
        let index = match self.current.as_ref()? {
            Current::RenderPass { subpass, passes, .. } => passes.get(*subpass).copied().flatten(),
            Current::Rendering { pass, .. } => *pass,
        };
        self.passes.get_mut(index?)
    }

    /// Some draw calls are recorded by a command of that name.
    pub fn draw(&mut self, findings: &mut Findings, buffer: vk::CommandBuffer, command: &str, count: u32) {
        let Some(pipeline) = self.pipeline.clone() else { return };
        let rate = if pipeline.dynamic { self.set_rate } else { Some(pipeline.rate) };
        if rate.is_none() {
            let rule = format!("VUID-{command}-pipelineFragmentShadingRate-09238");
            findings.require(false, KIND, &rule, buffer, || {
                "the rate is dynamic, and was not set since the last pipeline with a rate of its own"
                    .to_owned()
            });
        }
        let keep = vk::FragmentShadingRateCombinerOpKHR::KEEP;
        let obeying = rate.is_some_and(|rate| rate.combiners[1] != keep);
        match &self.current {
            Some(Current::RenderPass { render_pass, subpass, .. }) => {
                let compatible = pipeline.render_pass.as_ref().is_some_and(|(other, index)| {
                    are_compatible(&other.rates, &render_pass.rates) && *index as usize == *subpass
                });
                if !compatible {
                    let rule = format!("VUID-{command}-renderPass-02684");
                    findings.require(false, KIND, &rule, buffer, || {
                        let other = pipeline.render_pass.as_ref().map(|(other, _)| &other.rates);
                        format!(
                            "rate attachments {:?} of the pass, {other:?} of the pipeline",
                            render_pass.rates
                        )
                    });
                }
            }
            Some(Current::Rendering { attachment: Some(true), .. }) => {
                require_flag(findings, buffer, command, pipeline.flagged);
            }
            _ => {}
        }
        let (draws, draws_obeying) = (count, if obeying { count } else { 0 });
        self.continued.all += draws;
        self.continued.obeying += draws_obeying;
        self.continued.unflagged |= !pipeline.flagged;
        if let Some(pass) = self.current_pass() {
            pass.line.draws += draws;
            pass.line.draws_obeying += draws_obeying;
        }
    }

    /// A secondary buffer is executed here. It leaves no state behind.
    fn execute(&mut self, findings: &mut Findings, buffer: vk::CommandBuffer, secondary: Draws) {
        if let Some(Current::Rendering { attachment: Some(true), .. }) = self.current {
            require_flag(findings, buffer, "vkCmdDraw", !secondary.unflagged);
        }
        if let Some(pass) = self.current_pass() {
            pass.line.draws += secondary.all;
            pass.line.draws_obeying += secondary.obeying;
        }
        self.pipeline = None;
        self.set_rate = None;
    }
}

fn require_flag(findings: &mut Findings, buffer: vk::CommandBuffer, command: &str, flagged: bool) {
    if flagged {
        return;
    }
    let rule = format!("VUID-{command}-imageView-06183");
    findings.require(false, KIND, &rule, buffer, || {
        "a pipeline without VK_PIPELINE_CREATE_RENDERING_FRAGMENT_SHADING_RATE_ATTACHMENT_BIT_KHR".to_owned()
    });
}

/// # Safety
/// As `vkAllocateCommandBuffers`.
pub(super) unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::CommandBufferAllocateInfo<'_>,
    buffers: *mut vk::CommandBuffer,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(device);
        let result = (emulator.v1_0().allocate_command_buffers)(device, info, buffers);
        if result == vk::Result::SUCCESS {
            let new = slice(buffers.cast_const(), (*info).command_buffer_count);
            emulator.state().pools.entry((*info).command_pool).or_default().extend(new);
        }
        result
    }
}

/// # Safety
/// As `vkFreeCommandBuffers`.
pub(super) unsafe extern "system" fn free(
    device: vk::Device,
    pool: vk::CommandPool,
    count: u32,
    buffers: *const vk::CommandBuffer,
) {
    // SAFETY: the application's valid arguments; the buffers are not pending.
    unsafe {
        let emulator = emulator(device);
        let freed = slice(buffers, count);
        let mut state = emulator.state();
        for &buffer in freed {
            forget(&emulator, &mut state, buffer);
        }
        if let Some(left) = state.pools.get_mut(&pool) {
            left.retain(|buffer| !freed.contains(buffer));
        }
        (emulator.v1_0().free_command_buffers)(device, pool, count, buffers);
    }
}

/// # Safety
/// As `vkDestroyCommandPool`.
pub(super) unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the application's valid arguments; none of the pool's buffers is pending.
    unsafe {
        let emulator = emulator(device);
        let mut state = emulator.state();
        for buffer in state.pools.remove(&pool).unwrap_or_default() {
            forget(&emulator, &mut state, buffer);
        }
        (emulator.v1_0().destroy_command_pool)(device, pool, allocator);
    }
}

/// # Safety
/// As `vkResetCommandPool`.
pub(super) unsafe extern "system" fn reset_pool(
    device: vk::Device,
    pool: vk::CommandPool,
    flags: vk::CommandPoolResetFlags,
) -> vk::Result {
    // SAFETY: the application's valid arguments; none of the pool's buffers is pending.
    unsafe {
        let emulator = emulator(device);
        let mut state = emulator.state();
        for buffer in state.pools.get(&pool).cloned().unwrap_or_default() {
            forget(&emulator, &mut state, buffer);
        }
        (emulator.v1_0().reset_command_pool)(device, pool, flags)
    }
}

/// # Safety
/// As `vkResetCommandBuffer`.
pub(super) unsafe extern "system" fn reset(
    buffer: vk::CommandBuffer,
    flags: vk::CommandBufferResetFlags,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the buffer is not pending.
    unsafe {
        let emulator = emulator(buffer);
        forget(&emulator, &mut emulator.state(), buffer);
        (emulator.v1_0().reset_command_buffer)(buffer, flags)
    }
}

/// Returns a buffer's captures, once its last submit was read.
///
/// # Safety
///
/// The buffer is not pending.
unsafe fn forget(emulator: &super::Emulator, state: &mut State, buffer: vk::CommandBuffer) {
    // SAFETY: the caller vouches for the buffer: nothing writes its captures any more.
    unsafe { submit::read_submits_of(emulator, state, buffer) };
    for pass in state.recordings.remove(&buffer).into_iter().flat_map(|recording| recording.passes) {
        if let Some((capture, _)) = pass.capture {
            state.captures.give_back(capture);
        }
    }
}

/// # Safety
/// As `vkBeginCommandBuffer`.
pub(super) unsafe extern "system" fn begin(
    buffer: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the buffer is not pending. Only a secondary buffer that continues
    // a pass has inheritance information that is sure to be valid.
    unsafe {
        let emulator = emulator(buffer);
        let mut state = emulator.state();
        forget(&emulator, &mut state, buffer);
        let continues = (*info).flags.contains(vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE);
        let inherited = (*info).p_inheritance_info.as_ref().filter(|_| continues);
        let current = inherited.map(|inherited| match state.render_passes.get(&inherited.render_pass) {
            Some(render_pass) => Current::RenderPass {
                render_pass: render_pass.clone(),
                subpass: inherited.subpass as usize,
                passes: Vec::new(),
            },
            None => Current::Rendering { pass: None, attachment: None },
        });
        state.recordings.insert(buffer, Recording { current, ..Recording::default() });
        (emulator.v1_0().begin_command_buffer)(buffer, info)
    }
}

/// # Safety
/// As `vkCmdExecuteCommands`.
pub(super) unsafe extern "system" fn execute(
    primary: vk::CommandBuffer,
    count: u32,
    secondaries: *const vk::CommandBuffer,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let emulator = emulator(primary);
        let mut state = emulator.state();
        let state = &mut *state;
        for secondary in slice(secondaries, count) {
            let continued = state.recordings.get(secondary).map(|recording| recording.continued);
            if let (Some(recording), Some(continued)) = (state.recordings.get_mut(&primary), continued) {
                recording.events.push(Event::Execute(*secondary));
                recording.execute(&mut state.findings, primary, continued);
            }
        }
        (emulator.v1_0().cmd_execute_commands)(primary, count, secondaries);
    }
}
