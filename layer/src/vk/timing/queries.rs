//! The timestamps of one command buffer.

use crate::gpu::GpuError;
use ash::vk;
use std::sync::{Mutex, PoisonError};

/// Passes of a command buffer that are timed; those beyond are not.
pub const MOST_PASSES: u32 = 32;

/// A pool of queries, two a pass; destroyed with the last that names it. That is when its command buffer is freed and no submit of it
/// waits to be read, so that the GPU is done with it.
pub struct Queries {
    device: ash::Device,
    pool: vk::QueryPool,
    /// Bits of a timestamp that hold.
    mask: u64,
    /// The latest timestamp that was read.
    latest: Mutex<Option<u64>>,
}

/// When timestamps are written: when all before them is done.
const DONE: vk::PipelineStageFlags = vk::PipelineStageFlags::BOTTOM_OF_PIPE;

impl Queries {
    /// # Safety
    ///
    /// The device is live, and outlives the result.
    pub unsafe fn new(device: &ash::Device, mask: u64) -> Result<Self, GpuError> {
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(2 * MOST_PASSES);
        // SAFETY: the caller vouches for the device.
        let pool = unsafe { device.create_query_pool(&info, None) };
        let pool = pool.map_err(GpuError::from_call("vkCreateQueryPool"))?;
        Ok(Self { device: device.clone(), pool, mask, latest: Mutex::default() })
    }

    /// Records the first timestamp of the pass of that number.
    ///
    /// # Safety
    ///
    /// The command buffer is recording, outside of a render pass, for queues that have timestamps; there are so many passes.
    pub unsafe fn begin(&self, commands: vk::CommandBuffer, pass: u32) {
        // SAFETY: the caller vouches for the command buffer and the number.
        unsafe {
            self.device.cmd_reset_query_pool(commands, self.pool, 2 * pass, 2);
            self.device.cmd_write_timestamp(commands, DONE, self.pool, 2 * pass);
        }
    }

    /// Records its second timestamp.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin`], which was called for it.
    pub unsafe fn end(&self, commands: vk::CommandBuffer, pass: u32) {
        // SAFETY: as above.
        unsafe { self.device.cmd_write_timestamp(commands, DONE, self.pool, 2 * pass + 1) }
    }

    /// Steps of the clock from the first to the second timestamps of so many passes, together; nothing while one of them is not there.
    ///
    /// # Errors
    ///
    /// Those of vkGetQueryPoolResults.
    pub fn steps(&self, passes: u32) -> Result<Option<u64>, GpuError> {
        let mut results = [0_u64; 2 * MOST_PASSES as usize];
        let results = &mut results[..2 * passes.min(MOST_PASSES) as usize];
        // SAFETY: the pool is live, and has so many queries.
        let read = unsafe {
            self.device.get_query_pool_results(self.pool, 0, results, vk::QueryResultFlags::TYPE_64)
        };
        match read {
            Ok(()) => {
                let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
                Ok(steps(results, self.mask, &mut latest))
            }
            Err(vk::Result::NOT_READY) => Ok(None),
            Err(error) => Err(GpuError::from_call("vkGetQueryPoolResults")(error)),
        }
    }
}

/// Steps between timestamps, two by two, together; nothing while some of them are of an earlier submit: those stay until the GPU
/// comes to reset them.
fn steps(results: &[u64], mask: u64, latest: &mut Option<u64>) -> Option<u64> {
    let since = |before: u64, after: u64| after.wrapping_sub(before) & mask;
    if let Some(before) = *latest {
        let is_later = |after: u64| (1..=mask / 2).contains(&since(before, after));
        if !results.iter().all(|&result| is_later(result)) {
            return None;
        }
    }
    *latest = results.last().copied().or(*latest);
    Some(results.chunks_exact(2).map(|pair| since(pair[0], pair[1])).sum())
}

impl Drop for Queries {
    fn drop(&mut self) {
        // SAFETY: nothing that is submitted uses the pool any more.
        unsafe { self.device.destroy_query_pool(self.pool, None) }
    }
}

#[cfg(test)]
mod tests {
    use super::steps;

    #[test]
    fn timestamps_of_an_earlier_submit_do_not_count() {
        let mut latest = None;
        assert_eq!(steps(&[10, 15, 20, 22], u64::MAX, &mut latest), Some(7));
        assert_eq!(steps(&[10, 15, 20, 22], u64::MAX, &mut latest), None, "not run yet");
        assert_eq!(steps(&[30, 33, 20, 22], u64::MAX, &mut latest), None, "under way");
        assert_eq!(steps(&[30, 33, 40, 44], u64::MAX, &mut latest), Some(7));
    }

    #[test]
    fn a_clock_that_starts_over_goes_on() {
        let mut latest = None;
        assert_eq!(steps(&[250, 253], 0xff, &mut latest), Some(3));
        assert_eq!(steps(&[254, 4], 0xff, &mut latest), Some(6));
        assert_eq!(steps(&[254, 4], 0xff, &mut latest), None);
    }
}
