//! The OpenXR half's plans for a device's frames, and the application's events since the last frame ended.

mod awaited;
mod log;
mod map_content;
#[cfg(debug_assertions)]
mod passes_file;
#[cfg(not(debug_assertions))]
#[path = "frame/no_passes_file.rs"]
mod passes_file;
mod plan;
mod rest;
mod swapchains;

pub use awaited::Awaited;
pub use log::Log;
pub use map_content::MapContent;
pub use plan::Plan;
#[cfg(test)]
pub use plan::tests::plan_of_two_tiles;

use super::objects::Objects;
use crate::link::{PlanRecord, ShownViewRecord};
use crate::pass_detection::{Eye, Shown, ShownView, SwapchainKey};
use ash::vk;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use swapchains::Swapchains;

/// State of the current frame. All of it is changed in place, so that a steady frame allocates nothing.
#[derive(Default)]
pub struct Frame {
    /// The plan that the OpenXR half makes.
    pub awaited: Awaited,
    plan: Mutex<Plan>,
    /// [`Plan::serial`] of the newest plan, to be looked at without the lock.
    serial: AtomicU64,
    /// Whether it makes anything coarser that is rendered, the same way.
    coarsens: AtomicBool,
    swapchains: Mutex<Swapchains>,
    log: Mutex<Log>,
    shown: Mutex<Shown>,
    is_on: AtomicBool,
    /// [`Log::rests`], to be looked at without the lock.
    rests: AtomicBool,
}

impl Frame {
    /// Takes a newer plan, with the rates of both eyes; one that is not newer changes nothing.
    pub fn set_plan(&self, record: &PlanRecord, rates: [&[u8]; 2]) {
        let mut plan = lock(&self.plan);
        plan.take(record, rates);
        self.coarsens.store(plan.coarsens(), Ordering::Relaxed);
        self.serial.store(plan.serial(), Ordering::Release);
    }

    /// Notes that the GPU decides the rates of both eyes again: all maps are out of date. Returns their next serial.
    pub fn decided(&self) -> u64 {
        let mut plan = lock(&self.plan);
        plan.decided();
        self.serial.store(plan.serial(), Ordering::Release);
        plan.serial()
    }

    /// The newest plan.
    pub fn plan(&self) -> MutexGuard<'_, Plan> {
        lock(&self.plan)
    }

    /// [`Plan::serial`] of the newest plan; 0 before the first.
    pub fn plan_serial(&self) -> u64 {
        self.serial.load(Ordering::Acquire)
    }

    /// Whether the newest plan makes anything coarser that is rendered.
    pub fn coarsens(&self) -> bool {
        self.coarsens.load(Ordering::Relaxed)
    }

    /// Takes the images of a swapchain, or, without any, forgets it; returns its former images.
    pub fn set_swapchain(&self, swapchain: SwapchainKey, images: &[vk::Image]) -> Vec<vk::Image> {
        if images.is_empty() {
            lock(&self.log).forget_swapchain(swapchain);
        }
        lock(&self.swapchains).take(swapchain, images)
    }

    /// The application's events since the last frame ended.
    pub fn log(&self) -> MutexGuard<'_, Log> {
        lock(&self.log)
    }

    /// Whether passes that are recognised get the plan's rates.
    pub fn is_on(&self) -> bool {
        self.is_on.load(Ordering::Relaxed)
    }

    /// Whether recognition learns from the current frame.
    pub fn learns(&self) -> bool {
        lock(&self.log).learns()
    }

    /// Ends a frame with its submission: views of projection layers, swapchains of other layers, and those submitted as depth.
    pub fn shown(&self, objects: &Objects, views: &[ShownViewRecord], flat: &[u64], depth: &[u64]) {
        let mut shown = lock(&self.shown);
        let swapchains = lock(&self.swapchains);
        let image = |view: &ShownViewRecord| {
            let image = swapchains.image(SwapchainKey(view.swapchain), view.image_index)?;
            Some(objects.image(image)?.description.key)
        };
        shown.views.clear();
        shown.views.extend(views.iter().map(|view| ShownView { image: image(view), ..shown_view(view) }));
        shown.flat.clear();
        shown.flat.extend(flat.iter().copied().map(SwapchainKey));
        shown.depth.clear();
        shown.depth.extend(depth.iter().copied().map(SwapchainKey));
        drop(swapchains);
        let mut log = lock(&self.log);
        log.end_frame(objects, &shown);
        self.rests.store(log.rests(), Ordering::Relaxed);
    }

    /// So many frames have ended without a submission to take, ahead of the one that ends now.
    pub fn skip(&self, frames: u32) {
        if frames > 0 {
            lock(&self.log).skip(frames);
        }
    }

    /// Ends a frame from which recognition does not learn.
    pub fn end_unlearned(&self, objects: &Objects) {
        let mut log = lock(&self.log);
        log.begin_next(objects);
        self.rests.store(log.rests(), Ordering::Relaxed);
    }

    /// Takes whether the gates rest from the current frame on.
    pub fn set_resting(&self, rests: bool) {
        let mut log = lock(&self.log);
        log.set_resting(rests);
        self.rests.store(log.rests(), Ordering::Relaxed);
    }

    /// Whether commands that are recorded now may go untracked.
    pub fn rests(&self) -> bool {
        self.rests.load(Ordering::Relaxed)
    }

    /// Takes whether passes that are recognised get the plan's rates.
    pub fn set_on(&self, is_on: bool) {
        if self.is_on.swap(is_on, Ordering::Relaxed) != is_on {
            // The gate changes it for a few frames now and then; decisions of the user and the gate are logged where they are made.
            tracing::debug!("shading rates {}", if is_on { "on" } else { "off" });
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
