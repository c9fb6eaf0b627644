//! One virtual swapchain in one frame.

use super::history::ShownEyeBuffer;
use super::regions::{Images, rect_within, region};
use crate::kernels::change::ChangeRegion;
use crate::kernels::compose::{ComposeJob, ReuseRegion, RuntimeImages};
use crate::xr::dispatch::Next;
use crate::xr::spaces::rests;
use crate::xr::submission::ProjectionView;
use crate::xr::swapchain::{Newest, Substitute, Swapchain, Target};
use crate::xr::vulkan_device::VulkanDevice;
use ash::vk;
use openxr_sys as xr;
use parafovea_core::chroma::{ChromaSettings, Focus};
use parafovea_core::geometry;
use smallvec::SmallVec;
use std::ops::Range;
use std::sync::MutexGuard;

/// Regions of a frame with re-use, eye by eye. Kilobytes, so never moved.
#[derive(Default)]
pub struct Regions<'a> {
    /// Regions that are completed from earlier pictures.
    pub reuse: SmallVec<[ReuseRegion<'a>; 2]>,
    /// Regions that are compared with earlier pictures.
    pub changes: SmallVec<[ChangeRegion<'a>; 2]>,
}

/// The work on a virtual swapchain.
pub struct Work<'a> {
    /// The swapchain.
    pub swapchain: &'a Swapchain,
    /// The runtime's side of it, locked for the frame.
    pub target: MutexGuard<'a, Target>,
    /// Whether a projection layer of this frame shows it.
    pub is_projected: bool,
    /// Its part of [`Regions::reuse`].
    pub reuse: Range<usize>,
    /// Its part of [`Regions::changes`].
    pub changes: Range<usize>,
    substitute: &'a Substitute,
    newest: Newest,
    runtime_index: u32,
}

impl<'a> Work<'a> {
    /// Begins with nothing to process; `None` if the application has released nothing yet, or destroys the swapchain on another thread.
    pub fn begin(swapchain: &'a Swapchain) -> Option<Self> {
        let substitute = swapchain.substitute.as_ref()?;
        let newest = substitute.ring().newest()?;
        let mut target = substitute.target();
        target.images()?;
        target.begin(newest.fresh);
        Some(Self {
            swapchain,
            target,
            is_projected: false,
            reuse: 0..0,
            changes: 0..0,
            substitute,
            newest,
            runtime_index: 0,
        })
    }

    /// Asks in which layouts the application left its images: the newest, if it is new. With DXVK also earlier ones, as games copy them to
    /// their windows after the release, and DXVK leaves them so.
    pub fn ask_layouts(&self, device: &VulkanDevice) {
        let newest = self.newest.fresh.then_some(self.newest.index);
        let asked = match device.submits_late() {
            true => 0..self.substitute.ring().given_out(),
            false => newest.map_or(0..0, |newest| newest..newest + 1),
        };
        for index in asked {
            if let Some(image) = self.substitute.app.images().get(index as usize) {
                self.substitute.app.left_in(index, device.layout(*image));
            }
        }
    }

    /// Format of its images.
    pub fn format(&self) -> vk::Format {
        self.substitute.format
    }

    /// Adds the rectangle that `view` shows.
    pub fn process(&mut self, view: &ProjectionView, focus: Focus, chroma: &ChromaSettings) {
        let region = region(view, &self.images(), focus, chroma);
        self.target.regions.extend(region);
    }

    /// The picture that `view` shows; `None` if its rectangle or orientation is invalid, or if it is upside down, as no plan is.
    pub fn picture(&self, view: &ProjectionView, space: xr::Space, time: xr::Time) -> Option<ShownEyeBuffer> {
        if view.fov.up < view.fov.down {
            return None;
        }
        let rect = rect_within(&view.sub_image, &self.images())?;
        let plane = view.fov.tangents().plane([rect.extent.width, rect.extent.height]);
        Some(ShownEyeBuffer {
            substitute: self.substitute.number,
            space,
            rests: rests(space),
            time,
            release: self.newest.release,
            is_copied: false,
            image_index: self.newest.index,
            array_layer: view.sub_image.image_array_index,
            rect,
            view: geometry::View { orientation: view.orientation?, plane },
        })
    }

