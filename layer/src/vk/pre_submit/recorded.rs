//! Commands of ours that stay recorded, and are submitted again as long as nothing but the content of their memory changes. They may be pending
//! more than once, unlike those of `xrEndFrame` (`gpu/recordings.rs`), whose parameters are in the memory of one slot.

use crate::gpu::{GpuError, RecordingKey, allocate_commands};
use crate::link::DeviceRecord;
use ash::vk;
use std::sync::Arc;

/// Most command buffers: of a frame's decision and maps and of its analysis, for each of four images of the application's, and as many with
/// other staging memory.
const MOST: usize = 16;

/// The recorded command buffers of one queue.
#[derive(Default)]
pub struct RecordedCommands {
    /// Null before the first command buffer.
    pool: vk::CommandPool,
    recorded: Vec<Recorded>,
    /// Counts uses.
    uses: u64,
}

struct Recorded {
    commands: vk::CommandBuffer,
    /// `None` before a complete recording.
    key: Option<RecordingKey>,
    last_use: u64,
    /// Held elsewhere, too, while a submit of it may be pending.
    pending: Arc<()>,
}

/// A recorded command buffer.
pub struct Found {
    /// The command buffer.
    pub commands: vk::CommandBuffer,
    /// To be kept until its submit has finished.
    pub pending: Arc<()>,
}

impl RecordedCommands {
    /// The command buffer with `key`, which `record` records the first time; `None` if all command buffers are pending. It may be submitted
    /// while earlier submits of it are pending.
    ///
    /// # Errors
    /// A failed call.
    ///
    /// # Safety
    /// `device` is live and made of the record, and has queues of that family; it is the same in all calls.
    pub unsafe fn find(
        &mut self,
        (device, of): (&ash::Device, &DeviceRecord),
        family: u32,
        key: &RecordingKey,
        record: impl FnOnce(vk::CommandBuffer),
    ) -> Result<Option<Found>, GpuError> {
        self.uses += 1;
        let known = self.recorded.iter().position(|known| known.key.as_ref() == Some(key));
        let index = match known {
            Some(index) => index,
            None => {
                // SAFETY: as `# Safety` demands.
                let Some(index) = (unsafe { self.blank((device, of), family) })? else { return Ok(None) };
                let blank = &mut self.recorded[index];
                blank.key = None;
                let flags = vk::CommandBufferUsageFlags::SIMULTANEOUS_USE;
                let begin = vk::CommandBufferBeginInfo::default().flags(flags);
                // SAFETY: the command buffer is one of the live device and not pending; beginning resets it.
                unsafe { device.begin_command_buffer(blank.commands, &begin) }
                    .map_err(GpuError::from_call("vkBeginCommandBuffer"))?;
                record(blank.commands);
                // SAFETY: as above; it is recording.
                unsafe { device.end_command_buffer(blank.commands) }
                    .map_err(GpuError::from_call("vkEndCommandBuffer"))?;
                blank.key = Some(key.clone());
                index
            }
        };
        let found = &mut self.recorded[index];
        found.last_use = self.uses;
        Ok(Some(Found { commands: found.commands, pending: Arc::clone(&found.pending) }))
    }

    /// Index of a command buffer to record: a new one, or the one that was used longest ago and is not pending.
    ///
    /// # Safety
    /// As for [`Self::find`].
    unsafe fn blank(
        &mut self,
        (device, of): (&ash::Device, &DeviceRecord),
        family: u32,
    ) -> Result<Option<usize>, GpuError> {
        let is_full = self.recorded.len() >= MOST;
        let free = self.recorded.iter_mut().enumerate().filter_map(|(index, known)| {
            let may_replace = is_full || known.key.is_none();
            (may_replace && Arc::get_mut(&mut known.pending).is_some()).then_some((known.last_use, index))
        });
        let free = free.min().map(|(_, index)| index);
        if free.is_some() || is_full {
            return Ok(free);
        }
        if self.pool == vk::CommandPool::null() {
            let info = vk::CommandPoolCreateInfo::default()
                .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER)
                .queue_family_index(family);
            // SAFETY: the device is live and has that family, as `# Safety` demands.
            self.pool = unsafe { device.create_command_pool(&info, None) }
                .map_err(GpuError::from_call("vkCreateCommandPool"))?;
        }
        // SAFETY: the pool is one of the live device, which was made of the record.
        let commands = unsafe { allocate_commands(device, of, self.pool) }?;
        self.recorded.push(Recorded { commands, key: None, last_use: 0, pending: Arc::default() });
        Ok(Some(self.recorded.len() - 1))
    }

    /// Destroys all before their device is destroyed. Where the wait for pending ones failed, they are left.
    pub fn destroy(mut self, device: &ash::Device) {
        if self.recorded.iter_mut().all(|known| Arc::get_mut(&mut known.pending).is_some()) {
            // SAFETY: the pool is one of this live device, and nothing of it is pending.
            unsafe { device.destroy_command_pool(self.pool, None) };
        }
    }
}

#[cfg(test)]
mod tests;
