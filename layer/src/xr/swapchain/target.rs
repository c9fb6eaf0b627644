//! The runtime's side of a virtual swapchain: its images, of which one at a time is ours to write to.

use crate::kernels::compose::{ComposeRegion, RuntimeImages};
use crate::planner::View;
use crate::xr::dispatch::Next;
use openxr_sys as xr;
use smallvec::SmallVec;
use std::ptr;

/// Time that a frame waits for the runtime to finish with an image, nanoseconds: 2 ms, a fifth of a frame
/// at 90 Hz. After that the last image is submitted again, with its own views.
const PATIENCE_NANOS: i64 = 2_000_000;

/// Room for regions without allocation: four views of two projection layers.
const REGIONS: usize = 8;

/// State of one of the runtime's images between acquire and release.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Held {
    Nothing,
    /// Acquired; waiting for it has timed out so far.
    Acquired(u32),
    /// Waited for: it may be written to.
    Ready(u32),
}

/// A view in which a picture is submitted.
#[derive(Clone, Copy, Debug)]
pub struct SubmittedView {
    /// Number of its layer among the projection layers, and its own in the layer.
    pub place: [usize; 2],
    /// The space of the layer.
    pub space: xr::Space,
    /// Pose and field of view.
    pub view: View,
    /// The part of the image.
    pub sub_image: xr::SwapchainSubImage,
}

/// The runtime's images, and the regions written to the shown one.
pub struct Target {
    images: Option<RuntimeImages>,
    /// Regions to process in this frame.
    pub regions: Vec<ComposeRegion>,
    shown: Vec<ComposeRegion>,
    /// The views of this frame.
    pub views: SmallVec<[SubmittedView; 2]>,
    shown_views: SmallVec<[SubmittedView; 2]>,
    is_late: bool,
    held: Held,
    has_picture: bool,
    is_drawn_over: bool,
}

impl Target {
    /// Of images of which none was ever acquired.
    pub fn new(images: RuntimeImages) -> Self {
        Self {
            images: Some(images),
            regions: Vec::with_capacity(REGIONS),
            shown: Vec::with_capacity(REGIONS),
            views: SmallVec::new(),
            shown_views: SmallVec::new(),
            is_late: false,
            held: Held::Nothing,
            has_picture: false,
            is_drawn_over: false,
        }
    }

    /// The images, until they are let go.
    pub fn images(&self) -> Option<&RuntimeImages> {
        self.images.as_ref()
    }

    /// Lets the images go, after the work of ours that uses them.
    pub fn let_go(&mut self) {
        self.images = None;
    }

    /// Begins a frame, for which the application released a new picture or not.
    pub fn begin(&mut self, is_new: bool) {
        self.regions.clear();
        self.views.clear();
        self.is_late = is_new;
    }

    /// The view of the runtime's picture, in place of this frame's view there; `None` unless the picture of this frame is late.
    pub fn view_of_earlier(
        &self,
        place: [usize; 2],
        space: xr::Space,
        array_layer: u32,
    ) -> Option<&SubmittedView> {
        let is_there = |view: &&SubmittedView| {
            (view.place, view.space, view.sub_image.image_array_index) == (place, space, array_layer)
        };
        self.shown_views.iter().find(is_there).filter(|_| self.is_late)
    }

    /// Whether the runtime has a picture to show.
    pub fn has_picture(&self) -> bool {
        self.has_picture
    }

    /// Whether something may be drawn over that picture for people to see.
    pub fn is_drawn_over(&self) -> bool {
        self.is_drawn_over
    }

    /// Whether [`Self::regions`] differ from the regions of the runtime's picture.
    pub fn is_outdated(&self) -> bool {
        let is_same = |a: &ComposeRegion, b: &ComposeRegion| {
            a.array_layer == b.array_layer
                && a.rect == b.rect
                && bytemuck::bytes_of(&a.params) == bytemuck::bytes_of(&b.params)
        };
        self.regions.len() != self.shown.len()
            || !self.regions.iter().zip(&self.shown).all(|(a, b)| is_same(a, b))
    }

