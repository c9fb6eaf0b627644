//! What the OpenXR half told of a device's frames.

mod plan;
mod swapchains;

use plan::Plan;
use swapchains::Swapchains;

use crate::link::{PlanRecord, SettingsRecord, ShownViewRecord, SwapchainRecord};
use crate::scene::{Eye, Shown, ShownView, SwapchainKey};
use ash::vk;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What holds for the frame under way. All of it is changed in place, so that a steady frame allocates nothing.
#[derive(Debug, Default)]
pub struct Frame {
    plan: Mutex<Plan>,
    swapchains: Mutex<Swapchains>,
    shown: Mutex<Shown>,
    is_on: AtomicBool,
}

impl Frame {
    /// Takes a newer plan, with the rates of both eyes. One that is not newer, or makes no sense, changes nothing.
    pub fn set_plan(&self, record: &PlanRecord, rates: [&[u8]; 2]) {
        let mut plan = lock(&self.plan);
        let taken = plan.take(record, rates);
        tracing::trace!("plan {} (taken: {taken}): {plan:?}", record.serial);
    }

    /// Takes the images of a swapchain, or, without any, forgets it.
    pub fn swapchain(&self, record: &SwapchainRecord, images: &[vk::Image]) {
        let mut swapchains = lock(&self.swapchains);
        swapchains.take(SwapchainKey(record.swapchain), images);
        tracing::trace!("swapchains: {swapchains:?}");
    }

    /// Ends a frame with what it shows: views of projection layers, swapchains of other layers, and those submitted
    /// as depth.
    pub fn shown(&self, views: &[ShownViewRecord], flat: &[u64], depth: &[u64]) {
        let mut shown = lock(&self.shown);
        shown.views.clear();
        shown.views.extend(views.iter().map(shown_view));
        shown.flat.clear();
        shown.flat.extend(flat.iter().copied().map(SwapchainKey));
        shown.depth.clear();
        shown.depth.extend(depth.iter().copied().map(SwapchainKey));
        tracing::trace!("shown: {shown:?}");
    }

    /// Takes what shall be done.
    pub fn set_settings(&self, record: &SettingsRecord) {
        let is_on = record.is_on != 0;
        if self.is_on.swap(is_on, Ordering::Relaxed) != is_on {
            tracing::info!("shading rates {}", if is_on { "on" } else { "off" });
        }
    }
}

fn shown_view(record: &ShownViewRecord) -> ShownView {
    ShownView {
        eye: match record.eye {
            0 => Some(Eye::Left),
            1 => Some(Eye::Right),
            _ => None,
        },
        swapchain: SwapchainKey(record.swapchain),
        image: None,
        layer: record.layer,
        rect: record.rect,
        is_upside_down: record.is_upside_down != 0,
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
