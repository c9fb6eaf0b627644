//! The timestamps of one command buffer.

use crate::gpu::GpuError;
use ash::vk;
use std::sync::{Mutex, PoisonError};

/// A pool of two queries; destroyed with the last that names it. That is when its command buffer is freed and no submit of it
/// waits to be read, so that the GPU is done with it.
pub struct Queries {
    device: ash::Device,
    pool: vk::QueryPool,
    /// Bits of a timestamp that hold.
    mask: u64,
    /// The latest timestamp that was read.
    latest: Mutex<Option<u64>>,
}

/// Stage at which timestamps are written: after all earlier commands.
const DONE: vk::PipelineStageFlags = vk::PipelineStageFlags::BOTTOM_OF_PIPE;

/// Two timestamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interval {
    /// The first.
    pub begin: u64,
    /// The second.
    pub end: u64,
    /// Bits of both that hold.
    pub mask: u64,
}

impl Interval {
    /// Steps of the clock from the first to the second.
    pub fn steps(&self) -> u64 {
        self.end.wrapping_sub(self.begin) & self.mask
    }

    /// Steps from the beginning of another to that of this one.
    pub fn begin_since(&self, other: &Self) -> i64 {
        let unused = (self.mask & other.mask).leading_zeros();
        // The sign is the highest bit that holds.
        let steps = self.begin.wrapping_sub(other.begin);
        steps.checked_shl(unused).unwrap_or(0).cast_signed().checked_shr(unused).unwrap_or(0)
    }
}

impl Queries {
    /// # Safety
    ///
    /// The device is live, and outlives the result.
    pub unsafe fn new(device: &ash::Device, mask: u64) -> Result<Self, GpuError> {
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2);
        // SAFETY: the device is live, as `# Safety` demands.
        let pool = unsafe { device.create_query_pool(&info, None) };
        let pool = pool.map_err(GpuError::from_call("vkCreateQueryPool"))?;
        Ok(Self { device: device.clone(), pool, mask, latest: Mutex::default() })
    }

    /// Records the first timestamp.
    ///
    /// # Safety
    ///
    /// The command buffer is recording, outside of a render pass, for queues that have timestamps and may reset queries.
    pub unsafe fn begin(&self, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe {
            self.device.cmd_reset_query_pool(commands, self.pool, 0, 2);
            self.device.cmd_write_timestamp(commands, DONE, self.pool, 0);
        }
    }

    /// Records the second timestamp.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin`], which was called for it.
    pub unsafe fn end(&self, commands: vk::CommandBuffer) {
        // SAFETY: as above.
        unsafe { self.device.cmd_write_timestamp(commands, DONE, self.pool, 1) }
    }

    /// The timestamps; `None` while one of them is missing.
    ///
    /// # Errors
    ///
    /// The errors of vkGetQueryPoolResults.
    pub fn interval(&self) -> Result<Option<Interval>, GpuError> {
        let mut results = [0_u64; 2];
        // SAFETY: the pool is live, and has two queries.
        let read = unsafe {
            self.device.get_query_pool_results(self.pool, 0, &mut results, vk::QueryResultFlags::TYPE_64)
        };
        match read {
            Ok(()) => {
                let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
                Ok(interval(results, self.mask, &mut latest))
            }
            Err(vk::Result::NOT_READY) => Ok(None),
            Err(error) => Err(GpuError::from_call("vkGetQueryPoolResults")(error)),
        }
    }
}

/// The interval between two timestamps; nothing while one of them is of an earlier submit: those stay until the GPU comes to reset them. Before
/// the first reset, RADV answers with the zeros of a new pool (`radv_query.c`: available if it is not `UINT64_MAX`).
fn interval([begin, end]: [u64; 2], mask: u64, latest: &mut Option<u64>) -> Option<Interval> {
    if latest.is_none() && (begin == 0 || end == 0) {
        return None;
    }
    if let Some(before) = *latest {
        let is_later = |after: u64| (1..=mask / 2).contains(&(after.wrapping_sub(before) & mask));
        if !is_later(begin) || !is_later(end) {
            return None;
        }
    }
    *latest = Some(end);
    Some(Interval { begin, end, mask })
}

impl Drop for Queries {
    fn drop(&mut self) {
        // SAFETY: nothing that is submitted uses the pool any more.
        unsafe { self.device.destroy_query_pool(self.pool, None) }
    }
}

#[cfg(test)]
mod tests {
    use super::{Interval, interval};

    fn steps(results: [u64; 2], mask: u64, latest: &mut Option<u64>) -> Option<u64> {
        interval(results, mask, latest).map(|interval| interval.steps())
    }

    #[test]
    fn timestamps_of_an_earlier_submit_do_not_count() {
        let mut latest = None;
        assert_eq!(steps([0, 0], u64::MAX, &mut latest), None, "a new pool");
        assert_eq!(steps([10, 0], u64::MAX, &mut latest), None, "under way for the first time");
        assert_eq!(steps([10, 15], u64::MAX, &mut latest), Some(5));
        assert_eq!(steps([10, 15], u64::MAX, &mut latest), None, "not run yet");
        assert_eq!(steps([30, 15], u64::MAX, &mut latest), None, "under way");
        assert_eq!(steps([30, 33], u64::MAX, &mut latest), Some(3));
    }

    #[test]
    fn a_clock_that_starts_over_goes_on() {
        let mut latest = None;
        assert_eq!(steps([250, 253], 0xff, &mut latest), Some(3));
        assert_eq!(steps([254, 4], 0xff, &mut latest), Some(6));
        assert_eq!(steps([254, 4], 0xff, &mut latest), None);
    }

    #[test]
    fn beginnings_are_before_and_after_each_other() {
        for mask in [0xff, u64::MAX >> 28, u64::MAX] {
            let at = |begin: u64| Interval { begin: begin & mask, end: 0, mask };
            let early = at(0_u64.wrapping_sub(3));
            assert_eq!((at(4).begin_since(&early), early.begin_since(&at(4))), (7, -7), "{mask:x}");
        }
        assert_eq!(
            Interval { begin: 1, end: 2, mask: 0 }.begin_since(&Interval { begin: 0, end: 0, mask: 0 }),
            0
        );
    }
}