    /// An image to write to; `None` when the runtime still reads it. It stays ours until [`Self::release`].
    ///
    /// The first picture is waited for as long as it takes, as the application would have: without one, the
    /// runtime refuses the frame.
    ///
    /// # Errors
    ///
    /// The errors of `xrAcquireSwapchainImage` and `xrWaitSwapchainImage`.
    pub fn take(&mut self, next: &Next, swapchain: xr::Swapchain) -> Result<Option<u32>, xr::Result> {
        if self.held == Held::Nothing {
            let mut index = 0;
            // SAFETY: the next layer's function, a live swapchain and a place for the index.
            succeeded(unsafe { (next.acquire_swapchain_image)(swapchain, ptr::null(), &mut index) })?;
            self.held = Held::Acquired(index);
        }
        if let Held::Acquired(index) = self.held {
            let timeout = match self.has_picture {
                true => xr::Duration::from_nanos(PATIENCE_NANOS),
                false => xr::Duration::INFINITE,
            };
            let info = xr::SwapchainImageWaitInfo {
                ty: xr::SwapchainImageWaitInfo::TYPE,
                next: ptr::null(),
                timeout,
            };
            // SAFETY: the next layer's function, a live swapchain and a valid structure.
            let waited = succeeded(unsafe { (next.wait_swapchain_image)(swapchain, &info) })?;
            if waited != xr::Result::TIMEOUT_EXPIRED {
                self.held = Held::Ready(index);
            }
        }
        Ok(match self.held {
            Held::Ready(index) => Some(index),
            Held::Nothing | Held::Acquired(_) => None,
        })
    }

    /// Returns the image of [`Self::take`], written with [`Self::regions`]; something may be drawn over it.
    ///
    /// # Errors
    ///
    /// The errors of `xrReleaseSwapchainImage`.
    pub fn release(
        &mut self,
        next: &Next,
        swapchain: xr::Swapchain,
        is_drawn_over: bool,
    ) -> Result<(), xr::Result> {
        // SAFETY: the next layer's function and a live swapchain.
        succeeded(unsafe { (next.release_swapchain_image)(swapchain, ptr::null()) })?;
        self.held = Held::Nothing;
        self.has_picture = true;
        self.is_drawn_over = is_drawn_over;
        self.is_late = false;
        self.shown.clone_from(&self.regions);
        self.shown_views.clone_from(&self.views);
        Ok(())
    }
}

fn succeeded(result: xr::Result) -> Result<xr::Result, xr::Result> {
    if result.into_raw() < 0 { Err(result) } else { Ok(result) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xr::tests::fake::{frames, next_pointer};
    use glam::{Quat, Vec3};
    use openxr_sys::{Handle, pfn};
    use parafovea_core::geometry::Fov;
    use std::ffi::c_void;

    /// The stand-in for the runtime.
    fn next() -> Next {
        // SAFETY: the functions have the types of their names, and the others are never called.
        let next = unsafe {
            Next::load(|name| {
                let known = name.to_str().ok().and_then(frames::function);
                known
                    .or_else(|| Some(std::mem::transmute::<*const c_void, pfn::VoidFunction>(next_pointer())))
            })
        };
        next.unwrap_or_else(|name| panic!("{name:?}"))
    }

    #[test]
    fn a_late_picture_has_the_view_of_the_shown_one() {
        let space = xr::Space::from_raw(7);
        let view = |left| SubmittedView {
            place: [0, 1],
            space,
            view: View {
                orientation: Quat::IDENTITY,
                position: Vec3::ZERO,
                fov: Fov { left, right: 1.0, up: 1.0, down: -1.0 },
            },
            // SAFETY: plain data, for which all zero is a valid value.
            sub_image: unsafe { std::mem::zeroed() },
        };
        let mut target = Target {
            images: None,
            regions: Vec::new(),
            shown: Vec::new(),
            views: SmallVec::new(),
            shown_views: SmallVec::new(),
            is_late: false,
            held: Held::Ready(0),
            has_picture: false,
            is_drawn_over: false,
        };
        let left = |target: &Target, place, space| {
            target.view_of_earlier(place, space, 0).map(|earlier| earlier.view.fov.left)
        };
        target.begin(true);
        target.views.push(view(-1.0));
        assert_eq!(left(&target, [0, 1], space), None, "nothing is shown yet");
        target.release(&next(), xr::Swapchain::from_raw(1), false).unwrap();
        assert_eq!(left(&target, [0, 1], space), None, "the picture of the frame");
        target.begin(true);
        target.views.push(view(-0.5));
        assert_eq!(left(&target, [0, 1], space), Some(-1.0));
        assert_eq!(left(&target, [0, 0], space), None, "another view");
        assert_eq!(left(&target, [0, 1], xr::Space::from_raw(8)), None, "another space");
        target.begin(false);
        assert_eq!(left(&target, [0, 1], space), None, "the application shows its last picture again");
    }
}
