//! Barriers, events and timestamps: the extension's stages, accesses and layouts are replaced, and checked.

use super::chain::slice;
use super::findings::Findings;
use super::image::Range;
use super::lower::{self, RATE_LAYOUT, RATE_READ, RATE_STAGE};
use super::replay::{Event, Masks, reaches_rate_stage};
use super::state::State;
use super::{Emulator, emulator};
use ash::vk;

const KIND: &str = "command";

/// The rate stage needs the feature. `id` is without `VUID-`.
pub(super) fn check_stages(
    emulator: &Emulator,
    findings: &mut Findings,
    stages: vk::PipelineStageFlags2,
    id: &str,
    object: impl vk::Handle,
) {
    let holds = emulator.enabled.attachment || !stages.contains(RATE_STAGE);
    findings.require(holds, KIND, &format!("VUID-{id}"), object, || {
        "the rate stage without attachmentFragmentShadingRate".to_owned()
    });
}

fn wide(stages: vk::PipelineStageFlags) -> vk::PipelineStageFlags2 {
    vk::PipelineStageFlags2::from_raw(stages.as_raw().into())
}

fn wide_access(access: vk::AccessFlags) -> vk::AccessFlags2 {
    vk::AccessFlags2::from_raw(access.as_raw().into())
}

/// The IDs of the rules for barriers of one call, without `VUID-`.
struct Ids {
    src_stage: &'static str,
    dst_stage: &'static str,
    /// An access without its stage, or the layer's own name for it.
    src_access: &'static str,
    dst_access: &'static str,
    layout: &'static str,
}

const FIRST: Ids = Ids {
    src_stage: "vkCmdPipelineBarrier-srcStageMask-07318",
    dst_stage: "vkCmdPipelineBarrier-dstStageMask-07318",
    src_access: "VUID-vkCmdPipelineBarrier-srcAccessMask-02815",
    dst_access: "VUID-vkCmdPipelineBarrier-dstAccessMask-02816",
    layout: "VUID-VkImageMemoryBarrier-oldLayout-02088",
};
const SECOND: Ids = Ids {
    src_stage: "VkImageMemoryBarrier2-srcStageMask-07316",
    dst_stage: "VkImageMemoryBarrier2-dstStageMask-07316",
    src_access: "rate access has its stage",
    dst_access: "rate access has its stage",
    layout: "VUID-VkImageMemoryBarrier2-oldLayout-02088",
};

fn check_masks(
    emulator: &Emulator,
    findings: &mut Findings,
    masks: Masks,
    ids: &Ids,
    buffer: vk::CommandBuffer,
) {
    check_stages(emulator, findings, masks.src.0, ids.src_stage, buffer);
    check_stages(emulator, findings, masks.dst.0, ids.dst_stage, buffer);
    for ((stages, access), rule) in [(masks.src, ids.src_access), (masks.dst, ids.dst_access)] {
        let holds = !access.contains(RATE_READ) || reaches_rate_stage(stages, RATE_READ);
        findings.require(holds, KIND, rule, buffer, || format!("the rate access at {stages:?}"));
    }
}

/// Checks a barrier on an image, and notes it if it is a rate image.
fn image_barrier(
    state: &mut State,
    buffer: vk::CommandBuffer,
    (image, range): (vk::Image, &vk::ImageSubresourceRange),
    layouts: [vk::ImageLayout; 2],
    masks: Masks,
    ids: &Ids,
) {
    let Some(known) = state.images.get(&image) else { return };
    let holds = known.is_rate() || !layouts.contains(&RATE_LAYOUT);
    state.findings.require(holds, KIND, ids.layout, image, || {
        format!("{layouts:?} of an image with {:?}", known.usage)
    });
    if known.is_rate() {
        let image = Some((image, Range::of(range, known), layouts));
        note(state, buffer, Event::Barrier { image, masks });
    }
}

pub(super) fn note(state: &mut State, buffer: vk::CommandBuffer, event: Event) {
    if let Some(recording) = state.recordings.get_mut(&buffer) {
        recording.events.push(event);
    }
}

