//! Swapchains: passed through, or *virtual* (substituted).
//!
//! A virtual swapchain's handle is the runtime's, but its images are ours. Acquire, wait and release run on
//! our own ring; the runtime's images are taken and returned in [`super::frame`].

mod acquired_images;
mod create;
mod depth;
mod description;
mod drawn_over;
mod eligibility;
mod eye_sizes;
mod free;
mod held_release;
mod history_memory;
mod images;
mod retired;
mod ring;
mod substitute;
mod target;

pub use create::create;
pub use depth::NewestDepth;
pub use held_release::release_held;
pub use images::{acquire_image, enumerate_images, release_image, wait_image};
pub use retired::destroy_retired;
pub use ring::Newest;
pub use substitute::Substitute;
pub use target::{SubmittedView, Target};

use super::dispatch::Next;
use super::instance::next_of_any;
use super::session::Session;
use crate::abi::{attempt, guard};
use crate::config::longest_period;
use crate::registry::Registry;
use crate::status::HistoryTooLarge;
use acquired_images::AcquiredImages;
use ash::vk;
use depth::Depth;
use description::Description;
use drawn_over::DrawnOver;
use held_release::Held;
use openxr_sys as xr;
use openxr_sys::Handle;
use ring::Ring;
use smallvec::SmallVec;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A swapchain of a session that is not inert.
pub struct Swapchain {
    /// Its handle, for the application and for the runtime.
    pub handle: xr::Swapchain,
    session: Arc<Session>,
    /// Our images, if it is virtual.
    pub substitute: Option<Substitute>,
    description: Description,
    acquired_images: Mutex<AcquiredImages>,
    drawn_over: Mutex<DrawnOver>,
    depth: Mutex<Depth>,
    /// The image whose release is held until the frame ends.
    held: Mutex<Held>,
    /// The images that the application draws to, once it has them.
    images: Mutex<SmallVec<[vk::Image; 4]>>,
}

impl Swapchain {
    fn new(
        session: &Arc<Session>,
        handle: xr::Swapchain,
        description: Description,
        substitute: Option<Substitute>,
    ) -> Self {
        Self {
            handle,
            session: Arc::clone(session),
            substitute,
            description,
            acquired_images: Mutex::default(),
            drawn_over: Mutex::default(),
            depth: Mutex::default(),
            held: Mutex::default(),
            images: Mutex::default(),
        }
    }

    /// Its session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Size and array layers of its images.
    pub fn extent_and_layers(&self) -> (vk::Extent2D, u32) {
        self.description.extent_and_layers()
    }

    fn images(&self) -> MutexGuard<'_, SmallVec<[vk::Image; 4]>> {
        self.images.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn acquired_images(&self) -> MutexGuard<'_, AcquiredImages> {
        self.acquired_images.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The image that the application released last.
    fn newest_image(&self) -> Option<u32> {
        match &self.substitute {
            Some(substitute) => substitute.ring().newest().map(|newest| newest.index),
            None => self.acquired_images().newest(),
        }
    }

    /// Sends the Vulkan half the application's images, once.
    fn notify_images(&self, images: &[vk::Image]) {
        let is_new = {
            let mut known = self.images();
            let is_new = known.is_empty() && !images.is_empty();
            if is_new {
                *known = images.into();
            }
            is_new
        };
        if is_new {
            self.notify(images);
        }
    }

    /// Notes that the application has room for these images of a virtual swapchain alone.
    fn keeps_only(&self, images: &[vk::Image]) {
        let before = std::mem::replace(&mut *self.images(), images.into()).len();
        self.notify(images);
        let count = images.len();
        let keeps = count > longest_period(&self.session.instance.config.snapshot()) as usize;
        let re_use = if keeps { "less room for re-use" } else { "no re-use" };
        tracing::info!("{re_use} in a swapchain: the application takes {count} of {before} images");
    }

    /// The image of that number, and its format, if it is the runtime's and can be analysed.
    pub fn readable_image(&self, index: u32) -> Option<(vk::Image, vk::Format)> {
        let format = self.description.analyzed_format()?;
        Some((*self.images().get(index as usize)?, format))
    }

    /// Notifies the Vulkan half that the images are about to be destroyed.
    fn notify_end(&self) {
        let images = std::mem::take(&mut *self.images());
        if !images.is_empty() {
            self.notify(&[]);
        }
    }

    /// Ends our part in it, before it is destroyed: waits for work of ours that still uses the runtime's images.
    fn end(&self) {
        self.end_holding();
        self.notify_end();
        self.end_drawing_over();
        self.end_keeping_depth();
        if let Some(substitute) = &self.substitute {
            substitute.target().let_go();
        }
    }

