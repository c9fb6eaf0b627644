//! Command buffers that stay recorded, so that a frame with the commands of an earlier one only submits them.

use super::{GpuError, functions};
use crate::link::DeviceRecord;
use ash::vk;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicU64, Ordering};

/// Key of recorded commands: all their inputs but the content of memory, in an order of the recording code's own. An object is in it by its
/// [`serial`] and not by its handle, which a later object may get again. Commands may be submitted again while their objects exist, and a
/// caller with a key has its objects.
pub(crate) type RecordingKey = SmallVec<[u64; 96]>;

/// A number that no other object has.
pub(crate) fn serial() -> u64 {
    static NEWEST: AtomicU64 = AtomicU64::new(0);
    NEWEST.fetch_add(1, Ordering::Relaxed) + 1
}

/// Most command buffers for each slot of the ring. Images are used in turn: 7 of the application's, with the earlier pictures, and 4 of the
/// runtime's make 28 pairs.
const PER_SLOT: usize = 32;

/// The recorded command buffers of one slot, which are pending at no other time than the slot.
#[derive(Default)]
pub(super) struct Recordings {
    /// At most [`PER_SLOT`].
    kept: Vec<Recording>,
    /// Counts uses.
    uses: u64,
}

struct Recording {
    commands: vk::CommandBuffer,
    /// `None` before a complete recording.
    key: Option<RecordingKey>,
    last_use: u64,
}

/// A command buffer for a key.
pub(super) enum Found {
    /// Its commands have that key.
    Recorded(vk::CommandBuffer),
    /// To be recorded.
    Blank(vk::CommandBuffer),
}

impl Recordings {
    /// Finds the command buffer with `key`, or else one to record, without a key until [`Self::set_recorded`]: a new one, or the one that was
    /// used longest ago.
    ///
    /// # Safety
    /// `pool` is a live one of the record's live device, and nothing of this slot is pending.
    pub(super) unsafe fn find(
        &mut self,
        device: &ash::Device,
        record: &DeviceRecord,
        pool: vk::CommandPool,
        key: &RecordingKey,
    ) -> Result<Found, GpuError> {
        self.uses += 1;
        if let Some(found) = self.kept.iter_mut().find(|kept| kept.key.as_ref() == Some(key)) {
            found.last_use = self.uses;
            return Ok(Found::Recorded(found.commands));
        }
        if self.kept.len() < PER_SLOT {
            // SAFETY: the pool is a live one of the record's live device, as `# Safety` demands.
            let commands = unsafe { allocate(device, record, pool) }?;
            self.kept.push(Recording { commands, key: None, last_use: self.uses });
            return Ok(Found::Blank(commands));
        }
        match self.kept.iter_mut().min_by_key(|kept| kept.last_use) {
            Some(oldest) => {
                oldest.key = None;
                oldest.last_use = self.uses;
                Ok(Found::Blank(oldest.commands))
            }
            None => Err(GpuError::Invalid("a slot without command buffers")),
        }
    }

    /// A command buffer has that key now.
    pub(super) fn set_recorded(&mut self, commands: vk::CommandBuffer, key: &RecordingKey) {
        if let Some(kept) = self.kept.iter_mut().find(|kept| kept.commands == commands) {
            kept.key = Some(key.clone());
        }
    }
}

/// Allocates a command buffer.
///
/// # Safety
/// As for [`Recordings::find`].
pub(crate) unsafe fn allocate(
    device: &ash::Device,
    record: &DeviceRecord,
    pool: vk::CommandPool,
) -> Result<vk::CommandBuffer, GpuError> {
    let info = vk::CommandBufferAllocateInfo::default()
        .command_pool(pool)
        .level(vk::CommandBufferLevel::PRIMARY)
        .command_buffer_count(1);
    let mut commands = vk::CommandBuffer::null();
    // SAFETY: the pool is live, as `# Safety` demands; there is room for one handle. The function itself, as ash's own wrapper allocates a list.
    unsafe { (device.fp_v1_0().allocate_command_buffers)(device.handle(), &info, &mut commands) }
        .result()
        .map_err(GpuError::from_call("vkAllocateCommandBuffers"))?;
    // SAFETY: the command buffer was just allocated from this device; without the loader's data it stays unused until its pool ends.
    unsafe { functions::init_dispatch(record, commands) }.map(|()| commands)
}
