//! The sets of a descriptor pool.

use ash::vk;
use rustc_hash::FxHashMap;

/// Sets of a pool since it was made or reset.
#[derive(Debug, Default)]
pub struct Allocated {
    /// All of them, some freed since.
    pub sets: Vec<vk::DescriptorSet>,
    /// Sets that were freed one by one, some of them made again since.
    pub freed: Vec<vk::DescriptorSet>,
    /// Number of live sets when they were counted last.
    live: usize,
}

impl Allocated {
    /// Fewer handles are never searched for repeated ones.
    pub const LEAST: usize = 1 << 12;

    /// Sets are made.
    pub fn add(&mut self, sets: &[vk::DescriptorSet]) {
        if self.sets.len() + sets.len() > (2 * self.live).max(Self::LEAST) {
            self.leave_out_freed();
        }
        self.sets.extend_from_slice(sets);
    }

    /// Leaves out freed sets.
    pub fn leave_out_freed(&mut self) {
        let mut counts: FxHashMap<vk::DescriptorSet, i64> = FxHashMap::default();
        self.sets.iter().for_each(|set| *counts.entry(*set).or_default() += 1);
        self.freed.iter().for_each(|set| *counts.entry(*set).or_default() -= 1);
        self.freed.clear();
        self.sets.clear();
        self.sets.extend(counts.into_iter().filter(|(_, count)| *count > 0).map(|(set, _)| set));
        self.live = self.sets.len();
    }

    /// All sets are gone.
    pub fn clear(&mut self) {
        self.sets.clear();
        self.freed.clear();
    }
}
