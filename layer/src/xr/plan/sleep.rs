//! Frames that the layer ignores: the gates keep every technique off, no trial is near, and the Vulkan half follows no passes.
//!
//! Such a frame makes no plan, asks no eye tracker and has no crossing. An edit of the configuration ends the sleep early, and so does the
//! status, once a second.

use super::SessionPlan;
use crate::config::ConfigSnapshot;
use crate::xr::session::{Active, Health, Session};
use crate::xr::swapchain;
use openxr_sys as xr;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicU32, Ordering};

/// Least length of a sleep, frames.
const LEAST_FRAMES: u32 = 8;

/// No trial begins within this time, nanoseconds: longer than a sleep at 30 Hz.
const NO_TRIAL_NS: i64 = 5_000_000_000;

/// The frames that a session sleeps through.
#[derive(Debug, Default)]
pub struct Sleep {
    remaining: AtomicU32,
    /// Frames that began asleep since the last one that did not.
    skipped_begins: AtomicU32,
    /// Frames that ended asleep since the last one that did not.
    skipped_ends: AtomicU32,
}

impl Sleep {
    /// Whether the current frame is ignored.
    pub fn is_asleep(&self) -> bool {
        self.remaining.load(Ordering::Relaxed) > 0
    }

    /// The next `frames` are ignored.
    fn begin(&self, frames: u32) {
        self.remaining.store(frames, Ordering::Relaxed);
    }

    /// No more frames are ignored.
    pub fn wake(&self) {
        self.remaining.store(0, Ordering::Relaxed);
    }

    /// A frame begins; returns the frames since the last one that was not ignored, with this one. `None` if it is ignored.
    pub fn frame_begins(&self) -> Option<u32> {
        if self.is_asleep() {
            self.skipped_begins.fetch_add(1, Ordering::Relaxed);
            return None;
        }
        Some(self.skipped_begins.swap(0, Ordering::Relaxed).saturating_add(1))
    }

    /// A frame ends; returns whether it is ignored. With `is_asked`, none is.
    pub fn frame_ends(&self, is_asked: bool) -> bool {
        if is_asked {
            self.wake();
        }
        // Another thread may wake the session meanwhile, and then it stays awake.
        let less = |remaining: u32| remaining.checked_sub(1);
        let is_ignored = self.remaining.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_ok();
        if is_ignored {
            self.skipped_ends.fetch_add(1, Ordering::Relaxed);
        }
        is_ignored
    }

    /// Ignored frames that ended since the last call.
    pub fn take_skipped_ends(&self) -> u32 {
        self.skipped_ends.swap(0, Ordering::Relaxed)
    }
}

/// At the end of a frame: the next frames are ignored if nothing in them is of use. The Vulkan half tracks no passes in the next
/// `untracked_frames` frames.
pub fn fall_asleep(
    session: &Session,
    (active, config): (&Active, &ConfigSnapshot),
    time: xr::Time,
    untracked_frames: u32,
) {
    // The last of these frames is not ignored: its end passes the number of the next frame to the Vulkan half.
    let frames = untracked_frames.saturating_sub(1);
    if frames >= LEAST_FRAMES && may_sleep(session, (active, config), time) {
        active.plan.sleep.begin(frames);
        // A swapchain that another thread creates wakes the session; one that it created since the look above has done so too early.
        if !swapchain::virtual_ones(session.handle).is_empty() {
            active.plan.sleep.wake();
        }
    }
}

/// Whether the layer can skip all work in this frame.
fn may_sleep(session: &Session, (active, config): (&Active, &ConfigSnapshot), time: xr::Time) -> bool {
    let state = &active.plan;
    let has_work = || state.planner().has_work(config, active.health() == Health::Works);
    session.offer.is_none()
        && !config.is_gaze_watched
        && config.gaze.record.path().is_none()
        && state.awaits_no_report()
        && state.rests_ns(time) >= NO_TRIAL_NS
        && session.actions.is_settled(session)
        && !has_work()
        && swapchain::virtual_ones(session.handle).is_empty()
}

impl SessionPlan {
    /// Whether no reason for a missing effect is awaited: it was reported, or no scene was shown yet.
    fn awaits_no_report(&self) -> bool {
        let has_begun = || self.quiet.lock().unwrap_or_else(PoisonError::into_inner).has_begun();
        self.has_reported_unseen.load(Ordering::Relaxed) || !has_begun()
    }

    /// Time within which no trial of a gate can begin, nanoseconds.
    fn rests_ns(&self, time: xr::Time) -> i64 {
        self.benefit().rests_ns(time.as_nanos())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_from_both_ends() {
        let sleep = Sleep::default();
        assert_eq!(
            (sleep.frame_begins(), sleep.frame_ends(false), sleep.take_skipped_ends()),
            (Some(1), false, 0)
        );
        sleep.begin(2);
        for _ in 0..2 {
            assert!(sleep.is_asleep());
            assert_eq!((sleep.frame_begins(), sleep.frame_ends(false)), (None, true));
        }
        assert_eq!(
            (sleep.frame_begins(), sleep.frame_ends(false), sleep.take_skipped_ends()),
            (Some(3), false, 2)
        );
    }

    #[test]
    fn a_sleep_ends_early_for_the_status() {
        let sleep = Sleep::default();
        sleep.begin(50);
        assert_eq!((sleep.frame_begins(), sleep.frame_ends(false)), (None, true));
        assert_eq!((sleep.frame_begins(), sleep.frame_ends(true)), (None, false));
        assert_eq!((sleep.take_skipped_ends(), sleep.is_asleep()), (1, false));
        assert_eq!(
            (sleep.frame_begins(), sleep.frame_ends(false), sleep.take_skipped_ends()),
            (Some(3), false, 0)
        );
    }
}
