//! The GPU time of whole frames, ours included, for the benefit gate: a timestamp ahead of the first command of each primary command buffer
//! that takes time and one behind its last, in the application's own command buffers and in ours. They are read when they are available, a
//! frame or two later; nothing waits for them.
//!
//! This is for devices other than CPUs (on a CPU, CPU time is the better measure), while the gate asks for it. Queues that only copy are left
//! out: they have no queries to reset, and the layer does not change their work. A frame with a command buffer without timestamps is not
//! judged: one that was recorded before the gate asked and is submitted again and again, that may run twice at once, or that ends within a
//! suspended pass. From an application with one in each frame the gate learns nothing, and leaves rates unchanged.

mod frames;
mod queries;

pub use frames::{FrameTime, Work};

use super::table::Table;
use crate::gpu::functions::Functions;
use ash::vk;
use frames::FrameTimes;
use queries::{Queries, SparePools};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// The times of a device.
pub struct Timing {
    physical_device: vk::PhysicalDevice,
    /// Whether the device is a CPU, whose frames are not timed.
    is_cpu: bool,
    is_wanted: AtomicBool,
    /// Valid bits of timestamps (`timestampValidBits`), by command pool; pools without any are left out.
    pools: Table<vk::CommandPool, u64>,
    clock: OnceLock<Clock>,
    spare: Arc<SparePools>,
    frames: Mutex<FrameTimes>,
    /// Timestamps of submits that have not returned yet, by queue.
    coming: Mutex<Vec<(vk::Queue, Unread)>>,
    unread: Mutex<Vec<Unread>>,
}

/// A device's timestamps.
struct Clock {
    /// Nanoseconds of a step.
    step_ns: f64,
    /// Valid bits of timestamps (`timestampValidBits`), by queue family.
    valid_bits: Vec<u64>,
}

/// A submit whose timestamps were not read yet.
struct Unread {
    queries: Arc<Queries>,
    work: Work,
    frame: u64,
}

/// Most submits that are waited for: three frames of some eighty command buffers. A frame with more submits is unknown.
const MOST_UNREAD: usize = 256;

/// The timestamps in a command buffer.
#[derive(Default)]
pub struct Timer {
    /// Valid bits of timestamps (`timestampValidBits`) on its queues; 0: nothing is timed in it.
    valid_bits: u64,
    /// Spare pools of its device; `None` without timestamps.
    spare: Option<Arc<SparePools>>,
    queries: Option<Arc<Queries>>,
    state: State,
    /// Whether it may run twice at once, and would write the same timestamps from both.
    may_overlap: bool,
    has_failed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
enum State {
    /// No timestamp since it began.
    #[default]
    Empty,
    /// The first.
    Open,
    /// Both.
    Whole,
}

impl Timing {
    /// Of a device of which nothing is timed yet; of a CPU nothing will be.
    pub fn new(physical_device: vk::PhysicalDevice, is_cpu: bool) -> Self {
        Self {
            physical_device,
            is_cpu,
            is_wanted: AtomicBool::new(false),
            pools: Table::default(),
            clock: OnceLock::new(),
            spare: Arc::default(),
            frames: Mutex::default(),
            coming: Mutex::default(),
            unread: Mutex::default(),
        }
    }

    /// Whether frames can be timed: the device is no CPU.
    pub fn is_possible(&self) -> bool {
        !self.is_cpu
    }

    /// Takes whether the times are wanted.
    pub fn set_wanted(&self, is_wanted: bool) {
        self.is_wanted.store(is_wanted, Ordering::Relaxed);
    }

