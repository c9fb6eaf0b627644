//! The runtime's images of a swapchain that is not virtual, for draws over one before the application returns it.

use super::Swapchain;
use super::create::runtime_images;
use crate::gpu::Gpu;
use crate::kernels::compose::RuntimeImages;
use std::sync::{Arc, MutexGuard, PoisonError};

/// Whether they can be drawn over; unknown until it is first asked for.
#[derive(Default)]
pub enum DrawnOver {
    #[default]
    Unknown,
    Unavailable,
    Available(RuntimeImages),
}

impl Swapchain {
    /// Calls `draw` with the runtime's images; `None`, with a line in the log once, if they cannot be drawn over.
    pub fn draw_over<T>(&self, gpu: &Arc<Gpu>, draw: impl FnOnce(&RuntimeImages) -> T) -> Option<T> {
        let is_new = matches!(*self.drawn_over(), DrawnOver::Unknown);
        if is_new {
            // Made without the lock, which is not held across calls down.
            let made = self.make_drawn_over(gpu);
            *self.drawn_over() = made;
        }
        match &*self.drawn_over() {
            DrawnOver::Available(images) => Some(draw(images)),
            DrawnOver::Unknown | DrawnOver::Unavailable => None,
        }
    }

    fn make_drawn_over(&self, gpu: &Arc<Gpu>) -> DrawnOver {
        let make = || {
            let shape = self.description.drawn_over().map_err(str::to_owned)?;
            let images = runtime_images(&self.session, self.handle)
                .map_err(|result| format!("xrEnumerateSwapchainImages returned {result:?}"))?;
            RuntimeImages::new(gpu, &shape, images).map_err(|error| error.to_string())
        };
        let (extent, layers) = self.description.extent_and_layers();
        match make() {
            Ok(images) => DrawnOver::Available(images),
            Err(reason) => {
                let (width, height) = (extent.width, extent.height);
                tracing::warn!(
                    "debug.view is not drawn on a swapchain of {width}x{height}x{layers}: {reason}"
                );
                DrawnOver::Unavailable
            }
        }
    }

    /// Lets the images go, after the work of ours that uses them.
    pub(super) fn end_drawing_over(&self) {
        let images = std::mem::replace(&mut *self.drawn_over(), DrawnOver::Unavailable);
        drop(images);
    }

    fn drawn_over(&self) -> MutexGuard<'_, DrawnOver> {
        self.drawn_over.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
