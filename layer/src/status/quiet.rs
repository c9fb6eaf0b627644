//! Detection of the end of changes in recognition.

/// Time without a new decision after which recognition has settled, nanoseconds of display time: rates have become coarser by then, too.
const SETTLED_AFTER_NS: i64 = 2_000_000_000;

/// Number of frames for the same: two seconds at 30 Hz. Engines that load show few frames, and not yet the scene.
const SETTLED_FRAMES: u32 = 60;

/// Since when no decision was made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet {
    /// Display time of the first frame with as many decisions, nanoseconds.
    since: Option<i64>,
    decisions: usize,
    frames: u32,
}

impl Quiet {
    /// Whether a frame was taken.
    pub fn has_begun(&self) -> bool {
        self.since.is_some()
    }

    /// A frame that is shown at `time_ns` ended, after so many decisions. Whether recognition has settled.
    pub fn frame(&mut self, time_ns: i64, decisions: usize) -> bool {
        let since = match self.since {
            Some(since) if self.decisions == decisions => since,
            _ => {
                *self = Self { since: Some(time_ns), decisions, frames: 0 };
                time_ns
            }
        };
        self.frames = self.frames.saturating_add(1);
        time_ns.saturating_sub(since) >= SETTLED_AFTER_NS && self.frames > SETTLED_FRAMES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recognition_settles_two_seconds_after_its_last_decision() {
        let mut quiet = Quiet::default();
        let mut settled_at = |begin: i64, frames: i64, period_ns: i64, decisions: usize| {
            (0..frames)
                .map(|frame| begin + frame * period_ns)
                .find(|time_ns| quiet.frame(*time_ns, decisions))
        };
        const FRAME_NS: i64 = 11_111_111;
        assert_eq!(settled_at(0, 170, FRAME_NS, 1), None);
        // A pass that is recognised late restarts the wait.
        let begin = 170 * FRAME_NS;
        let end = settled_at(begin, 300, FRAME_NS, 2).unwrap();
        assert!((SETTLED_AFTER_NS..SETTLED_AFTER_NS + FRAME_NS).contains(&(end - begin)), "{end}");
        // Few frames a second are less evidence.
        assert_eq!(settled_at(end, 60, 200_000_000, 3), None);
        assert!(settled_at(end + 60 * 200_000_000, 1, 200_000_000, 3).is_some());
    }
}
