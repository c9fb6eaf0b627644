//! Active sessions: our work on their devices.

use super::shared;
use crate::config::ConfigSnapshot;
use crate::gpu::{Gpu, GpuError};
use crate::inputs::cost::{GpuCost, GpuCosts};
use crate::kernels::compose::Compose;
use crate::link::MOST_FRAME_TIMES;
use crate::status::take_over_decision;
use crate::xr::frame::{DebugViews, ShownEyes};
use crate::xr::plan::SessionPlan;
use crate::xr::vulkan_device::{FrameReport, VulkanDevice};
use smallvec::SmallVec;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A session whose device has both halves.
pub struct Active {
    /// The device.
    pub device: VulkanDevice,
    /// Plan of its frames.
    pub plan: SessionPlan,
    report: Mutex<FrameReport>,
    costs: Mutex<GpuCosts>,
    debug_views: Mutex<DebugViews>,
    shown_eyes: Mutex<ShownEyes>,
    tools: OnceLock<Option<Tools>>,
    health: AtomicU8,
    /// Number of decisions of the Vulkan half that were taken over.
    decisions: AtomicU32,
}

/// Our objects on the device, made when a swapchain first needs them: a session without work has none.
pub struct Tools {
    /// The device and its queue.
    pub gpu: Arc<Gpu>,
    compose: Mutex<Compose>,
}

/// Remaining abilities after failures, best first. A session never gets better again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Health {
    /// Everything.
    Works = 0,
    /// The application's images are delivered unchanged.
    CopyOnly = 1,
    /// No images are delivered: frames with virtual swapchains end without layers, and no new virtual swapchain is created.
    Stopped = 2,
}

impl Active {
    /// Begins with nothing made on the device. `config` holds until the first xrBeginFrame.
    ///
    /// # Safety
    ///
    /// The device is live, and outlives the result, as `XrGraphicsBindingVulkanKHR` demands of a session.
    pub unsafe fn new(device: VulkanDevice, config: Arc<ConfigSnapshot>) -> Self {
        Self {
            device,
            plan: SessionPlan::new(config, device),
            report: Mutex::default(),
            costs: Mutex::default(),
            debug_views: Mutex::default(),
            shown_eyes: Mutex::default(),
            tools: OnceLock::new(),
            health: AtomicU8::new(Health::Works as u8),
            decisions: AtomicU32::new(0),
        }
    }

    /// Our objects on the device; `None`, with one line in the log, where they cannot be made.
    pub fn tools(&self) -> Option<&Tools> {
        let make = || {
            // SAFETY: `new`'s caller vouched for the device. The queue is used in xrAcquireSwapchainImage
            // and xrEndFrame only, where the specification demands that the application keeps off it.
            let gpu =
                unsafe { Gpu::sharing(&self.device.record, self.device.queue, shared::on(&self.device)?) }?;
            Ok(Tools { compose: Mutex::new(Compose::new(Arc::clone(&gpu))?), gpu })
        };
        let make_or_log = || {
            make()
                .inspect_err(|error: &GpuError| {
                    error.log(
                        "re-use, chroma attenuation and debug views are off: the layer cannot create its Vulkan objects on this device",
                    );
                })
                .ok()
        };
        self.tools.get_or_init(make_or_log).as_ref()
    }

    /// Our objects on the device, if they were made.
    pub fn made_tools(&self) -> Option<&Tools> {
        self.tools.get()?.as_ref()
    }

    /// Takes over the Vulkan half's decisions from the last one taken up to number `count`, for `parafovea status`: that half may be another
    /// copy of this library, with a list of its own.
    pub fn take_over_decisions(&self, count: u32) {
        let taken = self.decisions.fetch_max(count, Ordering::Relaxed);
        for decision in (taken..count).map_while(|index| self.device.decision(index)) {
            take_over_decision(&decision);
        }
    }

    /// Memory for the report on a frame: that of the last one.
    pub fn report(&self) -> MutexGuard<'_, FrameReport> {
        self.report.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The costs of earlier frames that became known at the end of this report's frame; the layer's draws there are timed if `is_timed`.
    pub fn gpu_costs(&self, report: &FrameReport, is_timed: bool) -> SmallVec<[GpuCost; MOST_FRAME_TIMES]> {
        let mut costs = self.costs.lock().unwrap_or_else(PoisonError::into_inner);
        report.times.iter().for_each(|&time| costs.add(time));
        let under_way = self.made_tools().and_then(|tools| {
            tools.gpu.set_timed_frame(is_timed.then_some(report.frame));
            tools.gpu.take_times(|time| costs.add_pictures(time.frame, time.ns))
        });
        std::iter::from_fn(|| costs.next(under_way)).take(MOST_FRAME_TIMES).collect()
    }

    /// State of its debug view.
    pub fn debug_views(&self) -> MutexGuard<'_, DebugViews> {
        self.debug_views.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The eye buffers of the last frames.
    pub fn shown_eyes(&self) -> MutexGuard<'_, ShownEyes> {
        self.shown_eyes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Its remaining abilities.
    pub fn health(&self) -> Health {
        match self.health.load(Ordering::Relaxed) {
            0 => Health::Works,
            1 => Health::CopyOnly,
            _ => Health::Stopped,
        }
    }

    /// Gives abilities up after a failure.
    pub fn worsen_to(&self, health: Health) {
        self.health.fetch_max(health as u8, Ordering::Relaxed);
    }
}

impl Tools {
    /// The pass.
    pub fn compose(&self) -> MutexGuard<'_, Compose> {
        self.compose.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The pass, unless another thread has it.
    pub fn free_compose(&self) -> Option<MutexGuard<'_, Compose>> {
        self.compose.try_lock().ok()
    }
}
