//! The GPU time of passes that show an eye, with masks and fills, and of our own work ahead of them, for the benefit gate:
//! timestamps ahead of a pass and behind it in the application's own command buffers, and around our own submits. They are read when they are there, a frame or two later; nothing waits for them.
//!
//! Timed are passes whose target is known to be an eye's picture when they are recorded, in primary command buffers, on devices that are no
//! CPU (there CPU time tells more), while the gate asks for it. What was recorded before anything was known, and is submitted again and again, is
//! not timed: of it the gate learns nothing, and leaves rates as they are.

mod frames;
mod queries;

pub use frames::FrameTime;

use super::armed::Armed;
use super::table::Table;
use crate::gpu::functions::Functions;
use ash::vk;
use frames::FrameTimes;
use queries::{MOST_PASSES, Queries};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// The times of a device.
#[derive(Default)]
pub struct Timing {
    is_wanted: AtomicBool,
    /// Bits of timestamps that hold, by command pool; pools without any are left out.
    pools: Table<vk::CommandPool, u64>,
    clock: OnceLock<Clock>,
    frames: Mutex<FrameTimes>,
    unread: Mutex<Vec<Unread>>,
}

/// A device's timestamps.
struct Clock {
    /// Nanoseconds of a step.
    step_ns: f64,
    /// Bits that hold, by queue family.
    masks: Vec<u64>,
}

/// A submit whose timestamps were not read yet.
struct Unread {
    queries: Arc<Queries>,
    passes: u32,
    frame: u64,
}

/// So many submits are waited for; of those beyond nothing is known.
const MOST_UNREAD: usize = 64;

/// The timestamps in a command buffer.
#[derive(Default)]
pub struct Timer {
    /// Bits that hold on its queues; 0: nothing is timed in it.
    mask: u64,
    queries: Option<Arc<Queries>>,
    /// Passes that were timed since it began.
    passes: u32,
    is_open: bool,
    /// Whether it may run twice at once, and would write the same timestamps from both.
    may_overlap: bool,
}

impl Timing {
    /// Takes whether anybody wants to know.
    pub fn set_wanted(&self, is_wanted: bool) {
        self.is_wanted.store(is_wanted, Ordering::Relaxed);
    }

