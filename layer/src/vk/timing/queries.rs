//! The timestamps of one command buffer.

use crate::gpu::GpuError;
use ash::vk;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A pool of two queries, of one command buffer; spare with the last that names it. That is when its command buffer is freed and no submit of it
/// waits to be read, so that the GPU is done with it.
pub struct Queries {
    pool: Option<Pool>,
    spare: Arc<SparePools>,
    /// Valid bits of timestamps (`timestampValidBits`).
    valid_bits: u64,
    /// Submits whose timestamps were not read: later ones than `latest` may be in the pool.
    unread: AtomicU32,
}

/// A pool of two queries.
struct Pool {
    device: ash::Device,
    handle: vk::QueryPool,
    /// The latest timestamp that was read.
    latest: Mutex<Option<u64>>,
}

/// Pools of a device that no command buffer uses. Many applications allocate their command buffers anew in each frame.
#[derive(Default)]
pub struct SparePools(Mutex<Spare>);

#[derive(Default)]
struct Spare {
    pools: Vec<Pool>,
    /// Whether the device is about to be destroyed.
    is_over: bool,
}

/// Most spare pools: of three frames of some eighty command buffers.
const MOST_SPARE: usize = 256;

impl SparePools {
    /// Destroys all of them, from now on, too, before the device is destroyed.
    pub fn end(&self) {
        let mut spare = self.lock();
        spare.is_over = true;
        let pools = std::mem::take(&mut spare.pools);
        drop(spare);
        drop(pools);
    }

    fn take(&self) -> Option<Pool> {
        self.lock().pools.pop()
    }

    /// Keeps a pool if there is room, and else destroys it.
    fn put(&self, pool: Pool) {
        let mut spare = self.lock();
        let is_kept = !spare.is_over && spare.pools.len() < MOST_SPARE;
        if is_kept {
            spare.pools.push(pool);
        } else {
            drop(spare);
            drop(pool);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Spare> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
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

impl Pool {
    /// # Safety
    ///
    /// The device is live, and outlives the result.
    unsafe fn new(device: &ash::Device) -> Result<Self, GpuError> {
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2);
        // SAFETY: the device is live, as `# Safety` demands.
        let handle = unsafe { device.create_query_pool(&info, None) };
        let handle = handle.map_err(GpuError::from_call("vkCreateQueryPool"))?;
        Ok(Self { device: device.clone(), handle, latest: Mutex::default() })
    }
}

impl Queries {
    /// For one command buffer, from a spare pool if there is one.
    ///
    /// # Errors
    ///
    /// The errors of vkCreateQueryPool.
    ///
    /// # Safety
    ///
    /// The device is live, that of the spare pools, and outlives the result.
    pub unsafe fn new(
        device: &ash::Device,
        spare: &Arc<SparePools>,
        valid_bits: u64,
    ) -> Result<Self, GpuError> {
        // SAFETY: the device is live, as `# Safety` demands.
        let pool = spare.take().map_or_else(|| unsafe { Pool::new(device) }, Ok)?;
        Ok(Self { pool: Some(pool), spare: Arc::clone(spare), valid_bits, unread: AtomicU32::new(0) })
    }

    /// The timestamps are about to be submitted.
    pub fn submitted(&self) {
        self.unread.fetch_add(1, Ordering::Relaxed);
    }

    /// Records the first timestamp.
    ///
    /// # Safety
    ///
    /// The command buffer is recording, outside of a render pass, for queues that have timestamps and may reset queries.
    pub unsafe fn begin(&self, commands: vk::CommandBuffer) {
        let Some(Pool { device, handle, .. }) = &self.pool else { return };
        // SAFETY: the command buffer is recording, as `# Safety` demands.
        unsafe {
            device.cmd_reset_query_pool(commands, *handle, 0, 2);
            device.cmd_write_timestamp(commands, DONE, *handle, 0);
        }
    }

    /// Records the second timestamp.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin`], which was called for it.
    pub unsafe fn end(&self, commands: vk::CommandBuffer) {
        let Some(Pool { device, handle, .. }) = &self.pool else { return };
        // SAFETY: as above.
        unsafe { device.cmd_write_timestamp(commands, DONE, *handle, 1) }
    }

    /// The timestamps; `None` while one of them is missing.
    ///
    /// # Errors
    ///
    /// The errors of vkGetQueryPoolResults.
    pub fn interval(&self) -> Result<Option<Interval>, GpuError> {
        let Some(Pool { device, handle, latest }) = &self.pool else { return Ok(None) };
        let mut results = [0_u64; 2];
        // SAFETY: the pool is live, and has two queries.
        let read =
            unsafe { device.get_query_pool_results(*handle, 0, &mut results, vk::QueryResultFlags::TYPE_64) };
        match read {
            Ok(()) => {
                let mut latest = latest.lock().unwrap_or_else(PoisonError::into_inner);
                let found = interval(results, self.valid_bits, &mut latest);
                if found.is_some() {
                    self.unread.fetch_sub(1, Ordering::Relaxed);
                }
                Ok(found)
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
        // Unread timestamps would be taken for timestamps of the next command buffer.
        let is_read = *self.unread.get_mut() == 0;
        if let Some(pool) = self.pool.take().filter(|_| is_read) {
            self.spare.put(pool);
        }
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        // SAFETY: nothing that is submitted uses the pool any more.
        unsafe { self.device.destroy_query_pool(self.handle, None) }
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
