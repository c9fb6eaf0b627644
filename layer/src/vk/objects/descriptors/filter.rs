//! A filter of handles.

use std::sync::atomic::{AtomicU8, Ordering};

/// Handles that may be of interest: none that is, is missing. A counting Bloom filter with one hash (Fan et al., Summary Cache, 2000).
pub struct Filter([AtomicU8; Filter::PLACES]);

impl Filter {
    const PLACES: usize = 1 << 16;

    fn place(&self, handle: u64) -> &AtomicU8 {
        // Fibonacci hashing: 2^64 divided by the golden ratio (Knuth, The Art of Computer Programming 3, 6.4). Sixteen bits are left.
        &self.0[(handle.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) as usize]
    }

    /// Adds a handle.
    pub fn add(&self, handle: u64) {
        let more = |count: u8| count.checked_add(1);
        let _ = self.place(handle).fetch_update(Ordering::Relaxed, Ordering::Relaxed, more);
    }

    /// Removes a handle that was added. A place that was full once stays so.
    pub fn remove(&self, handle: u64) {
        let fewer = |count: u8| if count == u8::MAX { None } else { count.checked_sub(1) };
        let _ = self.place(handle).fetch_update(Ordering::Relaxed, Ordering::Relaxed, fewer);
    }

    /// Whether a handle may have been added.
    pub fn may_have(&self, handle: u64) -> bool {
        self.place(handle).load(Ordering::Relaxed) != 0
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self([const { AtomicU8::new(0) }; Self::PLACES])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handles_of_one_place_are_counted() {
        let filter = Filter::default();
        let many = u32::from(u8::MAX) + 2;
        for count in [1, 3, u32::from(u8::MAX) - 1, many] {
            (0..count).for_each(|_| filter.add(7));
            (1..count).for_each(|_| filter.remove(7));
            assert!(filter.may_have(7) && !filter.may_have(8));
            filter.remove(7);
            assert_eq!(filter.may_have(7), count == many, "{count} handles");
        }
    }
}
