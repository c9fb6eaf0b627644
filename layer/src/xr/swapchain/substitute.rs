//! The parts of a virtual swapchain: our images for the application, and the runtime's images.

use super::history_memory::images;
use super::{Ring, Target};
use crate::gpu::{Gpu, GpuError};
use crate::kernels::analyze;
use crate::kernels::compose::{AppImages, RuntimeImages, SwapchainShape, stores_unit_range};
use crate::status::HistoryTooLarge;
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError};

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
    /// Device memory of the images beyond the runtime's number, which re-use needs, bytes.
    pub history_bytes: u64,
    /// The reason why there are none of those.
    pub refused: Option<HistoryTooLarge>,
    ready: Once,
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
            history_bytes: u64::from(count.saturating_sub(usual)) * app.image_bytes(),
            refused,
            app,
            extent: shape.extent,
            array_layers: shape.array_layers,
            is_unit_range: stores_unit_range(shape.format),
            format: shape.format,
            can_be_analyzed: granted.contains(analyze::USAGE),
            ready: Once::new(),
            ring: Mutex::new(Ring::new(count)),
            target: Mutex::new(Target::new(RuntimeImages::new(gpu, shape, runtime_images)?)),
        })
    }

    /// Prepares our images, the first time it is called: before the application gets one, and where the
    /// queue is ours to use.
    pub fn make_ready(&self) {
        self.ready.call_once(|| {
            // Memory may be short for once.
            if let Err(error) = self.app.make_ready().or_else(|_| self.app.make_ready()) {
                error.log("the images of a virtual swapchain have an undefined layout");
            }
        });
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
