//! Choice of the gaze's source among several.

use crate::inputs::gaze::Look;

/// Time for which the runtime's eye tracker holds after it saw the eyes last, nanoseconds: longer than a blink is held, so that the
/// source does not change in one.
const HOLD_NS: i64 = 1_000_000_000;

/// Time without eyes after which a tracker counts as one that has none, nanoseconds, on the clock of display times. Runtimes offer eye
/// trackers that get no data.
const PATIENCE_NS: i64 = 5_000_000_000;

/// A source of the gaze.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ActiveGazeSource {
    /// None: the centre of the view.
    #[default]
    Centre,
    /// The runtime's eye tracker.
    Eyes,
    /// OSC packets.
    Osc,
    /// A file.
    File,
}

impl ActiveGazeSource {
    /// Its name, as `gaze.source` has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Centre => "centre",
            Self::Eyes => "eyes",
            Self::Osc => "osc",
            Self::File => "file",
        }
    }
}

/// Chooses for `gaze.source = "auto"`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Auto {
    begun_ns: Option<i64>,
    /// Time at which the runtime's eye tracker saw the eyes last.
    seen_ns: Option<i64>,
    misses_eyes: bool,
}

impl Auto {
    /// The gaze to use of all sources at the same time: the runtime's eye tracker while it sees the eyes or has just seen
    /// them, else packets while they arrive, else nothing.
    pub fn choose(&mut self, eyes: Look, osc: Look, time_ns: i64) -> (ActiveGazeSource, Look) {
        let begun_ns = *self.begun_ns.get_or_insert(time_ns);
        if matches!(eyes, Look::At { .. }) {
            self.seen_ns = Some(time_ns);
        }
        let missed_ns = time_ns.saturating_sub(self.seen_ns.unwrap_or(begun_ns));
        self.misses_eyes = eyes == Look::NoTracker || missed_ns >= PATIENCE_NS;
        let was_seen_lately =
            self.seen_ns.is_some_and(|seen_ns| (0..HOLD_NS).contains(&time_ns.saturating_sub(seen_ns)));
        match (eyes, osc) {
            (Look::At { .. }, _) => (ActiveGazeSource::Eyes, eyes),
            (Look::Unseen, _) if was_seen_lately => (ActiveGazeSource::Eyes, eyes),
            (_, Look::At { .. } | Look::Unseen) => (ActiveGazeSource::Osc, osc),
            (Look::Unseen, Look::NoTracker) => (ActiveGazeSource::Eyes, eyes),
            (Look::NoTracker, Look::NoTracker) => (ActiveGazeSource::Centre, Look::NoTracker),
        }
    }

    /// Whether the runtime's eye tracker is of no use, so that packets are worth a listener.
    pub fn misses_eyes(&self) -> bool {
        self.misses_eyes
    }
}

/// Delay of packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PacketDelay {
    /// From the eye to the packet and from the plan of a frame to its display, nanoseconds.
    pub delay_ns: i64,
    /// Its possible error, nanoseconds.
    pub uncertainty_ns: i64,
}

impl PacketDelay {
    /// Before it is measured: as that of any sample whose time is not known, but cameras, networks and other processes take up to 140 ms.
    pub const ASSUMED: Self = Self { delay_ns: 50_000_000, uncertainty_ns: 90_000_000 };

    /// By a measurement, milliseconds, which is right to 10 ms.
    pub fn measured(delay_ms: f32) -> Self {
        Self { delay_ns: (f64::from(delay_ms) * 1e6) as i64, uncertainty_ns: 10_000_000 }
    }
}

/// Times of samples that a runtime knows nothing of, on the clock of display times.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleTimes {
    /// The newest sample, its time, and the display time that it was asked for.
    newest: Option<(u64, i64, i64)>,
}

/// A display time that is earlier than the one before by more than this, nanoseconds: the clock began again.
const LONGEST_STEP_BACK_NS: i64 = 1_000_000_000;