/// The barriers of a call, with the stages of the call, and as the next layer gets them.
struct Barriers<'a> {
    memory: Vec<vk::MemoryBarrier<'a>>,
    images: Vec<vk::ImageMemoryBarrier<'a>>,
}

impl<'a> Barriers<'a> {
    fn lower(
        emulator: &Emulator,
        buffer: vk::CommandBuffer,
        (src, dst): (vk::PipelineStageFlags, vk::PipelineStageFlags),
        memory: &[vk::MemoryBarrier<'a>],
        images: &[vk::ImageMemoryBarrier<'a>],
    ) -> Self {
        let mut state = emulator.state();
        let state = &mut *state;
        let masks = |src_access, dst_access| Masks {
            src: (wide(src), wide_access(src_access)),
            dst: (wide(dst), wide_access(dst_access)),
        };
        check_masks(
            emulator,
            &mut state.findings,
            masks(Default::default(), Default::default()),
            &FIRST,
            buffer,
        );
        let (mut memory, mut images) = (memory.to_vec(), images.to_vec());
        for barrier in &mut memory {
            let masks = masks(barrier.src_access_mask, barrier.dst_access_mask);
            check_masks(emulator, &mut state.findings, masks, &FIRST, buffer);
            note(state, buffer, Event::Barrier { image: None, masks });
            barrier.src_access_mask = lower::access(barrier.src_access_mask);
            barrier.dst_access_mask = lower::access(barrier.dst_access_mask);
        }
        for barrier in &mut images {
            let masks = masks(barrier.src_access_mask, barrier.dst_access_mask);
            check_masks(emulator, &mut state.findings, masks, &FIRST, buffer);
            let layouts = [barrier.old_layout, barrier.new_layout];
            let what = (barrier.image, &barrier.subresource_range);
            image_barrier(state, buffer, what, layouts, masks, &FIRST);
            barrier.src_access_mask = lower::access(barrier.src_access_mask);
            barrier.dst_access_mask = lower::access(barrier.dst_access_mask);
            [barrier.old_layout, barrier.new_layout] = layouts.map(lower::layout);
        }
        Self { memory, images }
    }
}

/// # Safety
/// As `vkCmdPipelineBarrier`.
pub(super) unsafe extern "system" fn pipeline_barrier(
    buffer: vk::CommandBuffer,
    src: vk::PipelineStageFlags,
    dst: vk::PipelineStageFlags,
    flags: vk::DependencyFlags,
    memory_count: u32,
    memory: *const vk::MemoryBarrier<'_>,
    buffer_count: u32,
    buffers: *const vk::BufferMemoryBarrier<'_>,
    image_count: u32,
    images: *const vk::ImageMemoryBarrier<'_>,
) {
    // SAFETY: the application's valid arguments, with other masks and layouts.
    unsafe {
        let emulator = emulator(buffer);
        let (memory, images) = (slice(memory, memory_count), slice(images, image_count));
        let lowered = Barriers::lower(&emulator, buffer, (src, dst), memory, images);
        (emulator.v1_0().cmd_pipeline_barrier)(
            buffer,
            lower::stages(src),
            lower::stages(dst),
            flags,
            memory_count,
            lowered.memory.as_ptr(),
            buffer_count,
            buffers,
            image_count,
            lowered.images.as_ptr(),
        );
    }
}

/// # Safety
/// As `vkCmdWaitEvents`.
pub(super) unsafe extern "system" fn wait_events(
    buffer: vk::CommandBuffer,
    count: u32,
    events: *const vk::Event,
    src: vk::PipelineStageFlags,
    dst: vk::PipelineStageFlags,
    memory_count: u32,
    memory: *const vk::MemoryBarrier<'_>,
    buffer_count: u32,
    buffers: *const vk::BufferMemoryBarrier<'_>,
    image_count: u32,
    images: *const vk::ImageMemoryBarrier<'_>,
) {
    // SAFETY: the application's valid arguments, with other masks and layouts.
    unsafe {
        let emulator = emulator(buffer);
        let (memory, images) = (slice(memory, memory_count), slice(images, image_count));
        let lowered = Barriers::lower(&emulator, buffer, (src, dst), memory, images);
        (emulator.v1_0().cmd_wait_events)(
            buffer,
            count,
            events,
            lower::stages(src),
            lower::stages(dst),
            memory_count,
            lowered.memory.as_ptr(),
            buffer_count,
            buffers,
            image_count,
            lowered.images.as_ptr(),
        );
    }
}

/// # Safety
/// As `vkCmdSetEvent`.
pub(super) unsafe extern "system" fn set_event(
    buffer: vk::CommandBuffer,
    event: vk::Event,
    stages: vk::PipelineStageFlags,
) {
    // SAFETY: the application's valid arguments, with another mask.
    unsafe { (emulator(buffer).v1_0().cmd_set_event)(buffer, event, lower::stages(stages)) }
}

/// # Safety
/// As `vkCmdResetEvent`.
pub(super) unsafe extern "system" fn reset_event(
    buffer: vk::CommandBuffer,
    event: vk::Event,
    stages: vk::PipelineStageFlags,
) {
    // SAFETY: the application's valid arguments, with another mask.
    unsafe { (emulator(buffer).v1_0().cmd_reset_event)(buffer, event, lower::stages(stages)) }
}

/// # Safety
/// As `vkCmdWriteTimestamp`.
pub(super) unsafe extern "system" fn write_timestamp(
    buffer: vk::CommandBuffer,
    stage: vk::PipelineStageFlags,
    pool: vk::QueryPool,
    query: u32,
) {
    // SAFETY: the application's valid arguments, with another stage.
    unsafe { (emulator(buffer).v1_0().cmd_write_timestamp)(buffer, lower::stages(stage), pool, query) }
}

/// The barriers of a VkDependencyInfo, as the next layer gets them.
struct Dependency<'a> {
    info: vk::DependencyInfo<'a>,
    memory: Vec<vk::MemoryBarrier2<'a>>,
    buffers: Vec<vk::BufferMemoryBarrier2<'a>>,
    images: Vec<vk::ImageMemoryBarrier2<'a>>,
}

macro_rules! lower_masks {
    ($barriers:expr) => {
        for barrier in $barriers {
            barrier.src_stage_mask = lower::stages2(barrier.src_stage_mask);
            barrier.dst_stage_mask = lower::stages2(barrier.dst_stage_mask);
            barrier.src_access_mask = lower::access2(barrier.src_access_mask);
            barrier.dst_access_mask = lower::access2(barrier.dst_access_mask);
        }
    };
}

macro_rules! masks_of {
    ($barrier:expr) => {
        Masks {
            src: ($barrier.src_stage_mask, $barrier.src_access_mask),
            dst: ($barrier.dst_stage_mask, $barrier.dst_access_mask),
        }
    };
}

impl<'a> Dependency<'a> {
    /// # Safety
    ///
    /// `info` and everything it points to are valid.
    unsafe fn lower(
        emulator: &Emulator,
        buffer: vk::CommandBuffer,
        info: &vk::DependencyInfo<'a>,
        noted: bool,
    ) -> Self {
        // SAFETY: the caller vouches for it.
        let (mut memory, mut buffers, mut images) = unsafe {
            (
                slice(info.p_memory_barriers, info.memory_barrier_count).to_vec(),
                slice(info.p_buffer_memory_barriers, info.buffer_memory_barrier_count).to_vec(),
                slice(info.p_image_memory_barriers, info.image_memory_barrier_count).to_vec(),
            )
        };
        let mut state = emulator.state();
        let state = &mut *state;
        for barrier in &memory {
            let masks = masks_of!(barrier);
            check_masks(emulator, &mut state.findings, masks, &SECOND, buffer);
            if noted {
                note(state, buffer, Event::Barrier { image: None, masks });
            }
        }
        for barrier in &buffers {
            check_masks(emulator, &mut state.findings, masks_of!(barrier), &SECOND, buffer);
        }
        for barrier in &mut images {
            let masks = masks_of!(barrier);
            check_masks(emulator, &mut state.findings, masks, &SECOND, buffer);
            let layouts = [barrier.old_layout, barrier.new_layout];
            if noted {
                let what = (barrier.image, &barrier.subresource_range);
                image_barrier(state, buffer, what, layouts, masks, &SECOND);
            }
            [barrier.old_layout, barrier.new_layout] = layouts.map(lower::layout);
        }
        lower_masks!(&mut memory);
        lower_masks!(&mut buffers);
        lower_masks!(&mut images);
        Self { info: *info, memory, buffers, images }
    }

