//! The timestamps of one command buffer.

use crate::gpu::GpuError;
use ash::vk;
use std::sync::{Mutex, PoisonError};

/// A pool of two queries; destroyed with the last that names it. That is when its command buffer is freed and no submit of it
/// waits to be read, so that the GPU is done with it.
pub struct Queries {
    device: ash::Device,
    pool: vk::QueryPool,
    /// Valid bits of timestamps (`timestampValidBits`).
    valid_bits: u64,
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
    /// Valid bits of both (`timestampValidBits`).
    pub valid_bits: u64,
}

impl Interval {
    /// Steps of the clock from the first to the second.
    pub fn steps(&self) -> u64 {
        self.end.wrapping_sub(self.begin) & self.valid_bits
    }

    /// Steps from the beginning of another to that of this one.
    pub fn begin_since(&self, other: &Self) -> i64 {
        let unused = (self.valid_bits & other.valid_bits).leading_zeros();
        // The sign is the highest valid bit.
        let steps = self.begin.wrapping_sub(other.begin);
        steps.checked_shl(unused).unwrap_or(0).cast_signed().checked_shr(unused).unwrap_or(0)
    }
}

impl Queries {
    /// # Safety
    ///
    /// The device is live, and outlives the result.
    pub unsafe fn new(device: &ash::Device, valid_bits: u64) -> Result<Self, GpuError> {
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2);
        // SAFETY: the device is live, as `# Safety` demands.
        let pool = unsafe { device.create_query_pool(&info, None) };
        let pool = pool.map_err(GpuError::from_call("vkCreateQueryPool"))?;
        Ok(Self { device: device.clone(), pool, valid_bits, latest: Mutex::default() })
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
                Ok(interval(results, self.valid_bits, &mut latest))
            }
            Err(vk::Result::NOT_READY) => Ok(None),
            Err(error) => Err(GpuError::from_call("vkGetQueryPoolResults")(error)),
        }
    }
}

/// The interval between two timestamps; nothing while one of them is of an earlier submit: those stay until the GPU comes to reset them. Before
/// the first reset, RADV answers with the zeros of a new pool (`radv_query.c`: available if it is not `UINT64_MAX`).
fn interval([begin, end]: [u64; 2], valid_bits: u64, latest: &mut Option<u64>) -> Option<Interval> {
    if latest.is_none() && (begin == 0 || end == 0) {
        return None;
    }
    if let Some(before) = *latest {
        let is_later = |after: u64| (1..=valid_bits / 2).contains(&(after.wrapping_sub(before) & valid_bits));
        if !is_later(begin) || !is_later(end) {
            return None;
        }
    }
    *latest = Some(end);
    Some(Interval { begin, end, valid_bits })
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

    fn steps(results: [u64; 2], valid_bits: u64, latest: &mut Option<u64>) -> Option<u64> {
        interval(results, valid_bits, latest).map(|interval| interval.steps())
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
        for valid_bits in [0xff, u64::MAX >> 28, u64::MAX] {
            let at = |begin: u64| Interval { begin: begin & valid_bits, end: 0, valid_bits };
            let early = at(0_u64.wrapping_sub(3));
            assert_eq!((at(4).begin_since(&early), early.begin_since(&at(4))), (7, -7), "{valid_bits:x}");
        }
        assert_eq!(
            Interval { begin: 1, end: 2, valid_bits: 0 }.begin_since(&Interval {
                begin: 0,
                end: 0,
                valid_bits: 0
            }),
            0
        );
    }
}
