//! A layer that plants the GPU time of frames: it answers timestamp queries like a GPU with a chosen cost of the scene and a
//! chosen gain of masks.
//!
//! The device reports that it is a discrete GPU, and runs nothing: command buffers are recorded and checked as ever, submits signal their fences
//! and semaphores, and no time goes to a rasterizer on a CPU. An hour of frames so passes in minutes. A command buffer costs something if it has
//! render passes with depth; the layer's own have none. It gains if a depth template is copied in it.

mod normal;

use crate::functions::functions;
use crate::layer::{Layer, NextDevice, Tracked, device_of, hooks, instance_of, made_as_asked};
use crate::{report, variable};
use ash::vk;
use normal::Normal;
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};
use std::ffi::{CStr, c_void};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The variable with the planted costs, a [`PlantedCosts`] as JSON.
pub const COSTS_VARIABLE: &str = "PARAFOVEA_TEST_COSTS";

/// The variable with the file to which each device appends a line, a [`CostsReport`] as JSON, when it is destroyed.
pub const COSTS_FILE_VARIABLE: &str = "PARAFOVEA_TEST_COSTS_FILE";

/// Costs of frames.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct PlantedCosts {
    /// GPU time of a frame without masks, nanoseconds.
    pub base_ns: f64,
    /// Share of it that masks save; negative: they cost.
    pub gain: f64,
    /// Standard deviation of each frame's time, as a share of it.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// The frames of one device.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct CostsReport {
    /// Number of command buffers that cost something.
    pub frames: u64,
    /// Numbers, from 0, of the frames at which masks start or stop; before the first frame there are none.
    pub changes: Vec<u64>,
    /// Number of answered queries.
    pub answers: u64,
}

functions! {
    /// The next layer's functions that it may lack.
    Functions {
        queue_submit2: PFN_vkQueueSubmit2 = c"vkQueueSubmit2" | c"vkQueueSubmit2KHR";
    }
}

pub(crate) struct Costs {
    next: NextDevice,
    functions: Functions,
    state: Mutex<State>,
}

/// A frame's command buffer as recorded.
#[derive(Default)]
struct Recorded {
    /// Timestamps in their order.
    stamps: Vec<(vk::QueryPool, u32)>,
    has_depth: bool,
    is_masked: bool,
}

struct State {
    planted: Option<PlantedCosts>,
    noise: Normal,
    /// The GPU's clock, nanoseconds.
    now_ns: u64,
    with_depth: HashSet<vk::RenderPass>,
    recorded: HashMap<vk::CommandBuffer, Recorded>,
    stamps: HashMap<(vk::QueryPool, u32), u64>,
    was_masked: bool,
    report: CostsReport,
}

static TRACKED: Tracked<Costs> = Tracked::new();