    fn notify(&self, images: &[vk::Image]) {
        let Some(active) = &self.session.active else { return };
        let is_virtual = self.substitute.is_some();
        let record =
            self.description.record(self.handle.into_raw(), images, is_virtual, self.session.has_backend());
        // SAFETY: the record points to `images`.
        unsafe { active.device.notify_swapchain(&record) };
    }
}

static SWAPCHAINS: Registry<xr::Swapchain, Swapchain> = Registry::new();

/// The virtual swapchains of a session. Allocates nothing for up to eight.
pub fn virtual_ones(session: xr::Session) -> SmallVec<[Arc<Swapchain>; 8]> {
    SWAPCHAINS.filter(|swapchain| swapchain.session.handle == session && swapchain.substitute.is_some())
}

/// Whether a session has swapchains, and none of them is virtual.
pub fn are_all_real(session: xr::Session) -> bool {
    let of_session = SWAPCHAINS.filter::<8>(|swapchain| swapchain.session.handle == session);
    !of_session.is_empty() && of_session.iter().all(|swapchain| swapchain.substitute.is_none())
}

/// Whether a session has no swapchains yet, or one that keeps its images for that number of frames.
pub fn keep_for(session: xr::Session, frames: u32) -> bool {
    let of_session = SWAPCHAINS.filter::<8>(|swapchain| swapchain.session.handle == session);
    let keeps = |swapchain: &Arc<Swapchain>| {
        let substitute = swapchain.substitute.as_ref();
        substitute.is_some_and(|substitute| substitute.ring().count() > u64::from(frames))
    };
    of_session.is_empty() || of_session.iter().any(keeps)
}

/// Device memory of the pictures that the swapchains of a session keep for re-use, and of their depth, bytes, and why one of them keeps none.
pub fn history_memory(session: xr::Session) -> (u64, Option<HistoryTooLarge>) {
    let of_session = SWAPCHAINS.filter::<8>(|swapchain| swapchain.session.handle == session);
    of_session.iter().fold((0, None), |(bytes, refused), swapchain| {
        let bytes = bytes + swapchain.depth_bytes();
        swapchain.substitute.as_ref().map_or((bytes, refused), |substitute| {
            (bytes + substitute.history_bytes(), refused.or(substitute.refused))
        })
    })
}

/// Forgets the swapchains of a session, before it is destroyed: they go with it. Our images go with the result, which is to be dropped after
/// the session was destroyed: runtimes wait for the device's work then.
pub fn forget_all_of(session: xr::Session) -> Vec<Arc<Swapchain>> {
    let mut gone = SWAPCHAINS.remove_where(|swapchain| swapchain.session.handle == session);
    gone.iter().for_each(|swapchain| swapchain.end());
    gone.extend(retired::take_all_of(session));
    gone
}

/// The image of that swapchain that the application released last, if that is known.
pub fn newest_image(handle: xr::Swapchain) -> Option<u32> {
    SWAPCHAINS.get(handle)?.newest_image()
}

/// The depth of the image of that swapchain that the application released last, for an eye's view, if it was copied; from then on it is.
pub fn newest_depth(handle: xr::Swapchain) -> Option<NewestDepth> {
    SWAPCHAINS.get(handle)?.newest_depth()
}

/// The swapchain of that handle, if it is tracked, and the functions below.
fn find(handle: xr::Swapchain) -> Option<(Option<Arc<Swapchain>>, Next)> {
    let known = SWAPCHAINS.get(handle);
    let next = known.as_ref().map(|known| known.session.instance.next).or_else(next_of_any)?;
    Some((known, next))
}

/// `xrDestroySwapchain`. Our work on the runtime's images ends first. Our images go after the call, as runtimes wait for the device's work in it, or
/// some frames later.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn destroy(handle: xr::Swapchain) -> xr::Result {
    let Some((known, next)) = find(handle) else { return xr::Result::ERROR_HANDLE_INVALID };
    // SAFETY: the next layer's function with the application's own argument.
    let below = || unsafe { (next.destroy_swapchain)(handle) };
    let end = || {
        SWAPCHAINS.remove(handle);
        if let Some(known) = &known {
            known.end();
        }
    };
    let pass_through = || {
        attempt("xrDestroySwapchain", end);
        below()
    };
    guard("xrDestroySwapchain", pass_through, |answer| {
        let _section = known.as_ref().and_then(|known| known.session.runtime_section());
        end();
        let result = answer.record(below());
        if let Some(known) = &known {
            retired::retire(known);
        }
        result
    })
}
