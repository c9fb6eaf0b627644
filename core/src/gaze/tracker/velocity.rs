//! Speed of the eyes from the last three samples.

use crate::geometry::eccentricity;
use glam::Vec3;

/// Samples nearer in time than this are one sample: half of what a 1 kHz tracker's differ by. A speed over less
/// would be noise divided by next to nothing.
const MIN_STEP_NS: i64 = 500_000;

/// Fastest speed reported, degrees a second, above the 500 to 700 at which saccades peak (Carpenter).
const MAX_VELOCITY_DEG_S: f32 = 1000.0;

/// One moment: both eyes' directions (unit) and its time.
#[derive(Clone, Copy, Debug)]
struct Moment {
    directions: [Vec3; 2],
    time_ns: i64,
}

/// Up to three moments, the newest first, in order of time, at least [`MIN_STEP_NS`] apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recent {
    newest: Moment,
    older: [Option<Moment>; 2],
}

impl Recent {
    /// Nothing is known of before.
    pub(super) fn new(directions: [Vec3; 2], time_ns: i64) -> Self {
        Self { newest: Moment { directions, time_ns }, older: [None; 2] }
    }

    /// With one more moment, not before the newest.
    pub(super) fn with(&self, directions: [Vec3; 2], time_ns: i64) -> Self {
        if time_ns.saturating_sub(self.newest.time_ns) < MIN_STEP_NS {
            // One moment, at which the later answer holds. It keeps its time, so that a stream of samples this
            // dense still moves on.
            let newest = Moment { directions, ..self.newest };
            return Self { newest, ..*self };
        }
        Self { newest: Moment { directions, time_ns }, older: [Some(self.newest), self.older[0]] }
    }

    pub(super) fn directions(&self) -> [Vec3; 2] {
        self.newest.directions
    }

    pub(super) fn time_ns(&self) -> i64 {
        self.newest.time_ns
    }

    /// The least of the three speeds between the three moments, degrees a second; 0 before there are three.
    ///
    /// One sample that is off makes two of them large, never the third; motion at an even speed makes all three
    /// equal. A saccade therefore shows one sample late, and its end at once.
    pub(super) fn velocity_deg_s(&self) -> f32 {
        let [Some(middle), Some(oldest)] = self.older else { return 0.0 };
        let least = speed_deg_s(&self.newest, &middle)
            .min(speed_deg_s(&self.newest, &oldest))
            .min(speed_deg_s(&middle, &oldest));
        least.min(MAX_VELOCITY_DEG_S)
    }
}

/// Mean of both eyes' angles over the time between two moments.
fn speed_deg_s(newer: &Moment, older: &Moment) -> f32 {
    let span_ns = newer.time_ns.saturating_sub(older.time_ns).max(MIN_STEP_NS);
    let angle = |eye: usize| eccentricity(newer.directions[eye], older.directions[eye]).to_degrees();
    0.5 * (angle(0) + angle(1)) / (span_ns as f64 * 1e-9) as f32
}