    fn info(&self) -> vk::DependencyInfo<'a> {
        vk::DependencyInfo {
            p_memory_barriers: self.memory.as_ptr(),
            p_buffer_memory_barriers: self.buffers.as_ptr(),
            p_image_memory_barriers: self.images.as_ptr(),
            ..self.info
        }
    }
}

/// # Safety
/// As `vkCmdPipelineBarrier2`.
pub(super) unsafe extern "system" fn pipeline_barrier2(
    buffer: vk::CommandBuffer,
    info: *const vk::DependencyInfo<'_>,
) {
    // SAFETY: the application's valid arguments, with other masks and layouts.
    unsafe {
        let emulator = emulator(buffer);
        let Some(next) = emulator.functions.pipeline_barrier2 else { return };
        let lowered = Dependency::lower(&emulator, buffer, &*info, true);
        next(buffer, &lowered.info());
    }
}

/// # Safety
/// As `vkCmdSetEvent2`.
pub(super) unsafe extern "system" fn set_event2(
    buffer: vk::CommandBuffer,
    event: vk::Event,
    info: *const vk::DependencyInfo<'_>,
) {
    // SAFETY: the application's valid arguments, with other masks and layouts.
    unsafe {
        let emulator = emulator(buffer);
        let Some(next) = emulator.functions.set_event2 else { return };
        let lowered = Dependency::lower(&emulator, buffer, &*info, false);
        next(buffer, event, &lowered.info());
    }
}