impl Costs {
    fn over(next: NextDevice) -> Self {
        let planted = variable::read(COSTS_VARIABLE, |text| serde_json::from_str::<PlantedCosts>(text));
        // SAFETY: the names give the functions' types.
        let functions = unsafe { Functions::load(|name| next.function(name)) };
        let state = State {
            planted,
            noise: Normal::new(planted.map_or(0, |planted| planted.seed)),
            now_ns: 0,
            with_depth: HashSet::new(),
            recorded: HashMap::new(),
            stamps: HashMap::new(),
            was_masked: false,
            report: CostsReport::default(),
        };
        Self { next, functions, state: Mutex::new(state) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Runs a command buffer: its timestamps are written.
    fn run(&mut self, commands: vk::CommandBuffer) {
        let Some(recorded) = self.recorded.get(&commands) else { return };
        let cost_ns = if recorded.has_depth {
            if recorded.is_masked != self.was_masked {
                self.was_masked = recorded.is_masked;
                self.report.changes.push(self.report.frames);
            }
            self.report.frames += 1;
            let planted = self.planted;
            planted.map_or(0.0, |PlantedCosts { base_ns, gain, noise, .. }| {
                let factor = if recorded.is_masked { 1.0 - gain } else { 1.0 };
                base_ns * factor * (1.0 + noise * self.noise.next()).max(0.05)
            })
        } else {
            0.0
        };
        // The first is later than all before, and the last later by the cost.
        self.now_ns += 1;
        let begin_ns = self.now_ns;
        let count = recorded.stamps.len();
        for (index, stamp) in recorded.stamps.iter().enumerate() {
            let is_last = index > 0 && index + 1 == count;
            let time_ns = if is_last { begin_ns + cost_ns as u64 } else { begin_ns };
            self.stamps.insert(*stamp, time_ns);
        }
        self.now_ns += cost_ns as u64;
    }
}

impl Layer for Costs {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    made_as_asked!();

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkGetPhysicalDeviceProperties": PFN_vkGetPhysicalDeviceProperties = properties;
            c"vkGetPhysicalDeviceProperties2": PFN_vkGetPhysicalDeviceProperties2 = properties2;
            c"vkGetPhysicalDeviceProperties2KHR": PFN_vkGetPhysicalDeviceProperties2 = properties2;
            c"vkCreateRenderPass": PFN_vkCreateRenderPass = create_render_pass;
            c"vkBeginCommandBuffer": PFN_vkBeginCommandBuffer = begin;
            c"vkCmdBeginRenderPass": PFN_vkCmdBeginRenderPass = begin_render_pass;
            c"vkCmdCopyBufferToImage": PFN_vkCmdCopyBufferToImage = copy_to_image;
            c"vkCmdWriteTimestamp": PFN_vkCmdWriteTimestamp = write_timestamp;
            c"vkGetQueryPoolResults": PFN_vkGetQueryPoolResults = results;
            c"vkQueueSubmit": PFN_vkQueueSubmit = submit;
            c"vkQueueSubmit2": PFN_vkQueueSubmit2 = submit2;
            c"vkQueueSubmit2KHR": PFN_vkQueueSubmit2 = submit2;
        }
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }

    fn device_destroyed(&self) {
        report::append(COSTS_FILE_VARIABLE, &self.state().report);
    }
}

/// # Safety
///
/// `first` points to that many valid structures, or there are none.
unsafe fn slice<'a, T>(first: *const T, count: u32) -> &'a [T] {
    if count == 0 {
        return &[];
    }
    // SAFETY: the caller vouches for it.
    unsafe { std::slice::from_raw_parts(first, count as usize) }
}

