//! One command buffer of a ring, its fence, and the staging memory that it reads.

use super::{Kept, Staging, Submitter};
use crate::gpu::{GpuError, allocate_commands, wait_device, wait_fence};
use crate::vk::timing::{Timer, Work};
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};

/// Staging memory is asked for in steps of this many bytes.
const STEP: usize = 64 * 1024;

/// A command buffer that is used again and again.
pub struct Slot {
    /// The family of the queue.
    family: u32,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    staging: Option<Staging>,
    /// Memory for stale tiles.
    pub words: Vec<u32>,
    /// Objects in use by the command buffer while it is pending.
    kept: Kept,
    timer: Timer,
    /// Number of its last submit among those to the queue, as long as the GPU may work on it.
    pending: Option<u64>,
}

impl Slot {
    /// # Safety
    ///
    /// The device is live and has queues of that family; `own` is of it.
    pub unsafe fn new(own: Submitter<'_>, family: u32) -> Result<Self, GpuError> {
        let device = &own.functions.device;
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::TRANSIENT)
            .queue_family_index(family);
        // SAFETY: the device is live and has that family, as `# Safety` demands.
        let pool = unsafe { device.create_command_pool(&info, None) }
            .map_err(GpuError::from_call("vkCreateCommandPool"))?;
        let mut slot = Self {
            family,
            pool,
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            staging: None,
            words: Vec::new(),
            kept: Kept::new(),
            timer: own.timing.own_timer(own.functions, family),
            pending: None,
        };
        // SAFETY: the pool is a new one of the live device.
        match unsafe { slot.make(own, device) } {
            Ok(()) => Ok(slot),
            Err(error) => {
                slot.destroy(device);
                Err(error)
            }
        }
    }

    /// # Safety
    ///
    /// As for [`Self::new`].
    unsafe fn make(&mut self, own: Submitter<'_>, device: &ash::Device) -> Result<(), GpuError> {
        // SAFETY: the device is live, as `# Safety` demands, and the pool one of its own.
        unsafe {
            self.commands = allocate_commands(device, own.record, self.pool)?;
            self.fence = device
                .create_fence(&vk::FenceCreateInfo::default(), None)
                .map_err(GpuError::from_call("vkCreateFence"))?;
        }
        Ok(())
    }

    /// Number of its last submit; `None` if the GPU is known to be done with it.
    pub fn pending(&self) -> Option<u64> {
        self.pending
    }

    /// Whether the GPU is done with its submit.
    pub fn has_finished(&self, device: &ash::Device) -> bool {
        // SAFETY: the fence is one of this live device.
        self.pending.is_none() || unsafe { device.get_fence_status(self.fence) } == Ok(true)
    }

    /// Waits until the GPU is done with it, if it may still work on it.
    pub fn wait(&mut self, device: &ash::Device) {
        // SAFETY: the fence is one of this live device.
        if self.pending.is_some() && unsafe { wait_fence(device, self.fence) }.is_ok() {
            self.finish();
        }
    }

    /// The GPU is done with it.
    pub fn finish(&mut self) {
        self.pending = None;
        self.kept.clear();
    }

    /// The command buffer, recording from [`Self::begin`] on.
    pub fn commands(&self) -> vk::CommandBuffer {
        self.commands
    }

    /// The family of the queue that its commands are for.
    pub fn family(&self) -> u32 {
        self.family
    }

    /// The staging memory.
    pub fn buffer(&self) -> vk::Buffer {
        self.staging.as_ref().map_or(vk::Buffer::null(), Staging::buffer)
    }

    /// Forgets the timestamps of its last submit.
    pub(super) fn clear_timer(&mut self) {
        self.timer.clear();
    }

    /// Begins to record its command buffer.
    ///
    /// # Safety
    ///
    /// It is not pending; `own` is of its device.
    pub(super) unsafe fn begin(&mut self, own: Submitter<'_>) -> Result<(), GpuError> {
        let device = &own.functions.device;
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: nothing of the pool is pending.
        unsafe {
            device
                .reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .map_err(GpuError::from_call("vkResetCommandPool"))?;
            device
                .begin_command_buffer(self.commands, &info)
                .map_err(GpuError::from_call("vkBeginCommandBuffer"))?;
            if own.timing.is_wanted() {
                self.timer.begin(|| Some(own.functions), self.commands);
            }
        }
        Ok(())
    }

    /// Makes room for so many bytes in the staging memory, which is not recorded yet.
    ///
    /// # Errors
    ///
    /// The device has no memory left.
    pub fn reserve(&mut self, own: Submitter<'_>, len: usize) -> Result<(), GpuError> {
        if len > self.staging.as_ref().map_or(0, Staging::len) {
            if let Some(small) = self.staging.take() {
                small.destroy(&own.functions.device);
            }
            self.staging = Some(Staging::new(own, len.next_multiple_of(STEP))?);
        }
        Ok(())
    }

    /// Writes staging memory.
    pub fn stage(&mut self, offset: usize, len: usize, write: impl FnOnce(&mut [u8])) {
        let bytes = self.staging.as_mut().and_then(|staging| staging.bytes().get_mut(offset..offset + len));
        if let Some(bytes) = bytes {
            write(bytes);
        }
    }

    /// Submits command buffers, as the submit after `newest` of the queue; if it `has_begun`, its own is among them, and its recording ends.
    ///
    /// # Safety
    ///
    /// This thread may use the queue now, which is of the pool's family; all other command buffers are recorded; `own` is of its device.
    pub(super) unsafe fn submit(
        &mut self,
        (own, queue, newest): (Submitter<'_>, vk::Queue, &AtomicU64),
        work: Work,
        (has_begun, commands): (bool, &[vk::CommandBuffer]),
        kept: Kept,
    ) -> Result<(), GpuError> {
        let device = &own.functions.device;
        let info = vk::SubmitInfo::default().command_buffers(commands);
        // SAFETY: the device is live, its command buffer is recording where it has begun, and the fence is not in use, as the slot is not pending.
        unsafe {
            if has_begun {
                self.timer.end(self.commands);
                device
                    .end_command_buffer(self.commands)
                    .map_err(GpuError::from_call("vkEndCommandBuffer"))?;
            }
            device.reset_fences(&[self.fence]).map_err(GpuError::from_call("vkResetFences"))?;
        }
        // Under the lock, so that the numbers have the order of the submits.
        let (number, result) = own.locks.with(queue, || {
            let number = newest.fetch_add(1, Ordering::Relaxed) + 1;
            // SAFETY: this thread may use the live queue, as `# Safety` demands.
            (number, unsafe { (own.submit)(queue, 1, &info, self.fence) })
        });
        result.result().map_err(GpuError::from_call("vkQueueSubmit"))?;
        own.timing.submitted(&self.timer, own.frame.log().frame(), work);
        self.kept = kept;
        self.pending = Some(number);
        Ok(())
    }

    /// Waits until the GPU is done with it, and destroys it, as the device is about to be; where that fails it is left.
    pub fn destroy(mut self, device: &ash::Device) {
        // SAFETY: fence and pool are of this live device, of which the application uses no queue any more; after the wait nothing
        // is in use.
        unsafe {
            if self.pending.is_some() && wait_fence(device, self.fence).is_err() && !wait_device(device) {
                std::mem::forget(std::mem::take(&mut self.timer));
                self.kept.drain(..).for_each(std::mem::forget);
                return;
            }
            if let Some(staging) = self.staging.take() {
                staging.destroy(device);
            }
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
        }
    }
}