/// Least time between two samples, nanoseconds: no eye tracker is faster.
const LEAST_APART_NS: i64 = 1_000_000;

impl SampleTimes {
    /// The time of the sample `serial`, which came `age_ns` before a frame was planned that is shown at `time_ns`; the way from the eye
    /// to the packet and from the plan to the display take `latency_ns`. The same for the same sample, and later for a later one.
    pub fn of(&mut self, serial: u64, age_ns: i64, time_ns: i64, latency_ns: i64) -> i64 {
        let asked_ns = time_ns.saturating_sub(latency_ns).saturating_sub(age_ns);
        let sampled_ns = match self.newest {
            Some((known, sampled_ns, _)) if known == serial => sampled_ns,
            // Frames are planned sooner or later before they are shown, which is not a time between samples.
            Some((_, sampled_ns, before_ns)) if before_ns.saturating_sub(time_ns) < LONGEST_STEP_BACK_NS => {
                asked_ns.max(sampled_ns.saturating_add(LEAST_APART_NS))
            }
            _ => asked_ns,
        };
        self.newest = Some((serial, sampled_ns, time_ns));
        sampled_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const AT: Look = Look::At { direction: Vec3::NEG_Z, sampled_ns: 1, uncertainty_ns: 0 };
    const OTHER: Look = Look::At { direction: Vec3::X, sampled_ns: 2, uncertainty_ns: 0 };
    const S: i64 = 1_000_000_000;

    #[test]
    fn the_eye_tracker_comes_first_then_packets_then_nothing() {
        let mut auto = Auto::default();
        assert_eq!(
            auto.choose(Look::NoTracker, Look::NoTracker, 0),
            (ActiveGazeSource::Centre, Look::NoTracker)
        );
        assert!(auto.misses_eyes());
        assert_eq!(auto.choose(Look::NoTracker, OTHER, S / 100), (ActiveGazeSource::Osc, OTHER));
        assert_eq!(auto.choose(Look::NoTracker, Look::Unseen, S / 50), (ActiveGazeSource::Osc, Look::Unseen));
        assert_eq!(auto.choose(AT, OTHER, S / 10), (ActiveGazeSource::Eyes, AT));
        assert!(!auto.misses_eyes());
    }

    #[test]
    fn nothing_changes_hands_in_a_blink_and_a_tracker_without_eyes_gives_way() {
        let mut auto = Auto::default();
        auto.choose(AT, OTHER, 0);
        assert_eq!(auto.choose(Look::Unseen, OTHER, S - 1), (ActiveGazeSource::Eyes, Look::Unseen));
        assert_eq!(auto.choose(Look::Unseen, OTHER, S), (ActiveGazeSource::Osc, OTHER));
        assert_eq!(auto.choose(Look::Unseen, Look::NoTracker, 2 * S), (ActiveGazeSource::Eyes, Look::Unseen));
        assert!(!auto.misses_eyes());
        auto.choose(Look::Unseen, Look::NoTracker, 5 * S);
        assert!(auto.misses_eyes());
        assert_eq!(auto.choose(AT, OTHER, 6 * S), (ActiveGazeSource::Eyes, AT));
        assert!(!auto.misses_eyes());
    }

    #[test]
    fn a_sample_has_one_time_and_later_ones_have_later_times() {
        let mut times = SampleTimes::default();
        assert_eq!(times.of(1, 2, 1000, 100), 898);
        assert_eq!(times.of(1, 400, 1500, 100), 898, "the same sample, seen again");
        let second = times.of(2, 300, 1100, 0);
        assert!(second > 898, "a frame that was planned earlier");
        assert!(times.of(3, 0, 20_000_000, 100) >= 19_999_900);
        times.of(4, 0, 3 * S, 100);
        assert_eq!(times.of(5, 0, 5, 0), 5, "the clock began again");
        assert_eq!(times.of(6, i64::MAX, i64::MIN, i64::MAX), i64::MIN);
    }
}
