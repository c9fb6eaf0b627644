//! The time of command buffers: from their first command that takes time to their last.

use super::{Buffer, Recorded};
use crate::pass_detection::{Event, Pass};
use crate::vk::timing::Timer;
use ash::vk;

/// A pass is about to begin.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording, outside of render passes.
pub unsafe fn pass_begins(buffer: &Buffer, handle: vk::CommandBuffer, pass: Option<&Pass>) {
    // Between the parts of a suspended pass nothing may be recorded, and this may be a later part.
    if pass.is_none_or(|pass| !pass.facts.is_suspended) {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe { work_begins(buffer, handle) };
    }
}

/// A command that takes time, or waits for one, is about to be recorded.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording.
pub unsafe fn work_begins(buffer: &Buffer, handle: vk::CommandBuffer) {
    let armed = &buffer.armed;
    if !armed.timing.is_wanted() {
        return;
    }
    let may_begin = {
        let recorded = buffer.recorded();
        recorded.timer.may_begin() && !recorded.is_within_pass()
    };
    if may_begin {
        // SAFETY: the command buffer is recording, as `# Safety` demands. A pass that is not known has begun the time already.
        buffer.with_timer(|timer| unsafe { timer.begin(|| armed.functions(), handle) });
    }
}

/// The command buffer is about to end.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording, outside of render passes.
pub unsafe fn buffer_ends(buffer: &Buffer, handle: vk::CommandBuffer) {
    let is_open = {
        let recorded = buffer.recorded();
        recorded.timer.is_open() && !recorded.may_be_suspended()
    };
    if is_open {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        buffer.with_timer(|timer| unsafe { timer.end(handle) });
    }
}

impl Recorded {
    /// Whether the last pass may go on in another command buffer: no command may come in between.
    fn may_be_suspended(&self) -> bool {
        let last = self.events.iter().rev().find_map(|event| match event {
            Event::Pass(pass) => Some(pass),
            Event::Transfer(_) => None,
        });
        last.is_some_and(|pass| pass.facts.is_suspended)
    }
}

impl Buffer {
    /// Calls down with the timer, and without a lock.
    fn with_timer(&self, act: impl FnOnce(&mut Timer)) {
        let mut timer = std::mem::take(&mut self.recorded().timer);
        act(&mut timer);
        self.recorded().timer = timer;
    }
}