/// # Safety
/// As `vkCmdWaitEvents2`.
pub(super) unsafe extern "system" fn wait_events2(
    buffer: vk::CommandBuffer,
    count: u32,
    events: *const vk::Event,
    infos: *const vk::DependencyInfo<'_>,
) {
    // SAFETY: the application's valid arguments, with other masks and layouts.
    unsafe {
        let emulator = emulator(buffer);
        let Some(next) = emulator.functions.wait_events2 else { return };
        let lowered: Vec<_> =
            slice(infos, count).iter().map(|info| Dependency::lower(&emulator, buffer, info, true)).collect();
        let infos: Vec<_> = lowered.iter().map(Dependency::info).collect();
        next(buffer, count, events, infos.as_ptr());
    }
}

/// # Safety
/// As `vkCmdResetEvent2`.
pub(super) unsafe extern "system" fn reset_event2(
    buffer: vk::CommandBuffer,
    event: vk::Event,
    stages: vk::PipelineStageFlags2,
) {
    // SAFETY: the application's valid arguments, with another mask.
    unsafe {
        let Some(next) = emulator(buffer).functions.reset_event2 else { return };
        next(buffer, event, lower::stages2(stages));
    }
}

/// # Safety
/// As `vkCmdWriteTimestamp2`.
pub(super) unsafe extern "system" fn write_timestamp2(
    buffer: vk::CommandBuffer,
    stage: vk::PipelineStageFlags2,
    pool: vk::QueryPool,
    query: u32,
) {
    // SAFETY: the application's valid arguments, with another stage.
    unsafe {
        let Some(next) = emulator(buffer).functions.write_timestamp2 else { return };
        next(buffer, lower::stages2(stage), pool, query);
    }
}
