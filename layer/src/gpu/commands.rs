//! A ring of submits, each with command buffers and a fence, so that a submit seldom waits and allocates nothing.

use super::recordings::{Found, RecordingKey, Recordings, allocate};
use super::slots::{PURPOSES, Purpose, SLOTS, SlotIndex};
use super::submit_times::{SubmitTime, SubmitTimes};
use super::{Gpu, GpuError, Recorder};
use crate::link::DeviceRecord;
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Longest wait for a fence of ours. A frame takes milliseconds; much longer means a hanging device, and the
/// application must not hang with it.
const FENCE_TIMEOUT: Duration = Duration::from_secs(5);

/// Time between two looks at a fence that cannot be waited for.
const BETWEEN_LOOKS: Duration = Duration::from_micros(200);

/// One of the submits under way.
#[derive(Default)]
struct Slot {
    /// For commands of one submit.
    commands: vk::CommandBuffer,
    /// For commands that may be submitted again.
    recordings: Recordings,
    fence: vk::Fence,
    /// Number of the submit that it was last used for; 0 for none.
    submit: u64,
}

/// The ring.
pub(super) struct CommandRing {
    pool: vk::CommandPool,
    /// Of the device.
    record: DeviceRecord,
    slots: [Slot; SLOTS],
    /// Number of submits so far, by [`Purpose`].
    counts: [usize; PURPOSES],
    /// Number of the last submit; they count from 1.
    last_submit: u64,
    /// The submits up to this number are known to have finished.
    last_finished: u64,
    /// Whether the wait for a submit timed out: until it has finished, it is not waited for again.
    is_behind: bool,
    times: SubmitTimes,
}

