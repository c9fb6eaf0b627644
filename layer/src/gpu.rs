//! Vulkan objects of ours on the application's device, and the recording and submitting of our work.
//!
//! All calls go to the *next* layer's functions. The types here are safe to use from [`crate::kernels`]: an object lives until it is
//! dropped, and an owner of objects that command buffers use also owns a `Uses`, dropped before them, which waits for the last of those
//! command buffers.

mod app_commands;
pub mod barrier;
mod budget;
mod buffer;
mod commands;
mod compare;
mod compiler;
mod compute;
mod depth_target;
mod descriptor;
mod device_buffer;
mod draw;
mod early_return;
mod error;
mod framebuffer;
pub(crate) mod functions;
mod image;
pub(crate) mod memory;
mod owned;
mod pipeline;
mod pipeline_layout;
mod recorder;
mod recordings;
mod sample_draw;
mod shared;
mod slots;
mod submit_times;
mod support;

pub use app_commands::{AppCommands, ImagePart, Scope};
pub(crate) use app_commands::{COMPUTES, READS_OF_RESULTS};
pub(crate) use buffer::{IndirectRing, IndirectSize, ResultRing, UniformRing, WordRing};
pub(crate) use commands::{Uses, wait_device, wait_fence};
pub(crate) use compare::Comparison;
pub(crate) use compiler::{Compilation, Compiler, Later};
pub(crate) use compute::{Bound, ComputeLayout, ComputeSet};
pub(crate) use depth_target::{DepthTarget, DepthTargetDescription};
pub(crate) use descriptor::{CompareSet, ListSet, TextureSets, UniformSet};
pub(crate) use device_buffer::DeviceBuffer;
pub(crate) use draw::{ColorTarget, color_pass};
pub(crate) use early_return::{AppendedLayout, CompatiblePass, ReturnLayout, ReturnSet, pipeline_of_code};
pub use error::GpuError;
pub(crate) use image::{
    ImageDescription, OwnedImage, array_view, attachment_view, color_view, depth_view, sampled_view,
};
pub(crate) use owned::Owned;
pub(crate) use pipeline::{Output, TilePipeline, TileShader};
pub(crate) use recorder::{Compare, DrawRecorder, Recorder, TileDraw, Tiles};
pub(crate) use recordings::{RecordingKey, allocate as allocate_commands, serial};
pub(crate) use sample_draw::{SampleAspect, SamplePass, SampleTarget, is_left};
pub use shared::Shared;
pub(crate) use slots::{Purpose, SlotIndex};

use crate::link::DeviceRecord;
use ash::vk;
use budget::MemoryBudget;
use commands::CommandRing;
use functions::Functions;
use shared::Left;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use submit_times::{SubmitTime, SubmitTimes};

/// Number of our submits of pictures that may be in flight before the next one waits, and of debug views; of depth, for each eye.
pub(crate) const SUBMITS_IN_FLIGHT: usize = 3;

/// One device of the application, with the queue that our work goes to, if it goes to one of its own.
pub struct Gpu {
    instance: ash::Instance,
    device: ash::Device,
    physical_device: vk::PhysicalDevice,
    api_version: u32,
    limits: vk::PhysicalDeviceLimits,
    is_software: bool,
    memory: vk::PhysicalDeviceMemoryProperties,
    /// `None` if the device does not report it.
    budget: Option<MemoryBudget>,
    /// Memory of the objects made with it, bytes.
    memory_used: AtomicU64,
    queue: vk::Queue,
    /// `None` if there is no queue to submit to.
    commands: Mutex<Option<CommandRing>>,
    /// `None` if there is no queue to submit to.
    shared: Option<Arc<Shared>>,
    /// The compilation of its pipelines; empty if they are made without a cache.
    compilation: OnceLock<Arc<Compilation>>,
    abandoned: AtomicBool,
}

/// A submit with a free slot. Without a call of [`NextSubmit::submit`], nothing happens.
pub(crate) struct NextSubmit<'a> {
    gpu: &'a Gpu,
    commands: MutexGuard<'a, Option<CommandRing>>,
    slot: SlotIndex,
}

impl NextSubmit<'_> {
    /// Its slot: memory that is kept per slot may be written now.
    pub(crate) fn slot(&self) -> SlotIndex {
        self.slot
    }

    /// Records with `record` and submits; returns the number of the submit, for [`Uses::mark`]. Commands with
    /// `key` that are still recorded are submitted again: then nothing is recorded.
    ///
    /// # Errors
    /// Errors of `record`; a failed call. Then nothing was submitted.
    pub(crate) fn submit(
        mut self,
        key: Option<&RecordingKey>,
        record: impl FnOnce(&Recorder) -> Result<(), GpuError>,
    ) -> Result<u64, GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        let ring = self.commands.as_mut().ok_or(GpuError::Invalid("a submission without a queue"))?;
        let result = ring.submit(device, *queue, self.slot, key, record);
        self.gpu.abandon_if_stuck(result)
    }
}

