//! The GPU time of our submits: a timestamp ahead of each one's commands and one behind them, while it is requested.

use super::GpuError;
use super::slots::SLOTS;
use ash::vk;
use smallvec::SmallVec;

/// GPU time of a submit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SubmitTime {
    /// The frame that it belongs to.
    pub(crate) frame: u64,
    /// Nanoseconds.
    pub(crate) ns: u64,
}

/// Stage at which timestamps are written: after all earlier commands.
const DONE: vk::PipelineStageFlags = vk::PipelineStageFlags::BOTTOM_OF_PIPE;

/// Number of times that are kept until they are taken.
const MOST_KEPT: usize = 64;

// Room for the times of all submits under way.
const _: () = assert!(MOST_KEPT >= 2 * SLOTS);

/// The times of a ring of command buffers. Allocates nothing as long as they are taken.
pub(super) struct SubmitTimes {
    /// Two queries for each command buffer; null until times are requested.
    pool: vk::QueryPool,
    /// Valid bits of timestamps (`timestampValidBits`); 0: there are none.
    valid_bits: u64,
    /// Nanoseconds of a step.
    step_ns: f64,
    /// The frame that submits belong to; `None` while times are not requested.
    frame: Option<u64>,
    /// The frame of each command buffer whose timestamps were not read.
    unread: [Option<u64>; SLOTS],
    known: SmallVec<[SubmitTime; MOST_KEPT]>,
}

impl SubmitTimes {
    /// For a queue with timestamps of so many bits, of a device whose clock has steps of `step_ns` nanoseconds.
    pub(super) fn new(valid_bits: u32, step_ns: f32) -> Self {
        Self {
            pool: vk::QueryPool::null(),
            valid_bits: u64::MAX.checked_shr(u64::BITS.saturating_sub(valid_bits)).unwrap_or(0),
            step_ns: f64::from(step_ns),
            frame: None,
            unread: [None; SLOTS],
            known: SmallVec::new(),
        }
    }

    /// From now on submits belong to that frame; `None`: they are not timed.
    pub(super) fn set_frame(&mut self, frame: Option<u64>) {
        self.frame = frame;
    }

    /// Whether submits are timed.
    pub(super) fn is_timed(&self) -> bool {
        self.frame.is_some() && self.valid_bits != 0
    }

    /// A command buffer begins.
    ///
    /// # Safety
    /// It is that of this number, and is recording, outside of a render pass, on a queue that may reset queries; the device is live.
    pub(super) unsafe fn begin(&mut self, device: &ash::Device, commands: vk::CommandBuffer, index: usize) {
        self.unread[index] = self.frame.filter(|_| self.valid_bits != 0);
        if self.unread[index].is_none() {
            return;
        }
        if self.pool == vk::QueryPool::null() {
            let count = 2 * SLOTS as u32;
            let info =
                vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(count);
            // SAFETY: the device is live, as `# Safety` demands.
            match unsafe { device.create_query_pool(&info, None) } {
                Ok(pool) => self.pool = pool,
                Err(result) => {
                    GpuError::Call { call: "vkCreateQueryPool", result }
                        .log("the layer's own work is not timed");
                    self.valid_bits = 0;
                    self.unread[index] = None;
                    return;
                }
            }
        }
        let first = 2 * index as u32;
        // SAFETY: the command buffer is recording, as `# Safety` demands; the pool has as many queries.
        unsafe {
            device.cmd_reset_query_pool(commands, self.pool, first, 2);
            device.cmd_write_timestamp(commands, DONE, self.pool, first);
        }
    }

    /// A command buffer ends.
    ///
    /// # Safety
    /// As for [`Self::begin`], which was called for it.
    pub(super) unsafe fn end(&self, device: &ash::Device, commands: vk::CommandBuffer, index: usize) {
        if self.unread[index].is_some() {
            // SAFETY: as above.
            unsafe { device.cmd_write_timestamp(commands, DONE, self.pool, 2 * index as u32 + 1) };
        }
    }

    /// A command buffer was not submitted.
    pub(super) fn forget(&mut self, index: usize) {
        self.unread[index] = None;
    }

    /// Whether the timestamps of a command buffer are to be read.
    pub(super) fn is_unread(&self, index: usize) -> bool {
        self.unread[index].is_some()
    }

    /// A command buffer has finished on the GPU.
    pub(super) fn finished(&mut self, device: &ash::Device, index: usize) {
        let Some(frame) = self.unread[index].take() else { return };
        let mut results = [0_u64; 2];
        // SAFETY: the pool is live, and has as many queries.
        let read = unsafe {
            device.get_query_pool_results(
                self.pool,
                2 * index as u32,
                &mut results,
                vk::QueryResultFlags::TYPE_64,
            )
        };
        if read.is_ok() {
            let steps = results[1].wrapping_sub(results[0]) & self.valid_bits;
            self.add(SubmitTime { frame, ns: (steps as f64 * self.step_ns) as u64 });
        }
    }

    /// Adds a time; the oldest is dropped if too many were not taken.
    fn add(&mut self, time: SubmitTime) {
        if self.known.len() == MOST_KEPT {
            self.known.remove(0);
        }
        self.known.push(time);
    }

    /// Takes the known times; returns the first frame with an unfinished submit.
    pub(super) fn take(&mut self, add: impl FnMut(SubmitTime)) -> Option<u64> {
        self.known.drain(..).for_each(add);
        self.unread.iter().flatten().min().copied()
    }

    /// # Safety
    /// The device is live, and nothing that was timed is under way on it.
    pub(super) unsafe fn destroy(&self, device: &ash::Device) {
        // SAFETY: the device is live, as `# Safety` demands.
        unsafe { device.destroy_query_pool(self.pool, None) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_nobody_takes_are_dropped() {
        let mut times = SubmitTimes::new(64, 1.0);
        (0..100).for_each(|frame| times.add(SubmitTime { frame, ns: 1 }));
        times.unread[0] = Some(100);
        times.unread[2] = Some(99);
        let mut taken = Vec::new();
        assert_eq!(times.take(|time| taken.push(time.frame)), Some(99));
        assert!(taken.iter().copied().eq(100 - MOST_KEPT as u64..100), "{taken:?}");
        assert!(!times.known.spilled());
        times.unread = [None; SLOTS];
        assert_eq!(times.take(|time| taken.push(time.frame)), None);
        assert_eq!(taken.len(), MOST_KEPT);
    }
}