    /// Whether anybody wants to know.
    pub fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Relaxed)
    }

    /// A command pool for queues of that family was made.
    pub fn add_pool(&self, armed: &Armed, pool: vk::CommandPool, family: u32) {
        if armed.offer().is_cpu != 0 || armed.backend.is_none() {
            return;
        }
        let Some(functions) = armed.functions() else { return };
        let mask = self.clock(armed, functions).masks.get(family as usize).copied().unwrap_or(0);
        if mask != 0 {
            self.pools.insert(pool, mask);
        }
    }

    /// A command pool is about to be destroyed.
    pub fn remove_pool(&self, pool: vk::CommandPool) {
        self.pools.remove(pool);
    }

    /// For a new command buffer of a pool.
    pub fn timer(&self, pool: vk::CommandPool, level: vk::CommandBufferLevel) -> Timer {
        let is_primary = level == vk::CommandBufferLevel::PRIMARY;
        let mask = if is_primary { self.pools.get(pool).unwrap_or(0) } else { 0 };
        Timer { mask, ..Timer::default() }
    }

    /// For command buffers of our own, for queues of that family.
    pub fn own_timer(&self, armed: &Armed, functions: &Functions, family: u32) -> Timer {
        if armed.offer().is_cpu != 0 {
            return Timer::default();
        }
        let mask = self.clock(armed, functions).masks.get(family as usize).copied().unwrap_or(0);
        Timer { mask, ..Timer::default() }
    }

    /// A command buffer is about to be submitted in that frame; `has_passes`: of the application, not our own.
    pub fn submitted(&self, timer: &Timer, frame: u64, has_passes: bool) {
        let Some(queries) = timer.queries.as_ref().filter(|_| timer.passes > 0) else { return };
        let mut unread = lock(&self.unread);
        let mut frames = lock(&self.frames);
        // What it wrote before, and nobody read, it overwrites.
        let is_same = |known: &Unread| Arc::ptr_eq(&known.queries, queries);
        while let Some(index) = unread.iter().position(is_same) {
            frames.read(unread.swap_remove(index).frame, None);
        }
        if unread.len() < MOST_UNREAD {
            frames.submitted(frame, has_passes);
            unread.push(Unread { queries: Arc::clone(queries), passes: timer.passes, frame });
        }
    }

    /// Reads what is there, and gives the next frame before that under way of which all is known.
    pub fn next(&self, under_way: u64) -> Option<FrameTime> {
        self.read();
        lock(&self.frames).take(under_way)
    }

    /// Reads what is there.
    pub fn read(&self) {
        if lock(&self.unread).is_empty() {
            return;
        }
        // Taken out, so that no lock is held across calls down.
        let mut unread = std::mem::take(&mut *lock(&self.unread));
        if let Some(clock) = self.clock.get() {
            unread.retain(|one| match one.queries.steps(one.passes) {
                Ok(None) => true,
                Ok(Some(steps)) => {
                    lock(&self.frames).read(one.frame, Some((steps as f64 * clock.step_ns) as u64));
                    false
                }
                Err(error) => {
                    tracing::debug!("render passes are not timed: {error}");
                    lock(&self.frames).read(one.frame, None);
                    false
                }
            });
        }
        // Back with its memory, and behind it what came meanwhile.
        let mut kept = lock(&self.unread);
        std::mem::swap(&mut *kept, &mut unread);
        kept.append(&mut unread);
    }

    /// Forgets all, before the device is destroyed.
    pub fn clear(&self) {
        drop(std::mem::take(&mut *lock(&self.unread)));
    }

    fn clock(&self, armed: &Armed, functions: &Functions) -> &Clock {
        self.clock.get_or_init(|| {
            let (instance, physical) = (&functions.instance, armed.record.physical_device);
            // SAFETY: the physical device is that of the live device.
            let (properties, families) = unsafe {
                (
                    instance.get_physical_device_properties(physical),
                    instance.get_physical_device_queue_family_properties(physical),
                )
            };
            let mask = |family: &vk::QueueFamilyProperties| {
                u64::MAX.checked_shr(u64::BITS.saturating_sub(family.timestamp_valid_bits)).unwrap_or(0)
            };
            Clock {
                step_ns: f64::from(properties.limits.timestamp_period),
                masks: families.iter().map(mask).collect(),
            }
        })
    }
}

impl Timer {
    /// The command buffer begins anew.
    pub fn clear(&mut self) {
        (self.passes, self.is_open) = (0, false);
    }

    /// It is recorded with these flags.
    pub fn recorded_with(&mut self, flags: vk::CommandBufferUsageFlags) {
        self.may_overlap = flags.contains(vk::CommandBufferUsageFlags::SIMULTANEOUS_USE);
    }

    /// Whether a pass is being timed.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// A pass that is to be timed begins; none is beyond [`MOST_PASSES`], on queues without
    /// timestamps, and where the command buffer may run twice at once.
    ///
    /// # Safety
    ///
    /// The command buffer is this one, of the device of `armed`; it is recording, outside of a render pass.
    pub unsafe fn begin(&mut self, armed: &Armed, commands: vk::CommandBuffer) {
        if self.mask == 0 || self.passes == MOST_PASSES || self.may_overlap {
            return;
        }
        if self.queries.is_none() {
            let Some(functions) = armed.functions() else { return };
            // SAFETY: the device is live, and command buffers do not outlive it.
            match unsafe { Queries::new(&functions.device, self.mask) } {
                Ok(queries) => self.queries = Some(Arc::new(queries)),
                Err(error) => {
                    error.tell("render passes are not timed");
                    self.mask = 0;
                }
            }
        }
        if let Some(queries) = &self.queries {
            // SAFETY: the caller vouches for the command buffer; there is room.
            unsafe { queries.begin(commands, self.passes) };
            self.is_open = true;
        }
    }

    /// A pass has ended.
    ///
    /// # Safety
    ///
    /// As for [`Self::begin`].
    pub unsafe fn end(&mut self, commands: vk::CommandBuffer) {
        if let Some(queries) = self.queries.as_ref().filter(|_| std::mem::take(&mut self.is_open)) {
            // SAFETY: the caller vouches for the command buffer; the pass was begun.
            unsafe { queries.end(commands, self.passes) };
            self.passes += 1;
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
