//! A layer that counts live objects and device memory, Parafovea's apart from the application's and the runtime's. It is directly below
//! Parafovea, and `calls` above it identifies the caller. Each vkDeviceWaitIdle of the application appends a line to a file.

mod budget;
mod functions;

use crate::faults::Whose;
use crate::layer::{Layer, NextDevice, Tracked, made_as_asked};
use crate::report;
use ash::vk;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::ffi::CStr;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The variable with the file to which each vkDeviceWaitIdle of the application appends a line, a [`LiveObjects`] as JSON.
pub const LIVE_FILE_VARIABLE: &str = "PARAFOVEA_TEST_LIVE_FILE";

/// The variable with the device memory that the system still has for the process (VK_EXT_memory_budget), bytes; without it, the
/// driver answers.
pub const BUDGET_VARIABLE: &str = "PARAFOVEA_TEST_MEMORY_BUDGET";

/// Objects of a device, and resources of its process.
#[derive(Clone, Default, PartialEq, Debug, Serialize, Deserialize)]
pub struct LiveObjects {
    /// Seconds since the device was made.
    pub seconds: f64,
    /// Resident memory of the process, bytes.
    pub resident: u64,
    /// Threads of the process.
    pub threads: u64,
    /// File descriptors of the process.
    pub descriptors: u64,
    /// Parafovea's.
    pub own: Holdings,
    /// The application's and the runtime's.
    pub application: Holdings,
}

/// Objects of one side.
#[derive(Clone, Default, PartialEq, Debug, Serialize, Deserialize)]
pub struct Holdings {
    /// Device memory, bytes.
    pub memory: u64,
    /// The most device memory since the last line, bytes.
    pub most_memory: u64,
    /// Live objects, by kind.
    pub objects: BTreeMap<String, u64>,
}

impl Holdings {
    /// Live objects of all kinds.
    pub fn count(&self) -> u64 {
        self.objects.values().sum()
    }
}

pub(crate) struct Live {
    next: NextDevice,
    start: Instant,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// By kind and handle.
    objects: HashMap<(&'static str, u64), Object>,
    own: Holdings,
    application: Holdings,
}

struct Object {
    whose: Whose,
    memory: u64,
}

static LIVE: Tracked<Live> = Tracked::new();

impl Live {
    fn over(next: NextDevice) -> Self {
        Self { next, start: Instant::now(), state: Mutex::default() }
    }

    /// An object was made, with so much device memory, by a call of that function.
    fn made(&self, kind: &'static str, handle: u64, whose: Whose, memory: u64) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.objects.insert((kind, handle), Object { whose, memory });
        let holdings = state.of(whose);
        *holdings.objects.entry(kind.to_owned()).or_default() += 1;
        holdings.memory += memory;
        holdings.most_memory = holdings.most_memory.max(holdings.memory);
    }

    fn destroyed(&self, kind: &'static str, handle: u64) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(Object { whose, memory }) = state.objects.remove(&(kind, handle)) {
            let holdings = state.of(whose);
            holdings.memory -= memory;
            if let Some(count) = holdings.objects.get_mut(kind) {
                *count -= 1;
            }
        }
    }

    fn report(&self) {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let number = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key));
            line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0_u64)
        };
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let line = LiveObjects {
            seconds: self.start.elapsed().as_secs_f64(),
            resident: number("VmRSS:") * 1024,
            threads: number("Threads:"),
            // The folder that is read is one itself.
            descriptors: std::fs::read_dir("/proc/self/fd")
                .map_or(0, |all| (all.count() as u64).saturating_sub(1)),
            own: state.own.clone(),
            application: state.application.clone(),
        };
        for whose in [Whose::Own, Whose::Application] {
            let holdings = state.of(whose);
            holdings.most_memory = holdings.memory;
        }
        report::append(LIVE_FILE_VARIABLE, &line);
    }
}

impl State {
    fn of(&mut self, whose: Whose) -> &mut Holdings {
        match whose {
            Whose::Own => &mut self.own,
            Whose::Application => &mut self.application,
        }
    }
}

impl Layer for Live {
    fn tracked() -> &'static Tracked<Self> {
        &LIVE
    }

    made_as_asked!();

    fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
        functions::hook(name)
    }

    fn next(&self) -> &NextDevice {
        &self.next
    }
}