    /// The picture of `view` once the job is done, in the runtime's image: the image, its format, and the rectangle in it. `None` if it
    /// cannot be read there, or the application has released nothing new.
    pub fn finished(&self, view: &ProjectionView) -> Option<(vk::Image, vk::Format, vk::Rect2D)> {
        let rect = rect_within(&view.sub_image, &self.images())?;
        let image = *self.target.images()?.images().get(self.runtime_index as usize)?;
        (self.newest.fresh && self.substitute.can_be_analyzed).then_some((
            image,
            self.substitute.format,
            rect,
        ))
    }

    /// Place of `sub_image` once the job is done: the runtime's images, the index of the image, and the rectangle in it. `None` if the
    /// rectangle is not within the images, or the images were let go.
    pub fn written(&self, sub_image: &xr::SwapchainSubImage) -> Option<(&RuntimeImages, u32, vk::Rect2D)> {
        let rect = rect_within(sub_image, &self.images())?;
        Some((self.target.images()?, self.runtime_index, rect))
    }

    /// Whether the picture of a release is still there.
    pub fn is_intact(&self, release: u64) -> bool {
        self.substitute.ring().is_intact(release)
    }

    /// Whether pictures stay for so many frames.
    pub fn keeps(&self, frames: u32) -> bool {
        // While the application draws the next one.
        self.substitute.ring().count() > u64::from(frames)
    }

    fn images(&self) -> Images {
        let Substitute { extent, array_layers, is_unit_range, .. } = *self.substitute;
        Images { extent, array_layers, is_unit_range }
    }

    /// Whether the runtime's picture has to be written. A picture that the application released is written even if no known layer shows it.
    /// An earlier picture is written only if a projection layer shows it again, it is intact, and none of it comes from other pictures, which
    /// may be lost. A drawing over a picture may have changed since, or may have to go.
    pub fn is_due(&self, is_drawn_over: bool) -> bool {
        let may_be_redone = self.is_projected && self.newest.intact && self.reuse.start == self.reuse.end;
        let is_other = self.target.is_outdated() || is_drawn_over || self.target.is_drawn_over();
        self.newest.fresh || (may_be_redone && is_other)
    }

    /// Takes an image of the runtime to write to; false when there is none now. Errors are the session's
    /// end, of which the application learns from its own calls.
    pub fn take_image(&mut self, next: &Next) -> bool {
        let taken = self.target.take(next, self.swapchain.handle);
        match taken {
            Ok(index) => {
                self.runtime_index = index.unwrap_or_default();
                index.is_some()
            }
            Err(result) => {
                tracing::debug!("the runtime provided no image: {result:?}");
                false
            }
        }
    }

    /// The job for the GPU, with the frame's regions.
    pub fn job<'b>(&'b self, regions: &'b Regions<'_>) -> Option<ComposeJob<'b>> {
        Some(ComposeJob {
            app: &self.substitute.app,
            app_index: self.newest.index,
            runtime: self.target.images()?,
            runtime_index: self.runtime_index,
            regions: &self.target.regions,
            reuse: regions.reuse.get(self.reuse.clone())?,
            changes: regions.changes.get(self.changes.clone())?,
        })
    }

    /// Whether the runtime has a picture to show.
    pub fn has_picture(&self) -> bool {
        self.target.has_picture()
    }

    /// Gives the written image back to the runtime, to be shown; something may be drawn over it.
    pub fn return_image(&mut self, next: &Next, is_drawn_over: bool) {
        match self.target.release(next, self.swapchain.handle, is_drawn_over) {
            Ok(()) => self.substitute.ring().mark_shown(self.newest.release),
            Err(result) => tracing::debug!("an image was not returned to the runtime: {result:?}"),
        }
    }
}
