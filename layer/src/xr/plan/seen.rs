//! Seen frames, by xrWaitFrame: sound is captured for these alone.

use super::NEVER;
use std::sync::atomic::{AtomicI64, Ordering};

/// Longest gap without seen frames that counts as none, nanoseconds: to begin a capture again takes a moment.
const GAP_NS: i64 = 3_000_000_000;

/// Display time of the newest frame that the application was to render, or of the first one.
#[derive(Debug)]
pub(super) struct SeenFrames(AtomicI64);

impl Default for SeenFrames {
    fn default() -> Self {
        Self(AtomicI64::new(NEVER))
    }
}

impl SeenFrames {
    /// Takes a frame that is shown at `time_ns`, which the application should render or not.
    pub(super) fn take(&self, time_ns: i64, should_render: bool) {
        if should_render || self.0.load(Ordering::Relaxed) == NEVER {
            self.0.store(time_ns, Ordering::Relaxed);
        }
    }

    /// Whether frames were seen not long before a time.
    pub(super) fn are_recent(&self, time_ns: i64) -> bool {
        time_ns.saturating_sub(self.0.load(Ordering::Relaxed)) < GAP_NS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: i64 = 1_000_000_000;

    #[test]
    fn frames_that_go_unseen_for_seconds_are_not_listened_for() {
        let seen = SeenFrames::default();
        // The first frames of a session, and a dialog of the runtime over the application, for 5 s.
        for (second, should_render, are_recent) in [
            (100, false, true),
            (102, false, true),
            (104, false, false),
            (105, true, true),
            (106, false, true),
            (109, false, false),
            (110, true, true),
            (3, false, true),
        ] {
            seen.take(second * S, should_render);
            assert_eq!(seen.are_recent(second * S), are_recent, "second {second}");
        }
    }
}
