//! Command buffers whose commands are not tracked: recorded while the gates rest, in frames whose passes are not followed.
//!
//! A mask is recorded with its pass and serves all submits of the recording. So commands go untracked only where each recording is submitted
//! once. Engines draw ten thousand times a frame: the thread that records such a command buffer knows it without a lock or a look-up.

use ash::vk;
use ash::vk::Handle;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// Recordings in a row, each submitted once at most, after which the next one is expected to be submitted once too.
const SUBMITTED_ONCE: u32 = 8;

/// Counts up whenever a handle may name a tracked command buffer that was an untracked one before.
static EPOCH: AtomicU64 = AtomicU64::new(1);

thread_local! {
    /// The last two untracked command buffers that this thread began, newest first, each with the epoch of that; 0: none. One of the
    /// application's may be in progress beside one of the runtime's.
    static HERE: Cell<[(u64, u64); 2]> = const { Cell::new([(0, 0); 2]) };
}

/// Recordings and submits of a command buffer.
#[derive(Debug, Default)]
pub struct Recordings {
    /// Whether the commands of the last recording are not tracked.
    is_untracked: AtomicBool,
    /// Recordings since one was submitted more than once.
    submitted_once: AtomicU32,
    /// Submits of the last recording.
    submits: AtomicU32,
}

impl Recordings {
    /// A recording with these flags begins, tracked unless `may_rest` allows otherwise; returns whether it is tracked.
    pub fn begin(
        &self,
        handle: vk::CommandBuffer,
        flags: vk::CommandBufferUsageFlags,
        may_rest: bool,
    ) -> bool {
        let once = self.submitted_once.load(Ordering::Relaxed);
        let is_submitted_once =
            flags.contains(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT) || once >= SUBMITTED_ONCE;
        self.submitted_once.store(once.saturating_add(1), Ordering::Relaxed);
        self.submits.store(0, Ordering::Relaxed);
        let is_untracked = may_rest && is_submitted_once;
        if self.is_untracked.swap(is_untracked, Ordering::Relaxed) && !is_untracked {
            forget_threads();
        }
        if is_untracked {
            begin_here(handle);
        } else if is_here(handle) {
            // Of a command buffer that went with its pool, whose address this one has.
            forget(handle);
        }
        !is_untracked
    }

    /// The last recording is submitted; returns whether for the first time.
    pub fn submit(&self) -> bool {
        let is_first = self.submits.fetch_add(1, Ordering::Relaxed) == 0;
        if !is_first {
            self.submitted_once.store(0, Ordering::Relaxed);
        }
        is_first
    }

    /// Whether the commands of the last recording are not tracked.
    pub fn is_untracked(&self) -> bool {
        self.is_untracked.load(Ordering::Relaxed)
    }
}

/// This thread begins that command buffer, untracked.
pub fn begin_here(handle: vk::CommandBuffer) {
    let [newest, other] = HERE.get();
    let begun = (handle.as_raw(), EPOCH.load(Ordering::Relaxed));
    HERE.set([begun, if newest.0 == begun.0 { other } else { newest }]);
}

/// Whether this thread records that command buffer, untracked.
#[inline]
pub fn is_here(handle: vk::CommandBuffer) -> bool {
    let epoch = EPOCH.load(Ordering::Relaxed);
    HERE.get().contains(&(handle.as_raw(), epoch))
}

/// An untracked command buffer is about to be freed.
pub fn forget(handle: vk::CommandBuffer) {
    if is_here(handle) {
        HERE.set(HERE.get().map(|begun| if begun.0 == handle.as_raw() { (0, 0) } else { begun }));
    } else {
        forget_threads();
    }
}

/// No thread takes a handle for that of an untracked command buffer any more: its command buffer is tracked from now on, or is gone.
pub fn forget_threads() {
    EPOCH.fetch_add(1, Ordering::Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: vk::CommandBufferUsageFlags = vk::CommandBufferUsageFlags::empty();
    const ONCE: vk::CommandBufferUsageFlags = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;

    #[test]
    fn only_recordings_that_are_submitted_once_go_untracked() {
        let handle = vk::CommandBuffer::from_raw(0x1000);
        let recordings = Recordings::default();
        let record = |submits: u32, flags| {
            let is_tracked = recordings.begin(handle, flags, true);
            (0..submits).for_each(|_| {
                recordings.submit();
            });
            is_tracked
        };
        assert!(!record(1, ONCE), "by its flag");
        assert!((1..SUBMITTED_ONCE).all(|_| record(1, NONE)), "not known yet");
        assert!(!record(1, NONE) && !record(0, NONE) && !record(2, NONE), "the last one is submitted again");
        assert!((0..SUBMITTED_ONCE).all(|_| record(1, NONE)), "which may happen again");
        assert!(!record(1, NONE));
        assert!(recordings.begin(handle, ONCE, false), "nothing rests");
        assert!(recordings.submit() && !recordings.submit());
    }

    #[test]
    fn a_thread_knows_two() {
        let handles = [0x3000, 0x4000, 0x5000].map(vk::CommandBuffer::from_raw);
        let here = || handles.map(is_here);
        begin_here(handles[0]);
        begin_here(handles[1]);
        begin_here(handles[1]);
        assert_eq!(here(), [true, true, false]);
        begin_here(handles[2]);
        assert_eq!(here(), [false, true, true]);
        forget(handles[1]);
        assert_eq!(here(), [false, false, true], "the other one is still known");
        forget(handles[0]);
        assert_eq!(here(), [false; 3], "a thread may know it");
    }

    #[test]
    fn a_thread_forgets_a_handle_that_is_tracked_again() {
        let handle = vk::CommandBuffer::from_raw(0x2000);
        let recordings = Recordings::default();
        assert!(!is_here(handle));
        assert!(!recordings.begin(handle, ONCE, true) && is_here(handle));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                assert!(!is_here(handle), "of another thread");
                assert!(recordings.begin(handle, ONCE, false));
            });
        });
        assert!(!is_here(handle) && !recordings.is_untracked());
    }

    /// A runtime may destroy a pool without freeing its command buffers, which this layer does not list.
    #[test]
    fn a_tracked_command_buffer_may_have_the_handle_of_an_untracked_one() {
        let handle = vk::CommandBuffer::from_raw(0x6000);
        assert!(!Recordings::default().begin(handle, ONCE, true) && is_here(handle));
        assert!(Recordings::default().begin(handle, ONCE, false));
        assert!(!is_here(handle));
    }
}
