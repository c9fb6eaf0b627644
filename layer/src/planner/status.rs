//! The status of planning, for `parafovea status`.

use super::SessionPlanner;
use crate::config::{Config, GazeSource};
use crate::inputs::gaze::Look;
use crate::status::StatusSnapshot;

/// Time at which the tracker saw the eyes last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LastLook {
    is_valid: bool,
    /// Whether the tracker gives the times of its samples.
    is_dated: bool,
    /// Of the sample, or of the frame that got it.
    seen_ns: Option<i64>,
}

impl LastLook {
    /// The tracker was asked at `time_ns`.
    pub(super) fn note(&mut self, look: &Look, time_ns: i64) {
        self.is_valid = matches!(look, Look::At { .. });
        if let Look::At { sampled_ns, .. } = look {
            self.is_dated = *sampled_ns > 0;
            self.seen_ns = Some(if self.is_dated { *sampled_ns } else { time_ns });
        }
    }

    /// Age of the sample at a time, or time since the eyes were lost, nanoseconds; `None` if it is not known.
    fn age_ns(&self, time_ns: i64) -> Option<i64> {
        let is_known = self.is_dated || !self.is_valid;
        self.seen_ns.filter(|_| is_known).map(|seen_ns| time_ns.saturating_sub(seen_ns).max(0))
    }
}

impl SessionPlanner {
    /// Writes the status of now. Of the gaze only whether there is one and how old it is, of the sound only whether there is any.
    pub fn write_status(&self, config: &Config, snapshot: &mut StatusSnapshot) {
        snapshot.frame_rate_hz = self.frame_rate.hz();
        snapshot.gaze_source = config.gaze.source;
        if config.gaze.source == GazeSource::Centre {
            snapshot.gaze_is_valid = true;
        } else {
            snapshot.gaze_is_valid = self.last_look.is_valid;
            let age_ns = self.begun_ns.and_then(|begun_ns| self.last_look.age_ns(begun_ns));
            snapshot.gaze_age_ms = age_ns.map(|age_ns| age_ns as f32 / 1e6);
        }
        snapshot.signal = self.signal.quality();
        snapshot.audio_source = config.audio.source;
        snapshot.is_heard = self.audio.is_some();
        let Some(plan) = self.planner.as_ref().map(|planner| planner.newest()) else { return };
        snapshot.attenuates_colour = plan.chroma.is_some() && plan.eyes.iter().any(|eye| eye.focus.is_some());
        if !self.has_maps(config) {
            return;
        }
        snapshot.gpu_decides = self.gpu_decides();
        snapshot.shaded = 0.0;
        for eye in &plan.eyes {
            (0..eye.rates.height()).for_each(|row| snapshot.count(eye.rates.row(row)));
            let statistics = eye.statistics();
            snapshot.tiles_due += statistics.tiles_due;
            snapshot.shaded += statistics.pixel_share / 2.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    const FRAME_NS: i64 = 11_111_111;

    #[test]
    fn a_gaze_of_unknown_time_has_no_age_and_the_rate_of_its_changes() {
        let config = Config::default();
        // Each third frame has another direction; the last sample is 20 ms old at most.
        for (is_dated, is_lost, age_ms) in [
            (false, false, None),
            (false, true, Some(22.0)),
            (true, false, Some(20.0)),
            (true, true, Some(42.0)),
        ] {
            let mut planner = SessionPlanner::default();
            for frame in 1..=400 {
                let time_ns = frame * FRAME_NS;
                planner.frame_begins(time_ns, 1);
                let look = Look::At {
                    direction: Vec3::new(0.01 * (frame / 3 % 2) as f32, 0.0, -1.0),
                    sampled_ns: if is_dated { time_ns - 20_000_000 } else { 0 },
                    uncertainty_ns: 0,
                };
                let look = if is_lost && frame > 398 { Look::Unseen } else { look };
                planner.look(&config, look, Quat::IDENTITY, time_ns);
            }
            let mut snapshot = StatusSnapshot::default();
            planner.write_status(&config, &mut snapshot);
            assert_eq!(snapshot.gaze_age_ms.map(f32::round), age_ms, "dated: {is_dated}, lost: {is_lost}");
            let rate_hz = snapshot.signal.rate_hz.unwrap_or_default();
            let expected_hz = if is_dated { 90.0 } else { 30.0 };
            assert!((rate_hz - expected_hz).abs() < 1.5, "{rate_hz} Hz, dated: {is_dated}");
        }
    }
}
