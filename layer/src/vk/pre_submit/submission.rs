//! One submit of ours while it is put together.

use super::recorded::{Found, RecordedCommands};
use super::{Kept, Outcome, Slot, Submitter};
use crate::gpu::{GpuError, RecordingKey};
use crate::vk::timing::Work;
use ash::vk;
use smallvec::SmallVec;
use std::sync::atomic::AtomicU64;

/// A submit under construction: commands for it alone, and after them recorded commands of earlier submits.
pub struct Submission<'a> {
    slot: &'a mut Slot,
    own: Submitter<'a>,
    work: Work,
    /// `None` while another thread has them.
    recorded: Option<&'a mut RecordedCommands>,
    has_begun: bool,
    again: SmallVec<[vk::CommandBuffer; 2]>,
    /// Objects that its commands use.
    pub kept: Kept,
}

impl<'a> Submission<'a> {
    /// Of that work, with nothing in it. The slot is not pending, and its device is that of `own`.
    pub(super) fn new(
        slot: &'a mut Slot,
        recorded: Option<&'a mut RecordedCommands>,
        own: Submitter<'a>,
        work: Work,
    ) -> Self {
        slot.clear_timer();
        Self { slot, own, work, recorded, has_begun: false, again: SmallVec::new(), kept: Kept::new() }
    }

    /// The command buffer for commands of this submit alone. They run before the commands of [`Self::repeat`].
    ///
    /// # Errors
    /// A failed call.
    pub fn commands(&mut self) -> Result<vk::CommandBuffer, GpuError> {
        if !self.has_begun {
            // SAFETY: the slot is not pending, and its device is that of `own`.
            unsafe { self.slot.begin(self.own) }?;
            self.has_begun = true;
        }
        Ok(self.slot.commands())
    }

    /// The slot, for its staging memory.
    pub fn slot(&mut self) -> &mut Slot {
        self.slot
    }

    /// Adds the commands of `record`, which depend on nothing but the key and the content of memory. Those with a key that an earlier submit had
    /// are not recorded. Commands are recorded for this submit alone without a key, and while submits are timed.
    ///
    /// # Errors
    /// A failed call.
    pub fn repeat(
        &mut self,
        key: Option<&RecordingKey>,
        record: impl Fn(vk::CommandBuffer),
    ) -> Result<(), GpuError> {
        let key = key.filter(|_| !self.own.timing.is_wanted());
        if let Some((key, recorded)) = key.zip(self.recorded.as_mut()) {
            let (device, of) = (&self.own.functions.device, self.own.record);
            // SAFETY: the device of `own` is live, that of the ring, and has its family.
            let found = unsafe { recorded.find((device, of), self.slot.family(), key, &record) }?;
            if let Some(Found { commands, pending }) = found {
                self.again.push(commands);
                self.kept.push(pending);
                return Ok(());
            }
        }
        record(self.commands()?);
        Ok(())
    }

    /// Submits it, unless it has no commands, as the one after `newest` of the queue.
    ///
    /// # Errors
    /// A failed call.
    ///
    /// # Safety
    ///
    /// This thread may use the queue now, which is that of the ring; objects in commands that are not in [`Self::kept`] are valid until it has
    /// finished.
    pub(super) unsafe fn submit(self, queue: vk::Queue, newest: &AtomicU64) -> Result<Outcome, GpuError> {
        let Self { slot, own, work, has_begun, again, kept, .. } = self;
        let own_commands = has_begun.then(|| slot.commands());
        let commands: SmallVec<[vk::CommandBuffer; 3]> = own_commands.into_iter().chain(again).collect();
        if commands.is_empty() {
            return Ok(Outcome::Empty);
        }
        // SAFETY: as `# Safety` demands; `has_begun` is the state of the slot.
        unsafe { slot.submit((own, queue, newest), work, (has_begun, &commands), kept) }
            .map(|()| Outcome::Submitted)
    }
}