impl CommandRing {
    /// # Safety
    /// `device` is live and made of `record`, and has a queue of that family.
    pub(super) unsafe fn new(
        device: &ash::Device,
        record: &DeviceRecord,
        queue_family: u32,
        times: SubmitTimes,
    ) -> Result<Self, GpuError> {
        let pool_info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER)
            .queue_family_index(queue_family);
        // SAFETY: the device is live and has that family.
        let pool = unsafe { device.create_command_pool(&pool_info, None) }
            .map_err(GpuError::from_call("vkCreateCommandPool"))?;
        let slots = Default::default();
        let mut ring = Self {
            pool,
            record: *record,
            slots,
            counts: [0; PURPOSES],
            last_submit: 0,
            last_finished: 0,
            is_behind: false,
            times,
        };
        // SAFETY: as above; the pool is new.
        match unsafe { ring.fill(device) } {
            Ok(()) => Ok(ring),
            Err(error) => {
                // SAFETY: nothing was submitted, and handles that were not created are null, which the destroy functions ignore.
                unsafe { ring.destroy(device) };
                Err(error)
            }
        }
    }

    /// Makes a command buffer and a fence for each slot.
    ///
    /// # Safety
    ///
    /// The device is live, and the pool is of it.
    unsafe fn fill(&mut self, device: &ash::Device) -> Result<(), GpuError> {
        for slot in &mut self.slots {
            // SAFETY: the pool is one of this live device.
            slot.commands = unsafe { allocate(device, &self.record, self.pool) }?;
            // SAFETY: the device is live.
            slot.fence = unsafe { device.create_fence(&vk::FenceCreateInfo::default(), None) }
                .map_err(GpuError::from_call("vkCreateFence"))?;
        }
        Ok(())
    }

    /// The slot of the next submit, once its last one has finished. See [`Gpu::next_submit`].
    pub(super) fn free_slot(
        &mut self,
        device: &ash::Device,
        purpose: Purpose,
    ) -> Result<SlotIndex, GpuError> {
        let slot = SlotIndex::after(purpose, self.counts[purpose as usize]);
        let index = slot.of_all();
        let submit = self.slots[index].submit;
        if submit != 0 {
            // Where the newest submit has finished, as on a device that keeps up, the next frames need no call.
            if submit > self.last_finished && !self.is_finished(device, self.last_submit) {
                self.wait_for_slot(device, self.slots[index].fence)?;
                self.last_finished = submit;
            }
            self.times.finished(device, index);
        }
        Ok(slot)
    }

    /// Records, or finds recorded commands with `key`, and submits; returns the number of the submit. See [`super::NextSubmit::submit`].
    pub(super) fn submit(
        &mut self,
        device: &ash::Device,
        queue: vk::Queue,
        slot: SlotIndex,
        key: Option<&RecordingKey>,
        record: impl FnOnce(&Recorder) -> Result<(), GpuError>,
    ) -> Result<u64, GpuError> {
        let number = self.last_submit + 1;
        let index = slot.of_all();
        // Timestamps are written for the frame under way alone.
        let key = key.filter(|_| !self.times.is_timed());
        let Slot { recordings, commands, .. } = &mut self.slots[index];
        let found = match key {
            // SAFETY: pool and device are live, and the slot's last submit has finished.
            Some(key) => unsafe { recordings.find(device, &self.record, self.pool, key) }?,
            None => Found::Blank(*commands),
        };
        let commands = match found {
            Found::Recorded(commands) => commands,
            Found::Blank(commands) => {
                let once = if key.is_none() {
                    vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT
                } else {
                    vk::CommandBufferUsageFlags::empty()
                };
                self.record(device, (commands, once), index, record)?;
                if let Some(key) = key {
                    self.slots[index].recordings.set_recorded(commands, key);
                }
                commands
            }
        };
        let submitted = self.submit_recorded(device, queue, index, commands);
        match submitted {
            Ok(()) => {
                self.slots[index].submit = number;
                self.last_submit = number;
                self.counts[slot.purpose() as usize] += 1;
            }
            Err(_) => self.times.forget(index),
        }
        submitted.map(|()| number)
    }

    /// Records a command buffer of a slot, whose last submit has finished.
    fn record(
        &mut self,
        device: &ash::Device,
        (commands, usage): (vk::CommandBuffer, vk::CommandBufferUsageFlags),
        index: usize,
        record: impl FnOnce(&Recorder) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        let begin = vk::CommandBufferBeginInfo::default().flags(usage);
        // SAFETY: the command buffer is not pending: its fence was waited for. Beginning resets it.
        unsafe { device.begin_command_buffer(commands, &begin) }
            .map_err(GpuError::from_call("vkBeginCommandBuffer"))?;
        // SAFETY: it is being recorded, on a queue that draws (`Gpu::sharing`).
        unsafe { self.times.begin(device, commands, index) };
        if let Err(error) = record(&Recorder::new(device, commands)) {
            self.times.forget(index);
            // SAFETY: the command buffer is not pending; no other code uses the pool.
            unsafe { device.reset_command_buffer(commands, vk::CommandBufferResetFlags::empty()) }
                .map_err(GpuError::from_call("vkResetCommandBuffer"))?;
            return Err(error);
        }
        // SAFETY: as above, outside of a render pass: `Recorder` ends those.
        unsafe {
            self.times.end(device, commands, index);
            device.end_command_buffer(commands)
        }
        .map_err(GpuError::from_call("vkEndCommandBuffer"))
    }

    /// Submits a recorded command buffer of a slot with the slot's fence.
    fn submit_recorded(
        &mut self,
        device: &ash::Device,
        queue: vk::Queue,
        index: usize,
        commands: vk::CommandBuffer,
    ) -> Result<(), GpuError> {
        // Until the submit succeeds, no thread may wait for the fence: it would never be signalled.
        self.slots[index].submit = 0;
        // SAFETY: the fence is not in use: it was waited for, or never submitted.
        if unsafe { device.reset_fences(&[self.slots[index].fence]) }.is_err() {
            // SAFETY: as above.
            unsafe { self.renew_fence(device, index) }?;
        }
        let fence = self.slots[index].fence;
        let commands = [commands];
        let info = vk::SubmitInfo::default().command_buffers(&commands);
        // SAFETY: command buffer and fence are ready, and the queue is ours to use, as `Gpu::new` demands.
        unsafe { device.queue_submit(queue, &[info], fence) }.map_err(GpuError::from_call("vkQueueSubmit"))
    }

    /// Submits belong to that frame from now on, and are timed; `None`: they are not.
    pub(super) fn set_timed_frame(&mut self, frame: Option<u64>) {
        self.times.set_frame(frame);
    }

    /// Takes the times of submits that have finished; returns the first frame with one that has not. Waits for nothing.
    pub(super) fn take_times(&mut self, device: &ash::Device, add: impl FnMut(SubmitTime)) -> Option<u64> {
        for index in 0..self.slots.len() {
            let submit = self.slots[index].submit;
            if submit != 0 && self.times.is_unread(index) && self.is_finished(device, submit) {
                self.times.finished(device, index);
            }
        }
        self.times.take(add)
    }

    /// Waits for a free slot. After a wait that timed out, only polls, so an application with a slow device waits once.
    fn wait_for_slot(&mut self, device: &ash::Device, fence: vk::Fence) -> Result<(), GpuError> {
        if !self.is_behind {
            // SAFETY: the fence belongs to the ring of this live device.
            match unsafe { wait_fence(device, fence) } {
                Err(GpuError::Timeout) => self.is_behind = true,
                result => return result,
            }
        }
        // SAFETY: as above.
        match unsafe { device.get_fence_status(fence) } {
            Ok(true) => {
                self.is_behind = false;
                Ok(())
            }
            Ok(false) => Err(GpuError::Timeout),
            Err(result) => Err(GpuError::Call { call: "vkGetFenceStatus", result }),
        }
    }

    /// Replaces a fence that cannot be reset.
    ///
    /// # Safety
    /// The fence is not in use.
    unsafe fn renew_fence(&mut self, device: &ash::Device, index: usize) -> Result<(), GpuError> {
        // SAFETY: the device is live; the fence is not in use, as `# Safety` demands.
        unsafe {
            let new = device
                .create_fence(&vk::FenceCreateInfo::default(), None)
                .map_err(GpuError::from_call("vkCreateFence"))?;
            device.destroy_fence(std::mem::replace(&mut self.slots[index].fence, new), None);
        }
        Ok(())
    }

    /// Waits for a submit, and with it for all earlier ones: a fence is signalled in submission order.
    pub(super) fn wait(&self, device: &ash::Device, submit: u64) -> Result<(), GpuError> {
        // A submit that is in no slot was waited for when its slot was used again.
        match self.slots.iter().find(|slot| slot.submit == submit && submit != 0) {
            // SAFETY: the fence belongs to the ring of this live device.
            Some(slot) => unsafe { wait_fence(device, slot.fence) },
            None => Ok(()),
        }
    }

    /// Whether a submit has finished, and with it all earlier ones. Waits for nothing.
    pub(super) fn is_finished(&mut self, device: &ash::Device, submit: u64) -> bool {
        if submit <= self.last_finished {
            return true;
        }
        let Some(slot) = self.slots.iter().find(|slot| slot.submit == submit) else {
            return submit <= self.last_submit;
        };
        // SAFETY: the fence belongs to the ring of this live device, and was submitted.
        let is_finished = unsafe { device.get_fence_status(slot.fence) } == Ok(true);
        if is_finished {
            self.last_finished = submit;
        }
        is_finished
    }

    /// Whether the GPU still works on a submit, as far as that can be known. Waits for nothing.
    pub(super) fn is_under_way(&self, device: &ash::Device, submit: u64) -> bool {
        let slot = self.slots.iter().find(|slot| slot.submit == submit && submit > self.last_finished);
        // SAFETY: the fence belongs to the ring of this live device, and was submitted.
        slot.is_some_and(|slot| unsafe { device.get_fence_status(slot.fence) } == Ok(false))
    }

    /// Waits for all that is under way.
    pub(super) fn wait_all(&self, device: &ash::Device) -> Result<(), GpuError> {
        self.wait(device, self.last_submit)
    }

    /// Destroys everything.
    ///
    /// # Safety
    /// `device` is live, and nothing of the ring is under way on it.
    pub(super) unsafe fn destroy(self, device: &ash::Device) {
        // SAFETY: all work has finished, and no other code has these handles.
        unsafe {
            for slot in &self.slots {
                device.destroy_fence(slot.fence, None);
            }
            self.times.destroy(device);
            device.destroy_command_pool(self.pool, None);
        }
    }
}

