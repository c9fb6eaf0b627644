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
use std::ptr;
use std::sync::{MutexGuard, PoisonError};

impl Swapchain {
    /// Whether the application's release of its next image is held: the layer works on the image when the frame ends. Nothing else is held then.
    pub(super) fn holds_release(&self) -> bool {
        let may_use = self.session.submits_late() && !self.session.is_asleep() && uses_released(self);
        let Some(index) = self.acquired_images().ready().filter(|_| may_use) else { return false };
        *self.held() = Some(index);
        self.acquired_images().released();
        true
    }

    /// Releases the held image, if there is one, after `work` on it.
    pub(super) fn release_held(&self, next: &Next, work: impl FnOnce(u32)) {
        // Of two threads one releases it.
        let Some(index) = self.held().take() else { return };
        work(index);
        let info =
            xr::SwapchainImageReleaseInfo { ty: xr::SwapchainImageReleaseInfo::TYPE, next: ptr::null() };
        // SAFETY: the next layer's function with a live swapchain of the application, which has asked for this call.
        let result = unsafe { (next.release_swapchain_image)(self.handle, &info) };
        if result.into_raw() < 0 {
            tracing::debug!("an image was not returned to the runtime: {result:?}");
        }
    }

    fn held(&self) -> MutexGuard<'_, Option<u32>> {
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
    let of_session =
        |swapchain: &Swapchain| swapchain.session.handle == session.handle && swapchain.held().is_some();
    for swapchain in SWAPCHAINS.filter::<8>(of_session) {
        swapchain.release_held(&session.instance.next, |index| {
            if is_left {
                return;
            }
            // SAFETY: as `# Safety` demands; the image is the application's until it is released.
            attempt("the contrast of an image", || unsafe { analyze_released(&swapchain, index) });
            // SAFETY: as above. The debug view comes last: nothing of it is analysed.
            attempt("the debug view", || unsafe { draw_over_released(&swapchain, index) });
        });
    }
}
