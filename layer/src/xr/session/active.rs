//! What an active session has: our work on its device.

use crate::gpu::Gpu;
use crate::inputs::gaze::Hold;
use crate::passes::compose::Compose;
use crate::xr::vulkan_device::VulkanDevice;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A session's work on its device.
pub struct Active {
    /// The device.
    pub device: VulkanDevice,
    /// Our objects on it.
    pub gpu: Arc<Gpu>,
    compose: Mutex<Compose>,
    hold: Mutex<Hold>,
    health: AtomicU8,
}

/// What is still tried after failures, best first. A session never gets better again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Health {
    /// Everything.
    Works = 0,
    /// The application's pictures are delivered as they are.
    CopyOnly = 1,
    /// Not even that: the runtime keeps showing its last pictures.
    Stopped = 2,
}

impl Active {
    /// Prepares work on the device; `None`, with a line in the log, where that is not possible.
    ///
    /// # Safety
    ///
    /// The device is live, and outlives the session, as `XrGraphicsBindingVulkanKHR` demands.
    pub unsafe fn new(device: VulkanDevice) -> Option<Self> {
        let (family, index) = device.queue;
        // SAFETY: the caller vouches for the device. The queue is used in xrAcquireSwapchainImage and
        // xrEndFrame only, where the specification demands that the application keeps off it.
        let gpu = unsafe { Gpu::new(&device.record, family, index) };
        let made = gpu.and_then(|gpu| Ok((Arc::clone(&gpu), Compose::new(gpu)?)));
        let (gpu, compose) = made.inspect_err(|error| tracing::error!("session inert: {error}")).ok()?;
        Some(Self {
            device,
            gpu,
            compose: Mutex::new(compose),
            hold: Mutex::default(),
            health: AtomicU8::new(Health::Works as u8),
        })
    }

    /// The pass.
    pub fn compose(&self) -> MutexGuard<'_, Compose> {
        self.compose.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The gaze of the frames before.
    pub fn hold(&self) -> MutexGuard<'_, Hold> {
        self.hold.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What may be tried.
    pub fn health(&self) -> Health {
        match self.health.load(Ordering::Relaxed) {
            0 => Health::Works,
            1 => Health::CopyOnly,
            _ => Health::Stopped,
        }
    }

    /// Gives up what failed.
    pub fn worsen_to(&self, health: Health) {
        self.health.fetch_max(health as u8, Ordering::Relaxed);
    }
}
