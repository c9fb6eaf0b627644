//! The status of planning, for `parafovea status`.

use super::SessionPlanner;
use crate::config::{Config, GazeSource};
use crate::inputs::gaze::Look;
use crate::status::StatusSnapshot;

/// Time at which the tracker saw the eyes last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LastLook {
    is_valid: bool,
    sampled_ns: Option<i64>,
}

impl LastLook {
    /// The tracker was asked at `time_ns`.
    pub(super) fn note(&mut self, look: &Look, time_ns: i64) {
        self.is_valid = matches!(look, Look::At { .. });
        if let Look::At { sampled_ns, .. } = look {
            self.sampled_ns = Some(if *sampled_ns > 0 { *sampled_ns } else { time_ns });
        }
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
            let age_ns = |sampled_ns| Some(self.begun_ns?.saturating_sub(sampled_ns).max(0));
            snapshot.gaze_age_ms = self.last_look.sampled_ns.and_then(age_ns).map(|age| age as f32 / 1e6);
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
        for eye in &plan.eyes {
            (0..eye.rates.height()).for_each(|row| snapshot.count(eye.rates.row(row)));
            let statistics = eye.statistics();
            snapshot.tiles_due += statistics.tiles_due;
            snapshot.shaded += statistics.pixel_share / 2.0;
        }
    }
}