impl Gpu {
    /// Prepares work on queue `queue_index` of family `queue_family`, with objects of its own, and pipelines made by the calling thread:
    /// for tools and tests.
    ///
    /// # Safety
    /// As for [`Gpu::sharing`].
    ///
    /// # Errors
    /// As there.
    pub unsafe fn new(
        record: &DeviceRecord,
        queue_family: u32,
        queue_index: u32,
    ) -> Result<Arc<Self>, GpuError> {
        // SAFETY: the record is as `# Safety` demands.
        unsafe { Self::sharing(record, (queue_family, queue_index), Shared::at_once(record)?) }
    }

    /// Prepares work on a queue, by family and index, with objects that others on the device use too.
    ///
    /// # Safety
    /// - `record` is of a live device that outlives the result and everything made with it; where it cannot,
    ///   [`Gpu::abandon`] is called before the device dies.
    /// - The device was created with that queue, which is not used elsewhere during any call to the result, or to objects made with it.
    /// - Every image handle passed to objects made with the result is a live image of this device.
    ///
    /// # Errors
    /// [`GpuError::Missing`]; [`GpuError::Unsupported`] when the queue cannot draw and compute; a failed call.
    pub unsafe fn sharing(
        record: &DeviceRecord,
        (queue_family, queue_index): (u32, u32),
        shared: Arc<Shared>,
    ) -> Result<Arc<Self>, GpuError> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let mut gpu = unsafe { Self::load(record) }?;
        // SAFETY: the physical device is one of this instance, both live; this only fills structures.
        let families =
            unsafe { gpu.instance.get_physical_device_queue_family_properties(gpu.physical_device) };
        // The barriers name the stages of both.
        let needed = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
        let family = families.get(queue_family as usize);
        let Some(family) = family.filter(|family| family.queue_flags.contains(needed)) else {
            return Err(GpuError::Unsupported("a queue without graphics and compute"));
        };
        let times = SubmitTimes::new(family.timestamp_valid_bits, gpu.limits.timestamp_period);
        // SAFETY: the caller guarantees that the device was created with this queue. The loader's callback may see the queue again: it writes the
        // same pointer.
        unsafe {
            gpu.queue = gpu.device.get_device_queue(queue_family, queue_index);
            functions::init_dispatch(record, gpu.queue)?;
        }
        // SAFETY: the device is live and made of this record.
        let commands = unsafe { CommandRing::new(&gpu.device, record, queue_family, times) }?;
        gpu.commands = Mutex::new(Some(commands));
        gpu.shared = Some(Arc::clone(&shared));
        let gpu = Arc::new(gpu);
        shared.is_used_by(&gpu);
        Ok(gpu)
    }

    /// For objects that only the application's submits use: nothing can be submitted.
    ///
    /// # Safety
    /// As for [`Gpu::new`], but for the queue.
    ///
    /// # Errors
    /// [`GpuError::Missing`].
    pub unsafe fn without_queue(record: &DeviceRecord) -> Result<Arc<Self>, GpuError> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        unsafe { Self::load(record) }.map(Arc::new)
    }

    /// # Safety
    /// As for [`Gpu::without_queue`].
    unsafe fn load(record: &DeviceRecord) -> Result<Self, GpuError> {
        // SAFETY: the record is of a live device, as `# Safety` demands.
        let Functions { instance, device } = unsafe { Functions::load(record) }?;
        let physical_device = record.physical_device;
        // SAFETY: the physical device is one of this instance, both live; these only fill structures.
        let (properties, memory) = unsafe {
            (
                instance.get_physical_device_properties(physical_device),
                instance.get_physical_device_memory_properties(physical_device),
            )
        };
        Ok(Self {
            instance,
            device,
            physical_device,
            api_version: record.api_version,
            limits: properties.limits,
            is_software: properties.device_type == vk::PhysicalDeviceType::CPU,
            memory,
            // SAFETY: the record is of a live device, as `# Safety` demands.
            budget: unsafe { MemoryBudget::of(record) },
            memory_used: AtomicU64::new(0),
            queue: vk::Queue::null(),
            commands: Mutex::default(),
            shared: None,
            compilation: OnceLock::new(),
            abandoned: AtomicBool::new(false),
        })
    }

    /// Notes that the device is lost, hangs, or is about to be destroyed: from now on work of ours is neither waited for nor submitted.
    /// `Shared` destroys the rest when the device ends.
    pub fn abandon(&self) {
        self.abandoned.store(true, Ordering::Relaxed);
        if let Some(shared) = &self.shared {
            shared.abandon();
        }
    }

    /// Notes that the device takes no work of ours: sessions that begin on it later have none.
    pub(crate) fn give_up(&self) {
        if let Some(shared) = &self.shared {
            shared.give_up();
        }
    }

    /// The shared objects of the device.
    pub(crate) fn shared(&self) -> Result<&Arc<Shared>, GpuError> {
        self.shared.as_ref().ok_or(GpuError::Invalid("pipelines without a queue"))
    }

    /// Has its pipelines compiled so.
    pub(crate) fn compile_with(&self, compilation: &Arc<Compilation>) {
        let _ = self.compilation.set(Arc::clone(compilation));
    }

    /// The cache that pipelines are made with, or none.
    fn pipeline_cache(&self) -> Result<vk::PipelineCache, GpuError> {
        self.compilation.get().map_or(Ok(vk::PipelineCache::null()), |compilation| compilation.cache())
    }

    /// Leaves an object to be destroyed when the device ends, or never if its end is not reported.
    fn leave(&self, left: Left) {
        if let Some(shared) = &self.shared {
            shared.leave(left);
        }
    }

    /// Whether nothing is submitted any more: the device once took too long, or an earlier submit failed.
    pub(crate) fn is_abandoned(&self) -> bool {
        self.abandoned.load(Ordering::Relaxed)
    }

    /// Records new images with `record` and submits; returns the number of the submit, for [`Uses::mark`].
    ///
    /// # Errors
    /// As for [`Self::next_submit`] and [`NextSubmit::submit`].
    pub(crate) fn submit(
        &self,
        record: impl FnOnce(&Recorder) -> Result<(), GpuError>,
    ) -> Result<u64, GpuError> {
        self.next_submit(Purpose::NewImages)?.submit(None, record)
    }

    /// The next submit, before anything is recorded. Waits only while all slots of that purpose are under way.
    ///
    /// # Errors
    /// [`GpuError::Timeout`] after a long wait: a later call may succeed. [`GpuError::Abandoned`]; [`GpuError::Invalid`] without a queue.
    pub(crate) fn next_submit(&self, purpose: Purpose) -> Result<NextSubmit<'_>, GpuError> {
        if self.is_abandoned() {
            return Err(GpuError::Abandoned);
        }
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let ring = commands.as_mut().ok_or(GpuError::Invalid("a submission without a queue"))?;
        match ring.free_slot(&self.device, purpose) {
            Ok(slot) => Ok(NextSubmit { gpu: self, commands, slot }),
            // A device that is behind comes again, and nothing was touched that it still uses.
            Err(GpuError::Timeout) => Err(GpuError::Timeout),
            Err(error) => self.abandon_if_stuck(Err(error)),
        }
    }

    /// Submits belong to that frame from now on, and are timed; `None`: they are not.
    pub(crate) fn set_timed_frame(&self, frame: Option<u64>) {
        if let Some(ring) = &mut *self.commands.lock().unwrap_or_else(PoisonError::into_inner) {
            ring.set_timed_frame(frame);
        }
    }

    /// Takes the times of submits that have finished; returns the first frame with one that has not. Waits for nothing.
    pub(crate) fn take_times(&self, add: impl FnMut(SubmitTime)) -> Option<u64> {
        if self.is_abandoned() {
            return None;
        }
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        commands.as_mut()?.take_times(&self.device, add)
    }

    /// Waits until a submit has finished on the GPU.
    fn wait(&self, submit: u64) -> Result<(), GpuError> {
        if self.is_abandoned() {
            return Ok(());
        }
        let commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        commands.as_ref().map_or(Ok(()), |ring| self.abandon_if_stuck(ring.wait(&self.device, submit)))
    }

    /// Whether a submit has finished on the GPU. Waits for nothing.
    pub(crate) fn is_finished(&self, submit: u64) -> bool {
        if self.is_abandoned() {
            return false;
        }
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        commands.as_mut().is_some_and(|ring| ring.is_finished(&self.device, submit))
    }

    /// Whether the GPU still works on a submit; not where the device is lost or hangs. Waits for nothing.
    pub(crate) fn is_under_way(&self, submit: u64) -> bool {
        let commands = || self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        !self.is_abandoned()
            && commands().as_ref().is_some_and(|ring| ring.is_under_way(&self.device, submit))
    }

    /// After a failed wait, the objects in use on the GPU are unknown.
    fn abandon_if_stuck<T>(&self, result: Result<T, GpuError>) -> Result<T, GpuError> {
        if let Err(GpuError::Timeout | GpuError::Call { result: vk::Result::ERROR_DEVICE_LOST, .. }) = result
        {
            self.abandon();
        }
        result
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        let commands = self.commands.get_mut().unwrap_or_else(PoisonError::into_inner);
        let Some(ring) = commands.take() else { return };
        if self.is_abandoned() || ring.wait_all(&self.device).is_err() {
            // SAFETY: the caller of the closure guarantees that the device is live, and that no work is in progress on it.
            self.leave(Box::new(move |device| unsafe { ring.destroy(device) }));
        } else {
            // SAFETY: the device is live, as it was not abandoned, and the ring's work has finished.
            unsafe { ring.destroy(&self.device) };
        }
    }
}
