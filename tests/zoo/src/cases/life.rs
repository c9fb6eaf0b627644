//! Resources of a process.

use serde::{Deserialize, Serialize};

/// Resources of the process after one start and end of the application in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Life {
    /// Seconds since the first life began.
    pub seconds: f64,
    /// Resident memory, in bytes.
    pub resident: u64,
    /// Threads.
    pub threads: u64,
    /// File descriptors.
    pub descriptors: u64,
}

impl Life {
    /// Resources of this process now; 0 if `/proc` does not list them.
    pub fn now() -> Self {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let number = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key));
            line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
        };
        let entries = std::fs::read_dir("/proc/self/fd").map_or(0, |entries| entries.count() as u64);
        Self {
            seconds: 0.0,
            resident: number("VmRSS:") * 1024,
            threads: number("Threads:"),
            // The folder that is read is one itself.
            descriptors: entries.saturating_sub(1),
        }
    }
}
