//! Frames in flight: each has a command buffer and a fence.

use crate::app::Frame;
use crate::gpu::{Gpu, Made};
use crate::scene::IN_FLIGHT;
use anyhow::Result;
use ash::vk;

/// One of the frames in flight.
#[derive(Clone, Copy)]
pub struct Slot {
    pub index: usize,
    pub commands: vk::CommandBuffer,
    fence: vk::Fence,
}

/// All of them, in turn.
pub struct Slots {
    slots: Vec<Slot>,
    next: usize,
}

impl Slots {
    /// # Errors
    /// Errors of the calls.
    pub fn new(gpu: &Gpu) -> Result<Self> {
        let commands = gpu.command_buffers(IN_FLIGHT as u32, vk::CommandBufferLevel::PRIMARY)?;
        let info = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        let mut slots = Vec::new();
        for (index, commands) in commands.into_iter().enumerate() {
            // SAFETY: the structure outlives the call.
            let fence = unsafe { gpu.create_fence(&info, None) }?;
            gpu.keep(Made::Fence(fence));
            slots.push(Slot { index, commands, fence });
        }
        Ok(Self { slots, next: 0 })
    }

    /// The next slot, once the device is done with its last use.
    ///
    /// # Errors
    /// A lost device.
    pub fn next(&mut self, gpu: &Gpu) -> Result<Slot> {
        let slot = self.slots[self.next];
        self.next = (self.next + 1) % self.slots.len();
        // SAFETY: the fence is live; it is signalled, or a submission will signal it.
        unsafe {
            gpu.wait_for_fences(&[slot.fence], true, u64::MAX)?;
            gpu.reset_fences(&[slot.fence])?;
        }
        Ok(slot)
    }

    /// Submits a frame to the session's queue.
    ///
    /// # Errors
    /// Errors of vkQueueSubmit.
    pub fn submit(&self, gpu: &Gpu, slot: &Slot, frame: &Frame) -> Result<()> {
        let mut commands = vec![slot.commands];
        commands.extend(frame.after.borrow().iter());
        let waits = frame.waits.borrow();
        let stages = vec![vk::PipelineStageFlags::ALL_COMMANDS; waits.len()];
        let info = vk::SubmitInfo::default()
            .command_buffers(&commands)
            .wait_semaphores(&waits)
            .wait_dst_stage_mask(&stages);
        // SAFETY: this thread is the only one that uses the queue; the command buffers were recorded; the fence is
        // unsignalled and not in use.
        Ok(unsafe { gpu.queue_submit(gpu.queue, &[info], slot.fence) }?)
    }
}
