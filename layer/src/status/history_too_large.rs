//! Reasons why re-use keeps no pictures of a swapchain.

use std::fmt;

/// The pictures would take too much of the remaining device memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryTooLarge {
    /// Memory that the pictures would take, bytes.
    pub needs: u64,
    /// Memory that the system still has for the process, bytes.
    pub remaining: u64,
    /// They may take one part in so many of it.
    pub share: u64,
}

impl fmt::Display for HistoryTooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [needs, remaining] = [self.needs, self.remaining].map(|bytes| bytes as f64 / f64::from(1 << 20));
        let share = self.share;
        write!(
            f,
            "its history would take {needs:.1} MiB, more than 1/{share} of the {remaining:.1} MiB of device memory that remain (VK_EXT_memory_budget)"
        )
    }
}
