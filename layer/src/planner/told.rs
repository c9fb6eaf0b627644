//! What is told of planning, for `parafovea status`.

use super::Planning;
use crate::config::{Config, GazeSource};
use crate::inputs::gaze::Look;
use crate::status::Moment;

/// When the tracker saw the eyes last.
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

impl Planning {
    /// Tells what holds now. Of the gaze only whether there is one and how old it is, of the sound only whether something is heard.
    pub fn tell(&self, config: &Config, moment: &mut Moment) {
        moment.frame_rate_hz = self.frame_rate.hz();
        moment.gaze_source = config.gaze.source;
        if config.gaze.source == GazeSource::Centre {
            moment.gaze_is_valid = true;
        } else {
            moment.gaze_is_valid = self.last_look.is_valid;
            let age_ns = |sampled_ns| Some(self.begun_ns?.saturating_sub(sampled_ns).max(0));
            moment.gaze_age_ms = self.last_look.sampled_ns.and_then(age_ns).map(|age| age as f32 / 1e6);
        }
        moment.signal = self.signal.quality();
        moment.audio_source = config.audio.source;
        moment.is_heard = self.audio.is_some();
        let Some(plan) = self.planner.as_ref().map(|planner| planner.newest()) else { return };
        moment.attenuates_colour = plan.chroma.is_some() && plan.eyes.iter().any(|eye| eye.focus.is_some());
        if !self.has_maps(config) {
            return;
        }
        moment.gpu_decides = self.gpu_decides();
        for eye in &plan.eyes {
            (0..eye.rates.height()).for_each(|row| moment.count(eye.rates.row(row)));
            moment.tiles_due += eye.statistics().tiles_due;
        }
        let [left, right] = &plan.eyes;
        moment.shaded = (left.statistics().pixel_share + right.statistics().pixel_share) / 2.0;
    }
}
