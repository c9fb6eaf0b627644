//! Releases of images that are held until xrEndFrame.
//!
//! DXVK and vkd3d submit on threads of their own, and versions of wineopenxr flush their work and lock the queue in xrEndFrame only. There an
//! image can be analysed or drawn over, if the runtime does not have it yet.

use super::{SWAPCHAINS, Swapchain};
use crate::abi::attempt;
use crate::xr::dispatch::Next;
use crate::xr::frame::{analyze_released, draw_over_released, uses_released};
use crate::xr::session::Session;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;
use std::sync::{MutexGuard, PoisonError};

/// The image whose release is held.
#[derive(Debug, Default)]
pub struct Held {
    index: Option<u32>,
    /// Whether nothing is held any more: the application takes its next image before the frame ends.
    is_given_up: bool,
}

impl Swapchain {
    /// Whether the application's release of its image is held: the layer works on the image when the frame ends. Not with several images at a time:
    /// another one can be waited for only after the release.
    pub(super) fn holds_release(&self) -> bool {
        let may_use = self.session.submits_late() && !self.session.is_asleep() && uses_released(self);
        if !may_use || self.held().is_given_up {
            return false;
        }
        let Some(index) = self.acquired_images().ready_alone() else { return false };
        self.held().index = Some(index);
        self.acquired_images().released();
        true
    }

    /// Releases the held image, if there is one, before the frame has ended, and holds no further ones.
    pub(super) fn give_up_holding(&self, next: &Next) {
        if self.held().index.is_none() {
            return;
        }
        self.held().is_given_up = true;
        tracing::info!(
            "rates by eccentricity alone in a swapchain: the application takes its next image before it ends the frame"
        );
        self.release_held(next, |_| {});
    }

    /// Releases the held image, if there is one, after `work` on it. The swapchain is not destroyed meanwhile.
    fn release_held(&self, next: &Next, work: impl FnOnce(u32)) {
        let mut held = self.held();
        // Of two threads one releases it.
        let Some(index) = held.index.take() else { return };
        work(index);
        let info =
            xr::SwapchainImageReleaseInfo { ty: xr::SwapchainImageReleaseInfo::TYPE, next: ptr::null() };
        // SAFETY: the next layer's function with a live swapchain of the application, which has asked for this call.
        let result = unsafe { (next.release_swapchain_image)(self.handle, &info) };
        if result.into_raw() < 0 {
            tracing::debug!("an image was not returned to the runtime: {result:?}");
        }
    }

    /// Holds nothing any more, as the swapchain is about to be destroyed, with all of its images.
    pub(super) fn end_holding(&self) {
        self.held().index = None;
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Works on the held images of a session, unless it is to leave them as they are, and releases them.
///
/// # Safety
///
/// This thread may use the session's queue, to which all work of the application was submitted.
pub unsafe fn release_held(session: &Session, is_left: bool) {
    if !session.submits_late() {
        return;
    }
    let of_session = |swapchain: &Swapchain| {
        swapchain.session.handle == session.handle && swapchain.held().index.is_some()
    };
    let swapchains = SWAPCHAINS.filter::<8>(of_session);
    let images: SmallVec<[(&Swapchain, u32); 8]> =
        swapchains.iter().filter_map(|swapchain| Some((&**swapchain, swapchain.held().index?))).collect();
    if !is_left {
        // SAFETY: as `# Safety` demands; the images are the application's until they are released.
        attempt("the contrast of images", || unsafe { analyze_released(&images) });
    }
    for (swapchain, _) in images {
        swapchain.release_held(&session.instance.next, |index| {
            if !is_left {
                // SAFETY: as above. The debug view comes last: nothing of it is analysed.
                attempt("the debug view", || unsafe { draw_over_released(swapchain, index) });
            }
        });
    }
}
