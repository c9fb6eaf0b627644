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
    /// Number of frames in a row in which the application took its next image before it ended the frame, or ended none.
    early_frames: u32,
}

/// Early frames in a row after which nothing is held any more.
const MOST_EARLY_FRAMES: u32 = 3;

impl Swapchain {
    /// Whether the application's release of its image is held: the layer works on the image when the frame ends. Not with several images at a time:
    /// another one can be waited for only after the release.
    pub(super) fn holds_release(&self) -> bool {
        let may_use = self.session.submits_late() && !self.session.is_asleep() && uses_released(self);
        if !may_use || self.held().early_frames >= MOST_EARLY_FRAMES {
            return false;
        }
        let Some(index) = self.acquired_images().ready_alone() else { return false };
        self.held().index = Some(index);
        self.acquired_images().released();
        true
    }

    /// Releases the held image, if any, before the frame has ended. After [`MOST_EARLY_FRAMES`] in a row nothing is held any more.
    pub(super) fn release_early(&self, next: &Next) {
        let mut held = self.held();
        if held.index.is_none() {
            return;
        }
        held.early_frames += 1;
        if held.early_frames == MOST_EARLY_FRAMES {
            tracing::info!(
                "rings instead of rates by contrast in a swapchain, and no debug views: the application acquires its next image before it ends \
                 the frame"
            );
        }
        self.release(next, &mut held);
    }

    /// Releases the held image.
    fn release(&self, next: &Next, held: &mut Held) {
        held.index = None;
        let info =
            xr::SwapchainImageReleaseInfo { ty: xr::SwapchainImageReleaseInfo::TYPE, next: ptr::null() };
        // SAFETY: the next layer's function with a live swapchain of the application, which has asked for this call; destroying it waits for
        // the lock of `held`.
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
    let swapchains = SWAPCHAINS.filter::<8>(|swapchain| swapchain.session.handle == session.handle);
    // Locked until all is done: no other thread releases or destroys them meanwhile.
    let mut all: SmallVec<[(&Swapchain, u32, MutexGuard<'_, Held>); 8]> = SmallVec::new();
    for swapchain in &swapchains {
        let held = swapchain.held();
        if let Some(index) = held.index {
            all.push((swapchain, index, held));
        }
    }
    if !is_left {
        let images: SmallVec<[(&Swapchain, u32); 8]> =
            all.iter().map(|(swapchain, index, _)| (*swapchain, *index)).collect();
        // SAFETY: as `# Safety` demands; the images are the application's until they are released.
        attempt("the contrast of images", || unsafe { analyze_released(&images) });
    }
    for (swapchain, index, held) in &mut all {
        if !is_left {
            // SAFETY: as above. The debug view comes last: nothing of it is analysed.
            attempt("the debug view", || unsafe { draw_over_released(swapchain, *index) });
        }
        held.early_frames = 0;
        swapchain.release(&session.instance.next, held);
    }
}