/// Waits until a device is idle or lost. Returns whether it is.
///
/// # Safety
/// The device is live, and none of its queues is used elsewhere.
pub(crate) unsafe fn wait_device(device: &ash::Device) -> bool {
    // SAFETY: the device is live and its queues are free, as `# Safety` demands.
    let result = unsafe { device.device_wait_idle() };
    matches!(result, Ok(()) | Err(vk::Result::ERROR_DEVICE_LOST))
}

/// Waits for a fence that was submitted.
///
/// # Safety
/// The fence is a live one of the device.
pub(crate) unsafe fn wait_fence(device: &ash::Device, fence: vk::Fence) -> Result<(), GpuError> {
    let start = Instant::now();
    // SAFETY: the fence is live, as `# Safety` demands.
    match unsafe { device.wait_for_fences(&[fence], true, FENCE_TIMEOUT.as_nanos() as u64) } {
        Ok(()) => Ok(()),
        Err(vk::Result::TIMEOUT) if start.elapsed() >= FENCE_TIMEOUT => Err(GpuError::Timeout),
        Err(result @ vk::Result::ERROR_DEVICE_LOST) => {
            Err(GpuError::Call { call: "vkWaitForFences", result })
        }
        // A wait that ended early, or short of memory for waiting, which looking does without.
        // SAFETY: as above.
        Err(_) => unsafe { watch_fence(device, fence) },
    }
}

/// Looks at a fence again and again.
///
/// # Safety
/// The fence is a live one of the device.
unsafe fn watch_fence(device: &ash::Device, fence: vk::Fence) -> Result<(), GpuError> {
    let start = Instant::now();
    loop {
        // SAFETY: the fence is live, as `# Safety` demands.
        match unsafe { device.get_fence_status(fence) } {
            Ok(true) => return Ok(()),
            Ok(false) if start.elapsed() < FENCE_TIMEOUT => std::thread::sleep(BETWEEN_LOOKS),
            Ok(false) => return Err(GpuError::Timeout),
            Err(result) => return Err(GpuError::Call { call: "vkGetFenceStatus", result }),
        }
    }
}

/// The last submit that used a group of objects. Belongs in front of the objects among a struct's fields:
/// dropping it waits for that submit, and fields are dropped in order.
pub(crate) struct Uses {
    gpu: Arc<Gpu>,
    last: AtomicU64,
}

impl Uses {
    /// Not used yet.
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Self {
        Self { gpu: Arc::clone(gpu), last: AtomicU64::new(0) }
    }

    /// Notes that the submit of this number uses the objects.
    pub(crate) fn mark(&self, submit: u64) {
        self.last.fetch_max(submit, Ordering::Relaxed);
    }
}

impl Drop for Uses {
    fn drop(&mut self) {
        if let Err(error) = self.gpu.wait(*self.last.get_mut()) {
            error.log("a wait for the GPU failed, so images in use are destroyed only with the device");
        }
    }
}
