//! A layer that leaves out chosen image barriers: it plants the bug that a test is to notice.

mod pattern;

use crate::layer::{Layer, NextDevice, Tracked, device_of, hooks, made_as_asked};
use crate::{report, variable};
use ash::vk;
use pattern::Pattern;
use serde::{Deserialize, Serialize};
use std::ffi::CStr;
use std::sync::atomic::{AtomicU64, Ordering};

/// The variable with the barriers to drop: `old_layout,new_layout,src_stage,dst_stage`, the values of the Vulkan
/// enumerations and masks, decimal or with `0x`. A barrier that has exactly these is dropped.
pub const DROP_BARRIER_VARIABLE: &str = "PARAFOVEA_TEST_DROP_BARRIER";

/// The variable with the file to which each device appends a line, a [`Dropped`] as JSON, when it is destroyed.
pub const DROP_FILE_VARIABLE: &str = "PARAFOVEA_TEST_DROP_FILE";

/// Dropped barriers of one device.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Dropped {
    /// Image barriers left out, at the time of recording.
    pub dropped: u64,
}

pub(crate) struct DropBarrier {
    next: NextDevice,
    pattern: Option<Pattern>,
    pipeline_barrier2: Option<vk::PFN_vkCmdPipelineBarrier2>,
    dropped: AtomicU64,
}

static TRACKED: Tracked<DropBarrier> = Tracked::new();

impl DropBarrier {
    fn over(next: NextDevice) -> Self {
        let function =
            next.function(c"vkCmdPipelineBarrier2").or_else(|| next.function(c"vkCmdPipelineBarrier2KHR"));
        // SAFETY: both names have this type.
        let pipeline_barrier2 = unsafe {
            std::mem::transmute::<vk::PFN_vkVoidFunction, Option<vk::PFN_vkCmdPipelineBarrier2>>(function)
        };
        let pattern = variable::read(DROP_BARRIER_VARIABLE, str::parse);
        Self { next, pattern, pipeline_barrier2, dropped: AtomicU64::new(0) }
    }
}

impl Layer for DropBarrier {
    fn tracked() -> &'static Tracked<Self> {
        &TRACKED
    }

    made_as_asked!();

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        hooks! { name;
            c"vkCmdPipelineBarrier": PFN_vkCmdPipelineBarrier = pipeline_barrier;
            c"vkCmdPipelineBarrier2": PFN_vkCmdPipelineBarrier2 = pipeline_barrier2;
            c"vkCmdPipelineBarrier2KHR": PFN_vkCmdPipelineBarrier2 = pipeline_barrier2;
        }
        None
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }

    fn device_destroyed(&self) {
        report::append(DROP_FILE_VARIABLE, &Dropped { dropped: self.dropped.load(Ordering::Relaxed) });
    }
}

impl DropBarrier {
    /// The barriers that do not match.
    fn keep<T: Copy>(&self, barriers: &[T], matches: impl Fn(&Pattern, &T) -> bool) -> Vec<T> {
        let drops = |barrier: &&T| !self.pattern.as_ref().is_some_and(|pattern| matches(pattern, barrier));
        let kept: Vec<T> = barriers.iter().filter(drops).copied().collect();
        self.dropped.fetch_add((barriers.len() - kept.len()) as u64, Ordering::Relaxed);
        kept
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
/// As `vkCmdPipelineBarrier`.
unsafe extern "system" fn pipeline_barrier(
    buffer: vk::CommandBuffer,
    src_stage: vk::PipelineStageFlags,
    dst_stage: vk::PipelineStageFlags,
    flags: vk::DependencyFlags,
    memory_count: u32,
    memory: *const vk::MemoryBarrier<'_>,
    buffer_count: u32,
    buffers: *const vk::BufferMemoryBarrier<'_>,
    image_count: u32,
    images: *const vk::ImageMemoryBarrier<'_>,
) {
    // SAFETY: the application's own arguments, with fewer image barriers.
    unsafe {
        let Some(device) = device_of::<DropBarrier>(buffer) else { return };
        let stages = (u64::from(src_stage.as_raw()), u64::from(dst_stage.as_raw()));
        let kept = device.keep(slice(images, image_count), |pattern, barrier| {
            pattern.matches(barrier.old_layout, barrier.new_layout, stages.0, stages.1)
        });
        // A call that never had any barrier is an execution dependency, and stays.
        let emptied = kept.is_empty() && image_count != 0 && memory_count == 0 && buffer_count == 0;
        if !emptied {
            (device.next.functions.fp_v1_0().cmd_pipeline_barrier)(
                buffer,
                src_stage,
                dst_stage,
                flags,
                memory_count,
                memory,
                buffer_count,
                buffers,
                kept.len() as u32,
                kept.as_ptr(),
            );
        }
    }
}

/// # Safety
/// As `vkCmdPipelineBarrier2`.
unsafe extern "system" fn pipeline_barrier2(
    buffer: vk::CommandBuffer,
    dependency: *const vk::DependencyInfo<'_>,
) {
    // SAFETY: the application's own arguments, with fewer image barriers.
    unsafe {
        let Some(device) = device_of::<DropBarrier>(buffer) else { return };
        let Some(next) = device.pipeline_barrier2 else { return };
        let mut info = *dependency;
        let all = slice(info.p_image_memory_barriers, info.image_memory_barrier_count);
        let kept = device.keep(all, |pattern, barrier| {
            let (src, dst) = (barrier.src_stage_mask.as_raw(), barrier.dst_stage_mask.as_raw());
            pattern.matches(barrier.old_layout, barrier.new_layout, src, dst)
        });
        let others = info.memory_barrier_count + info.buffer_memory_barrier_count;
        let emptied = kept.is_empty() && !all.is_empty() && others == 0;
        if !emptied {
            info.image_memory_barrier_count = kept.len() as u32;
            info.p_image_memory_barriers = kept.as_ptr();
            next(buffer, &info);
        }
    }
}
