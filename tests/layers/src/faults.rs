//! Two layers that make chosen calls fail: `faults`, directly below Parafovea, fails them, and `calls`, above Parafovea,
//! identifies the caller. A call that reaches `faults` while the same call of the application, or of the runtime, goes through
//! `calls` is that call; every other is Parafovea's own. Without `calls` all are taken to be its own.

mod functions;

use crate::layer::{Layer, NextDevice, Tracked, made_as_asked};
use crate::{report, variable};
use ash::vk;
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ffi::CStr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The variable with the fault to inject, a [`VulkanFault`] as JSON; without it calls are only counted.
pub const FAULT_VARIABLE: &str = "PARAFOVEA_TEST_FAULT";

/// The variable with the file to which each device appends a line, a [`FaultReport`] as JSON, when it is destroyed.
pub const FAULT_FILE_VARIABLE: &str = "PARAFOVEA_TEST_FAULT_FILE";

/// Caller whose calls fail.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Whose {
    /// Parafovea's own.
    Own,
    /// Calls of the application and of the runtime.
    Application,
}

/// A fault: so many calls of a function fail.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct VulkanFault {
    /// The function, such as `vkCreateImage`.
    pub call: String,
    /// Its result, a negative `VkResult`. After `VK_ERROR_DEVICE_LOST` (-4) the device stays lost: every submit, every wait and every look
    /// at a fence returns it.
    pub result: i32,
    /// Caller.
    pub whose: Whose,
    /// Number of these calls that succeed before.
    pub skip: u64,
    /// Number of calls that fail then; calls after them succeed.
    pub count: u64,
}

/// Calls that reached one device.
#[derive(Clone, Default, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct FaultReport {
    /// Parafovea's own calls of functions that can fail, by name.
    pub own: BTreeMap<String, u64>,
    /// Of these, the calls on threads of Parafovea, where neither application nor runtime has called.
    pub own_on_threads: BTreeMap<String, u64>,
    /// Calls of the application and of the runtime.
    pub application: BTreeMap<String, u64>,
    /// Failed calls, except calls on a lost device.
    pub failed: u64,
}

/// A call: its function, and a key that distinguishes calls of that function. The key of submits is the fence: Parafovea's own work has
/// fences of its own.
#[derive(Clone, Copy, PartialEq)]
struct Call {
    name: &'static CStr,
    mark: u64,
}

thread_local! {
    /// The application's call that goes through Parafovea on this thread.
    static PASSING: Cell<Option<Call>> = const { Cell::new(None) };
    /// Whether calls of this thread are a stand-in's for a driver.
    static OF_STAND_IN: Cell<bool> = const { Cell::new(false) };
    /// Whether this thread is the application's, or the runtime's.
    static IS_OTHERS: Cell<bool> = const { Cell::new(false) };
}

/// Caller of a call that has come down.
fn whose(call: Call) -> Whose {
    match PASSING.get() {
        Some(passing) if passing == call => {
            PASSING.set(None);
            Whose::Application
        }
        _ => Whose::Own,
    }
}

/// Caller of a call of that function that has come down, unless it is a submit. To be asked once a call.
pub(crate) fn whose_call(name: &'static CStr) -> Whose {
    if OF_STAND_IN.get() { Whose::Application } else { whose(Call { name, mark: 0 }) }
}

/// As long as it lives, calls of this thread that come down are none of Parafovea's: a test layer stands in for a driver.
pub(crate) struct StandIn(());

impl StandIn {
    pub fn new() -> Self {
        OF_STAND_IN.set(true);
        Self(())
    }
}

impl Drop for StandIn {
    fn drop(&mut self) {
        OF_STAND_IN.set(false);
    }
}

/// The layer above Parafovea.
pub(crate) struct Calls {
    next: NextDevice,
}

static CALLS: Tracked<Calls> = Tracked::new();

impl Calls {
    fn over(next: NextDevice) -> Self {
        Self { next }
    }
}

impl Layer for Calls {
    fn tracked() -> &'static Tracked<Self> {
        &CALLS
    }

    made_as_asked!();

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        functions::hook::<Self>(name)
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }
}

/// Handling of a call by one of the layers.
trait Side: Layer {
    /// Makes it by `next`, or fails, and then sets its outputs to null by `null`.
    fn made(&self, call: Call, next: impl FnOnce() -> vk::Result, null: impl FnOnce()) -> vk::Result;
}

impl Side for Calls {
    fn made(&self, call: Call, next: impl FnOnce() -> vk::Result, _: impl FnOnce()) -> vk::Result {
        let outer = PASSING.replace(Some(call));
        IS_OTHERS.set(true);
        let result = next();
        PASSING.set(outer);
        result
    }
}

/// The layer below Parafovea.
pub(crate) struct Faults {
    next: NextDevice,
    fault: Option<VulkanFault>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    report: FaultReport,
    is_lost: bool,
}

static FAULTS: Tracked<Faults> = Tracked::new();

impl Faults {
    fn over(next: NextDevice) -> Self {
        let fault = variable::read(FAULT_VARIABLE, |text| serde_json::from_str(text));
        Self { next, fault, state: Mutex::default() }
    }
}

impl Layer for Faults {
    fn tracked() -> &'static Tracked<Self> {
        &FAULTS
    }

    made_as_asked!();

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        functions::hook::<Self>(name)
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }

    fn device_destroyed(&self) {
        report::append(FAULT_FILE_VARIABLE, &self.state().report);
    }
}

/// Functions that fail on a lost device (Vulkan specification, "Lost Device").
const LOST: [&CStr; 8] = [
    c"vkDeviceWaitIdle",
    c"vkGetFenceStatus",
    c"vkGetQueryPoolResults",
    c"vkQueueSubmit",
    c"vkQueueSubmit2",
    c"vkQueueSubmit2KHR",
    c"vkQueueWaitIdle",
    c"vkWaitForFences",
];

impl Side for Faults {
    fn made(&self, call: Call, next: impl FnOnce() -> vk::Result, null: impl FnOnce()) -> vk::Result {
        let Some(failure) = self.failure(call) else { return next() };
        if call.name == c"vkEndCommandBuffer" {
            // Recording has ended all the same (Vulkan specification, "Command Buffer Lifecycle").
            _ = next();
        }
        null();
        failure
    }
}

impl Faults {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a call, and returns the result with which it is to fail, if any.
    fn failure(&self, call: Call) -> Option<vk::Result> {
        let whose = whose(call);
        let name = call.name.to_str().unwrap_or_default();
        let mut state = self.state();
        if whose == Whose::Own && !IS_OTHERS.get() {
            *state.report.own_on_threads.entry(name.to_owned()).or_default() += 1;
        }
        let counts = match whose {
            Whose::Own => &mut state.report.own,
            Whose::Application => &mut state.report.application,
        };
        let count = counts.entry(name.to_owned()).or_default();
        *count += 1;
        let before = *count - 1;
        if state.is_lost && LOST.contains(&call.name) {
            return Some(vk::Result::ERROR_DEVICE_LOST);
        }
        let fault = self.fault.as_ref().filter(|fault| fault.call == name && fault.whose == whose)?;
        if !(fault.skip..fault.skip.saturating_add(fault.count)).contains(&before) {
            return None;
        }
        state.report.failed += 1;
        let result = vk::Result::from_raw(fault.result);
        if result == vk::Result::ERROR_DEVICE_LOST {
            state.is_lost = true;
            // A lost device has no more work: the objects that it used may be destroyed.
            // SAFETY: the device is live; tests submit on one thread.
            let _ = unsafe { self.next.functions.device_wait_idle() };
        }
        Some(result)
    }
}
