//! Destroyed virtual swapchains whose images stay for a few frames.
//!
//! An application destroys a swapchain once its own commands have finished (OpenXR specification, xrDestroySwapchain), but with DXVK and vkd3d
//! these commands may still wait for their submit on another thread, and name our images. wineopenxr flushes them in a later release or
//! xrEndFrame.

use super::Swapchain;
use crate::xr::session::Session;
use openxr_sys as xr;
use std::sync::{Arc, Mutex, PoisonError};

/// Frames for which images stay: in the first all commands are submitted, and two more are in flight on the GPU at most.
const FRAMES: u32 = 3;

static RETIRED: Mutex<Retired<Arc<Swapchain>>> = Mutex::new(Retired { all: Vec::new() });

/// Swapchains by session, with their remaining frames.
struct Retired<T> {
    all: Vec<(xr::Session, u32, T)>,
}

impl<T> Retired<T> {
    fn add(&mut self, session: xr::Session, swapchain: T) {
        self.all.push((session, FRAMES, swapchain));
    }

    /// A frame of a session has ended. Returns the swapchains that have no frames left.
    fn frame_ended(&mut self, session: xr::Session) -> Vec<T> {
        for (of, remaining, _) in &mut self.all {
            *remaining -= u32::from(*of == session);
        }
        self.take(|_, remaining| remaining == 0)
    }

    /// Removes all swapchains of a session.
    fn take_all_of(&mut self, session: xr::Session) -> Vec<T> {
        self.take(|of, _| of == session)
    }

    fn take(&mut self, is_taken: impl Fn(xr::Session, u32) -> bool) -> Vec<T> {
        let taken = self.all.extract_if(.., |(of, remaining, _)| is_taken(*of, *remaining));
        taken.map(|(.., swapchain)| swapchain).collect()
    }
}

/// Keeps the images of a swapchain that was destroyed, if commands may come that use them.
pub(super) fn retire(swapchain: &Arc<Swapchain>) {
    let session = &swapchain.session;
    if session.submits_late() && swapchain.substitute.is_some() {
        RETIRED.lock().unwrap_or_else(PoisonError::into_inner).add(session.handle, Arc::clone(swapchain));
    }
}

/// Destroys the images of swapchains that were destroyed some frames ago, as a frame ends.
pub fn destroy_retired(session: &Session) {
    if session.submits_late() {
        // Destroyed without the lock.
        let gone = RETIRED.lock().unwrap_or_else(PoisonError::into_inner).frame_ended(session.handle);
        drop(gone);
    }
}

/// The retired swapchains of a session that ends.
pub(super) fn take_all_of(session: xr::Session) -> Vec<Arc<Swapchain>> {
    RETIRED.lock().unwrap_or_else(PoisonError::into_inner).take_all_of(session)
}

#[cfg(test)]
mod tests {
    use super::*;
    use openxr_sys::Handle;

    #[test]
    fn images_stay_for_three_frames_of_their_session_or_until_it_ends() {
        let [one, other] = [1, 2].map(xr::Session::from_raw);
        let mut retired = Retired { all: Vec::new() };
        retired.add(one, "old");
        retired.add(other, "other");
        assert!(retired.frame_ended(one).is_empty());
        retired.add(one, "new");
        assert!(retired.frame_ended(one).is_empty());
        assert_eq!(retired.frame_ended(one), ["old"]);
        assert_eq!(retired.frame_ended(one), ["new"]);
        assert!(retired.frame_ended(other).is_empty());
        assert_eq!(retired.take_all_of(other), ["other"]);
        assert!(retired.take_all_of(other).is_empty());
    }
}
