//! Waiting until an image of a virtual swapchain may be drawn to.
//!
//! On the session's queue there is nothing to wait for: the layer submits its reads of an image there before the application can submit new
//! draws to the image. Draws on other queues of the application may overtake these reads.

use super::{Substitute, Swapchain};
use openxr_sys as xr;
use std::time::{Duration, Instant};

/// Longest wait, even if the application allows more: a device that takes longer hangs, and the application must not hang with it.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time between two looks. No fence is waited for: another thread may use it for the next submit meanwhile.
const BETWEEN_LOOKS: Duration = Duration::from_micros(200);

impl Swapchain {
    /// Waits until the layer no longer uses an image that the application draws to on a queue other than the session's: at most for `timeout`, and
    /// never longer than [`PATIENCE`]. Returns whether the image is free, or will never be.
    pub(super) fn waits_until_free(
        &self,
        substitute: &Substitute,
        image: u32,
        timeout: xr::Duration,
    ) -> bool {
        let handle = substitute.app.images().get(image as usize).copied();
        let (Some(active), Some(handle)) = (&self.session.active, handle) else { return true };
        if !active.device.is_used_on_other_queues(handle) {
            return true;
        }
        let allowed = match u64::try_from(timeout.as_nanos()) {
            Ok(nanos) => Duration::from_nanos(nanos),
            Err(_) => Duration::ZERO,
        };
        let start = Instant::now();
        while !substitute.app.is_free(image) {
            let elapsed = start.elapsed();
            if elapsed >= PATIENCE {
                tracing::debug!("an image is still in use after {elapsed:?}");
                return true;
            }
            if elapsed >= allowed {
                return false;
            }
            std::thread::sleep(BETWEEN_LOOKS);
        }
        true
    }
}
