//! The plan of a frame, made by whichever thread comes first: that of the session, or one of the application's that needs it.

use super::SERIAL;
use crate::abi::attempt;
use crate::config::{Config, ConfigSnapshot};
use crate::inputs::gaze::Look;
use crate::link::FrameStart;
use crate::planner::{Capabilities, SessionPlanner, View};
use crate::xr::frame::{History, SortedTiles, sort_ahead};
use crate::xr::vulkan_device::VulkanDevice;
use glam::Quat;
use smallvec::SmallVec;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

/// State that plans are made from, and the device that gets them.
pub struct PlanWork {
    device: VulkanDevice,
    planner: Mutex<SessionPlanner>,
    history: Mutex<History>,
    sorted: Mutex<SortedTiles>,
    has_failed: AtomicBool,
}

/// A frame to plan.
pub struct FrameTask {
    /// The configuration of the frame.
    pub config: Arc<ConfigSnapshot>,
    /// Its display time, nanoseconds.
    pub time_ns: i64,
    /// The inputs of its plan; `None` if it has one.
    pub inputs: Option<PlanInputs>,
    /// Its views, if the tiles of its pictures can be sorted ahead; else none.
    pub expected: SmallVec<[View; 4]>,
}

/// The inputs of a plan that [`SessionPlanner`] has not taken already.
#[derive(Clone, Copy, Debug)]
pub struct PlanInputs {
    /// Whether images can be composed.
    pub can_attenuate: bool,
    /// From the space of the head to one that rests in the world.
    pub head: Quat,
    /// The answer of the eye tracker.
    pub look: Look,
}

/// The planner takes the answer of the eye tracker for `time_ns`, with this orientation of the head.
pub fn follow(planner: &mut SessionPlanner, config: &Config, look: Look, head: Quat, time_ns: i64) {
    if let Some(reason) = planner.look(config, look, head, time_ns) {
        tracing::info!("a gaze sample was rejected: {reason}");
    }
}

impl PlanWork {
    /// Without a frame, for a device.
    pub fn new(device: VulkanDevice) -> Self {
        Self {
            planner: Mutex::new(SessionPlanner::new(Capabilities::from(&device.capabilities))),
            device,
            history: Mutex::default(),
            sorted: Mutex::default(),
            has_failed: AtomicBool::new(false),
        }
    }

    /// The planner, whether or not the plan of the frame is made.
    pub fn planner(&self) -> MutexGuard<'_, SessionPlanner> {
        self.planner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The session's last pictures.
    pub fn history(&self) -> MutexGuard<'_, History> {
        self.history.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The same; `None` while another thread has it.
    pub fn free_history(&self) -> Option<MutexGuard<'_, History>> {
        match self.history.try_lock() {
            Ok(history) => Some(history),
            Err(TryLockError::Poisoned(history)) => Some(history.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// The tiles of expected pictures that were sorted last.
    pub fn sorted(&self) -> MutexGuard<'_, SortedTiles> {
        self.sorted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The device of the session.
    pub fn device(&self) -> &VulkanDevice {
        &self.device
    }

    /// Whether planning panicked once: it is then turned off.
    pub fn has_failed(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }

    /// Gives planning up.
    pub fn fail(&self) {
        self.has_failed.store(true, Ordering::Relaxed);
    }

    /// Plans a frame, and hands its rates to the Vulkan half. Calls neither the runtime nor Vulkan.
    pub fn plan(&self, task: &FrameTask) {
        let Some(PlanInputs { can_attenuate, head, look }) = task.inputs.filter(|_| !self.has_failed())
        else {
            return;
        };
        let mut is_made = false;
        attempt("the plan of a frame", || {
            let mut planner = self.planner();
            follow(&mut planner, &task.config, look, head, task.time_ns);
            if planner.plan(&task.config, can_attenuate, head, task.time_ns) {
                let serial = || SERIAL.fetch_add(1, Ordering::Relaxed) + 1;
                if let Some(record) = planner.new_rates(&task.config, serial) {
                    let start = FrameStart { settings: ptr::null(), plan: &record, awaited: ptr::null() };
                    // SAFETY: the record points to `planner`'s memory, which is locked. The Vulkan half copies it, and makes no callbacks.
                    unsafe { self.device.begin_frame(&start) };
                }
            }
            is_made = true;
        });
        if !is_made {
            self.fail();
        }
    }

    /// Sorts the tiles of the frame's expected pictures.
    pub fn sort(&self, task: &FrameTask) {
        if !task.expected.is_empty() && !self.has_failed() {
            attempt("the tiles of a frame", || sort_ahead(self, &task.config, &task.expected));
        }
    }
}