    /// Whether the times are wanted.
    pub fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Relaxed)
    }

    /// A command pool for queues of that family was made.
    pub fn add_pool(&self, functions: &Functions, pool: vk::CommandPool, family: u32) {
        if self.is_cpu {
            return;
        }
        let valid_bits = self.clock(functions).valid_bits.get(family as usize).copied().unwrap_or(0);
        if valid_bits != 0 {
            self.pools.insert(pool, valid_bits);
        }
    }

    /// A command pool is about to be destroyed.
    pub fn remove_pool(&self, pool: vk::CommandPool) {
        self.pools.remove(pool);
    }

    /// For a new command buffer of a pool.
    pub fn timer(&self, pool: vk::CommandPool, level: vk::CommandBufferLevel) -> Timer {
        let is_primary = level == vk::CommandBufferLevel::PRIMARY;
        let valid_bits = if is_primary { self.pools.get(pool).unwrap_or(0) } else { 0 };
        self.timer_of(valid_bits)
    }

    /// For command buffers of our own, for queues of that family.
    pub fn own_timer(&self, functions: &Functions, family: u32) -> Timer {
        if self.is_cpu {
            return Timer::default();
        }
        self.timer_of(self.clock(functions).valid_bits.get(family as usize).copied().unwrap_or(0))
    }

    fn timer_of(&self, valid_bits: u64) -> Timer {
        let spare = (valid_bits != 0).then(|| Arc::clone(&self.spare));
        Timer { valid_bits, spare, ..Timer::default() }
    }

    /// A command buffer of the application with commands that take time is about to be submitted to a queue in that frame. Its timestamps are
    /// not read before [`Self::returned`]: queries that no submit has reset have no results.
    pub fn submits(&self, timer: &Timer, frame: u64, queue: vk::Queue) {
        if let Some(coming) = self.awaited(timer, frame, Work::Application) {
            lock(&self.coming).push((queue, coming));
        }
    }

    /// The application's submit to a queue has returned.
    pub fn returned(&self, queue: vk::Queue, result: vk::Result) {
        let mut coming = lock(&self.coming);
        for (_, one) in coming.extract_if(.., |(of, _)| *of == queue) {
            if result == vk::Result::SUCCESS {
                lock(&self.unread).push(one);
            } else {
                lock(&self.frames).read(one.frame, one.work, None);
            }
        }
    }

    /// A command buffer of ours was submitted in that frame.
    pub fn submitted(&self, timer: &Timer, frame: u64, work: Work) {
        if let Some(submitted) = self.awaited(timer, frame, work) {
            lock(&self.unread).push(submitted);
        }
    }

    /// The timestamps of a submitted command buffer, which the frame awaits from now on; `None` without any.
    fn awaited(&self, timer: &Timer, frame: u64, work: Work) -> Option<Unread> {
        if timer.valid_bits == 0 {
            return None;
        }
        let Some(queries) = timer.queries.as_ref().filter(|_| timer.state == State::Whole) else {
            if self.is_wanted() {
                lock(&self.frames).submitted_untimed(frame);
            }
            return None;
        };
        let coming = lock(&self.coming).len();
        let mut unread = lock(&self.unread);
        let mut frames = lock(&self.frames);
        // The timer overwrites its earlier timestamps that were not read.
        let is_same = |known: &Unread| Arc::ptr_eq(&known.queries, queries);
        while let Some(index) = unread.iter().position(is_same) {
            let Unread { frame, work, .. } = unread.swap_remove(index);
            frames.read(frame, work, None);
        }
        if unread.len() + coming < MOST_UNREAD {
            frames.submitted(frame, work);
            queries.submitted();
            Some(Unread { queries: Arc::clone(queries), work, frame })
        } else {
            frames.submitted_untimed(frame);
            None
        }
    }

    /// Reads the timestamps, and returns the next complete frame before the current one.
    pub fn next(&self, under_way: u64) -> Option<FrameTime> {
        self.read();
        lock(&self.frames).take(under_way, self.clock.get()?.step_ns)
    }

    /// Reads the available timestamps.
    pub fn read(&self) {
        if lock(&self.unread).is_empty() {
            return;
        }
        // Taken out, so that no lock is held across calls down.
        let mut unread = std::mem::take(&mut *lock(&self.unread));
        unread.retain(|one| {
            let mut frames = lock(&self.frames);
            if !frames.waits_for(one.frame) {
                return false;
            }
            drop(frames);
            let interval = one.queries.interval();
            frames = lock(&self.frames);
            match interval {
                Ok(None) => return true,
                Ok(interval) => frames.read(one.frame, one.work, interval),
                Err(error) => {
                    tracing::debug!("frames are not timed: {error}");
                    frames.read(one.frame, one.work, None);
                }
            }
            false
        });
        // Put back with its memory; entries that were added meanwhile follow it.
        let mut kept = lock(&self.unread);
        std::mem::swap(&mut *kept, &mut unread);
        kept.append(&mut unread);
    }

    /// Forgets all, before the device is destroyed.
    pub fn clear(&self) {
        drop(std::mem::take(&mut *lock(&self.coming)));
        drop(std::mem::take(&mut *lock(&self.unread)));
        self.spare.end();
    }

    fn clock(&self, functions: &Functions) -> &Clock {
        self.clock.get_or_init(|| {
            let (instance, physical) = (&functions.instance, self.physical_device);
            // SAFETY: the physical device is that of the live device.
            let (properties, families) = unsafe {
                (
                    instance.get_physical_device_properties(physical),
                    instance.get_physical_device_queue_family_properties(physical),
                )
            };
            // Queries are reset on queues that draw or compute (Vulkan specification, vkCmdResetQueryPool).
            let resets = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
            let valid_bits = |family: &vk::QueueFamilyProperties| match family.queue_flags.intersects(resets)
            {
                true => {
                    u64::MAX.checked_shr(u64::BITS.saturating_sub(family.timestamp_valid_bits)).unwrap_or(0)
                }
                false => 0,
            };
            Clock {
                step_ns: f64::from(properties.limits.timestamp_period),
                valid_bits: families.iter().map(valid_bits).collect(),
            }
        })
    }
}