/// # Safety
/// As `vkGetPhysicalDeviceProperties`.
unsafe extern "system" fn properties(
    physical_device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let next = instance_of::<Costs>(physical_device).and_then(|known| known.physical_device.properties);
        let Some(next) = next else { return };
        next(physical_device, properties);
        (*properties).device_type = vk::PhysicalDeviceType::DISCRETE_GPU;
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceProperties2`.
unsafe extern "system" fn properties2(
    physical_device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties2<'_>,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let next = instance_of::<Costs>(physical_device).and_then(|known| known.physical_device.properties2);
        let Some(next) = next else { return };
        next(physical_device, properties);
        (*properties).properties.device_type = vk::PhysicalDeviceType::DISCRETE_GPU;
    }
}

/// # Safety
/// As `vkCreateRenderPass`.
unsafe extern "system" fn create_render_pass(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    render_pass: *mut vk::RenderPass,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<Costs>(device) else { return vk::Result::ERROR_DEVICE_LOST };
        let create = layer.next.functions.fp_v1_0().create_render_pass;
        let result = create(device, info, allocator, render_pass);
        let subpasses = slice((*info).p_subpasses, (*info).subpass_count);
        let mut depths = subpasses.iter().filter_map(|subpass| subpass.p_depth_stencil_attachment.as_ref());
        if result == vk::Result::SUCCESS && depths.any(|depth| depth.attachment != vk::ATTACHMENT_UNUSED) {
            layer.state().with_depth.insert(*render_pass);
        }
        result
    }
}

/// # Safety
/// As `vkBeginCommandBuffer`.
unsafe extern "system" fn begin(
    commands: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<Costs>(commands) else { return vk::Result::ERROR_DEVICE_LOST };
        layer.state().recorded.insert(commands, Recorded::default());
        (layer.next.functions.fp_v1_0().begin_command_buffer)(commands, info)
    }
}

/// # Safety
/// As `vkCmdBeginRenderPass`.
unsafe extern "system" fn begin_render_pass(
    commands: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'_>,
    contents: vk::SubpassContents,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<Costs>(commands) else { return };
        let mut state = layer.state();
        let has_depth = state.with_depth.contains(&(*info).render_pass);
        state.recorded.entry(commands).or_default().has_depth |= has_depth;
        drop(state);
        (layer.next.functions.fp_v1_0().cmd_begin_render_pass)(commands, info, contents);
    }
}

/// # Safety
/// As `vkCmdCopyBufferToImage`.
unsafe extern "system" fn copy_to_image(
    commands: vk::CommandBuffer,
    from: vk::Buffer,
    to: vk::Image,
    layout: vk::ImageLayout,
    count: u32,
    regions: *const vk::BufferImageCopy,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<Costs>(commands) else { return };
        let is_depth = |region: &vk::BufferImageCopy| {
            region.image_subresource.aspect_mask.contains(vk::ImageAspectFlags::DEPTH)
        };
        let is_masked = slice(regions, count).iter().any(is_depth);
        layer.state().recorded.entry(commands).or_default().is_masked |= is_masked;
        let next = layer.next.functions.fp_v1_0().cmd_copy_buffer_to_image;
        next(commands, from, to, layout, count, regions);
    }
}

/// # Safety
/// As `vkCmdWriteTimestamp`.
unsafe extern "system" fn write_timestamp(
    commands: vk::CommandBuffer,
    stage: vk::PipelineStageFlags,
    pool: vk::QueryPool,
    query: u32,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(layer) = device_of::<Costs>(commands) else { return };
        layer.state().recorded.entry(commands).or_default().stamps.push((pool, query));
        (layer.next.functions.fp_v1_0().cmd_write_timestamp)(commands, stage, pool, query);
    }
}

/// # Safety
/// As `vkGetQueryPoolResults`, of timestamps as 64 bits without more.
unsafe extern "system" fn results(
    device: vk::Device,
    pool: vk::QueryPool,
    first: u32,
    count: u32,
    size: usize,
    data: *mut c_void,
    stride: vk::DeviceSize,
    flags: vk::QueryResultFlags,
) -> vk::Result {
    assert_eq!(flags, vk::QueryResultFlags::TYPE_64, "other results are not planted");
    // SAFETY: the caller has room for so many results of 64 bits, each so many bytes after the one before.
    unsafe {
        let Some(layer) = device_of::<Costs>(device) else { return vk::Result::ERROR_DEVICE_LOST };
        let mut state = layer.state();
        for index in 0..count {
            let Some(time_ns) = state.stamps.get(&(pool, first + index)).copied() else {
                return vk::Result::NOT_READY;
            };
            let at = index as usize * stride as usize;
            assert!(at + size_of::<u64>() <= size, "no room for a result");
            data.cast::<u8>().add(at).cast::<u64>().write_unaligned(time_ns);
        }
        state.report.answers += 1;
        vk::Result::SUCCESS
    }
}

/// # Safety
/// As `vkQueueSubmit`.
unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments, without command buffers.
    unsafe {
        let Some(layer) = device_of::<Costs>(queue) else { return vk::Result::ERROR_DEVICE_LOST };
        let mut empty = slice(submits, count).to_vec();
        let mut state = layer.state();
        for submit in &mut empty {
            for commands in slice(submit.p_command_buffers, submit.command_buffer_count) {
                state.run(*commands);
            }
            submit.command_buffer_count = 0;
        }
        drop(state);
        (layer.next.functions.fp_v1_0().queue_submit)(queue, count, empty.as_ptr(), fence)
    }
}

/// # Safety
/// As `vkQueueSubmit2`.
unsafe extern "system" fn submit2(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    // SAFETY: the application's valid arguments, without command buffers.
    unsafe {
        let Some(layer) = device_of::<Costs>(queue) else { return vk::Result::ERROR_DEVICE_LOST };
        let Some(next) = layer.functions.queue_submit2 else { return vk::Result::ERROR_DEVICE_LOST };
        let mut empty = slice(submits, count).to_vec();
        let mut state = layer.state();
        for submit in &mut empty {
            for info in slice(submit.p_command_buffer_infos, submit.command_buffer_info_count) {
                state.run(info.command_buffer);
            }
            submit.command_buffer_info_count = 0;
        }
        drop(state);
        next(queue, count, empty.as_ptr(), fence)
    }
}
