//! The parts of a virtual swapchain: our images for the application, and the runtime's images.

use super::history_memory::images;
use super::{Ring, Target};
use crate::gpu::{Gpu, GpuError};
use crate::kernels::analyze;
use crate::kernels::compose::{AppImages, RuntimeImages, SwapchainShape, stores_unit_range};
use crate::status::HistoryTooLarge;
use ash::vk;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Numbers of virtual swapchains: handles are used again.
static NUMBER: AtomicU64 = AtomicU64::new(0);

/// Both sides of a virtual swapchain.
pub struct Substitute {
    /// Its number, which no other ever has.
    pub number: u64,
    /// The images that the application draws to.
    pub app: AppImages,
    /// Size of an image, pixels.
    pub extent: vk::Extent2D,
    /// Array layers of an image.
    pub array_layers: u32,
    /// Whether an image stores values from 0 to 1 only.
    pub is_unit_range: bool,
    /// Format of the swapchain.
    pub format: vk::Format,
    /// Whether the runtime's images can be analysed.
    pub can_be_analyzed: bool,
    /// The reason why there are no images beyond the runtime's number.
    pub refused: Option<HistoryTooLarge>,
    /// Number of the runtime's images.
    usual: u32,
    /// Whether the application has the images.
    is_enumerated: AtomicBool,
    preparation: Preparation,
    ring: Mutex<Ring>,
    target: Mutex<Target>,
}

impl Substitute {
    /// Makes as many images as the runtime has, and at least `least` where their memory is not a burden. The runtime's may be used for `granted`.
    ///
    /// # Errors
    ///
    /// Images cannot be made, or the runtime's not be drawn to.
    pub fn new(
        gpu: &Arc<Gpu>,
        shape: &SwapchainShape,
        (runtime_images, granted): (Vec<vk::Image>, vk::ImageUsageFlags),
        least: u32,
    ) -> Result<Self, GpuError> {
        let usual = runtime_images.len() as u32;
        let mut refused = None;
        let app = AppImages::with_count(gpu, shape, |memory| {
            images(usual, least, memory).unwrap_or_else(|reason| {
                refused = Some(reason);
                usual
            })
        })?;
        let count = app.images().len() as u32;
        Ok(Self {
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            refused,
            usual,
            is_enumerated: AtomicBool::new(false),
            app,
            extent: shape.extent,
            array_layers: shape.array_layers,
            is_unit_range: stores_unit_range(shape.format),
            format: shape.format,
            can_be_analyzed: granted.contains(analyze::USAGE),
            preparation: Preparation::default(),
            ring: Mutex::new(Ring::new(count)),
            target: Mutex::new(Target::new(RuntimeImages::new(gpu, shape, runtime_images)?)),
        })
    }

    /// The images for an application with room for `capacity`. Images beyond the runtime's number are for re-use alone, so an application with
    /// room for that number gets no more than fit, unless it has more already or a submit may use them. `keep` takes the images that are
    /// kept, before the others are destroyed.
    pub fn images_within(&self, capacity: u32, keep: impl FnOnce(&[vk::Image])) -> &[vk::Image] {
        let may_shrink = capacity >= self.usual
            && !self.is_enumerated.load(Ordering::Relaxed)
            && !self.preparation.is_done();
        if may_shrink && self.ring().shrink(capacity) {
            keep(&self.app.images()[..capacity as usize]);
            self.app.shrink(capacity);
        }
        let images = self.app.images();
        self.is_enumerated.fetch_or(capacity as usize >= images.len(), Ordering::Relaxed);
        images
    }

    /// Device memory of the images beyond the runtime's number, which re-use needs, bytes.
    pub fn history_bytes(&self) -> u64 {
        (self.app.images().len() as u64).saturating_sub(self.usual.into()) * self.app.image_bytes()
    }

    /// Prepares our images that the application has not had yet, until that succeeds: before the application gets one, and where the
    /// queue is ours to use.
    pub fn make_ready(&self) {
        self.preparation.attempt(|| self.app.make_ready(self.ring().given_out()));
    }

    /// The application's side.
    pub fn ring(&self) -> MutexGuard<'_, Ring> {
        self.ring.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The runtime's side.
    pub fn target(&self) -> MutexGuard<'_, Target> {
        self.target.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Preparation of images, which may fail for a while.
#[derive(Default)]
struct Preparation {
    is_done: Mutex<bool>,
}

impl Preparation {
    /// Whether they were prepared.
    fn is_done(&self) -> bool {
        *self.lock()
    }

    fn lock(&self) -> MutexGuard<'_, bool> {
        self.is_done.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Prepares them, unless that has succeeded before.
    fn attempt(&self, prepare: impl Fn() -> Result<(), GpuError>) {
        let mut is_done = self.lock();
        if *is_done {
            return;
        }
        // Memory may be short for once.
        match prepare().or_else(|_| prepare()) {
            Ok(()) => *is_done = true,
            Err(error) => error.log("an image of a virtual swapchain has an undefined layout"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn images_are_prepared_once_the_device_comes_again() {
        let (preparation, tries) = (Preparation::default(), Cell::new(0));
        let prepare = |result| {
            preparation.attempt(|| {
                tries.set(tries.get() + 1);
                result
            });
            tries.take()
        };
        assert_eq!(prepare(Err(GpuError::Timeout)), 2);
        assert_eq!(prepare(Ok(())), 1, "tried again");
        assert_eq!(prepare(Ok(())), 0);
    }
}