impl Timer {
    /// A timer of this device, all of whose bits hold, with queries.
    ///
    /// # Safety
    ///
    /// The device is live, and outlives the timer.
    #[cfg(test)]
    pub unsafe fn of_tests(device: &ash::Device, timing: &Timing) -> Self {
        // SAFETY: as `# Safety` demands.
        let queries = unsafe { Queries::new(device, &timing.spare, u64::MAX) }.ok().map(Arc::new);
        Self { queries, ..timing.timer_of(u64::MAX) }
    }

    /// Resets the timer: the command buffer begins again.
    pub fn clear(&mut self) {
        self.state = State::Empty;
    }

    /// It is recorded with these flags.
    pub fn recorded_with(&mut self, flags: vk::CommandBufferUsageFlags) {
        self.may_overlap = flags.contains(vk::CommandBufferUsageFlags::SIMULTANEOUS_USE);
    }

    /// Whether there may be a first timestamp, and is none.
    pub fn may_begin(&self) -> bool {
        self.valid_bits != 0 && self.state == State::Empty && !self.may_overlap && !self.has_failed
    }

    /// Whether there is a first timestamp, and no second.
    pub fn is_open(&self) -> bool {
        self.state == State::Open
    }

    /// Whether both timestamps are recorded.
    pub fn is_complete(&self) -> bool {
        self.state == State::Whole
    }

    /// A command that takes time is about to be recorded; the first of a command buffer begins its time. There is none on queues without
    /// timestamps, and where the command buffer may run twice at once.
    ///
    /// # Safety
    ///
    /// The command buffer is this one, of the device of `functions`; it is recording, outside of a render pass.
    pub unsafe fn begin<'a>(
        &mut self,
        functions: impl FnOnce() -> Option<&'a Functions>,
        commands: vk::CommandBuffer,
    ) {
        if !self.may_begin() {
            return;
        }
        if self.queries.is_none() {
            let Some((functions, spare)) = functions().zip(self.spare.as_ref()) else { return };
            // SAFETY: the device is live, and command buffers do not outlive it.
            match unsafe { Queries::new(&functions.device, spare, self.valid_bits) } {
                Ok(queries) => self.queries = Some(Arc::new(queries)),
                Err(error) => {
                    error.log("some frames are not timed, so rates.gate cannot judge them");
                    self.has_failed = true;
                }
            }
        }
        if let Some(queries) = &self.queries {
            // SAFETY: the command buffer is recording, as `# Safety` demands.
            unsafe { queries.begin(commands) };
            self.state = State::Open;
        }
    }

    /// The command buffer ends.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin`].
    pub unsafe fn end(&mut self, commands: vk::CommandBuffer) {
        if let Some(queries) = self.queries.as_ref().filter(|_| self.state == State::Open) {
            // SAFETY: the command buffer is recording, as `# Safety` demands; the first timestamp is there.
            unsafe { queries.end(commands) };
            self.state = State::Whole;
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
