//! Passes that are timed: those whose target earlier frames showed to be an eye's picture.

use super::Buffer;
use crate::scene::Pass;
use crate::vk::timing::Timer;
use ash::vk;

/// A pass is about to begin.
///
/// # Safety
///
/// `handle` is this command buffer, which is recording, outside of render passes.
pub unsafe fn begin(buffer: &Buffer, handle: vk::CommandBuffer, pass: Option<&Pass>) {
    let armed = &buffer.armed;
    // Between the parts of a suspended pass nothing may be recorded.
    let Some(pass) = pass.filter(|pass| armed.timing.is_wanted() && !pass.facts.is_suspended) else { return };
    let candidate = pass.colors.first().and_then(|&target| armed.candidates.known(target));
    if candidate.is_some_and(|candidate| candidate.content().is_scene()) {
        // SAFETY: the caller vouches for the command buffer.
        buffer.with_timer(|timer| unsafe { timer.begin(armed, handle) });
    }
}

/// A pass has ended.
///
/// # Safety
///
/// As for [`begin`].
pub unsafe fn end(buffer: &Buffer, handle: vk::CommandBuffer) {
    if buffer.recorded().timer.is_open() {
        // SAFETY: the caller vouches for the command buffer.
        buffer.with_timer(|timer| unsafe { timer.end(handle) });
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
