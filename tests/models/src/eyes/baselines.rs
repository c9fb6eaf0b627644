//! Baselines of the gaze tracker: no filter, and the One Euro filter (Casiez, Roussel and Vogel 2012).
//!
//! Both hold the last direction while the lids are shut, and neither knows a saccade: the region grows by speed and latency.

use super::score::Follower;
use super::tracker::Report;
use glam::Vec3;
use parafovea_core::gaze::{GazePhase, GazeState};

/// The last sample as it is.
#[derive(Clone, Debug, Default)]
pub struct Unfiltered {
    last: Option<(Vec3, f64)>,
    speed_deg_s: f32,
}

impl Follower for Unfiltered {
    fn take(&mut self, report: &Report, _now_s: f64) {
        if !report.sample.valid {
            self.speed_deg_s = 0.0;
            return;
        }
        let direction = report.sample.directions[0];
        if let Some((before, before_s)) = self.last {
            let seconds = (report.known_s - before_s) as f32;
            self.speed_deg_s = (before.angle_between(direction).to_degrees() / seconds).min(1000.0);
        }
        self.last = Some((direction, report.known_s));
    }

    fn state(&self, _now_s: f64) -> GazeState {
        told(self.last.map(|(direction, _)| direction), self.speed_deg_s)
    }
}

/// The One Euro filter of a direction: its three components alike, cut off by the speed of the direction.
#[derive(Clone, Debug)]
pub struct OneEuro {
    /// Cut-off at rest, Hz.
    pub least_hz: f64,
    /// Slope of the cut-off over speed, Hz for a degree a second.
    pub beta: f64,
    /// Cut-off of the speed itself, Hz.
    pub speed_hz: f64,
    last: Option<(Vec3, f64)>,
    turn: Vec3,
}

/// Parameters of [`OneEuro::new`] with the least mean area at 99 % hits on [`super::TUNING_SEEDS`] in the example
/// `tune_one_euro`: least cut-off, beta, cut-off of the speed.
pub const TUNED: [f64; 3] = [16.0, 2.0, 1.0];

impl OneEuro {
    /// With these parameters.
    pub fn new([least_hz, beta, speed_hz]: [f64; 3]) -> Self {
        Self { least_hz, beta, speed_hz, last: None, turn: Vec3::ZERO }
    }
}

impl Follower for OneEuro {
    fn take(&mut self, report: &Report, _now_s: f64) {
        if !report.sample.valid {
            self.turn = Vec3::ZERO;
            return;
        }
        let (direction, time) = (report.sample.directions[0], report.known_s);
        let Some((before, before_s)) = self.last else {
            self.last = Some((direction, time));
            return;
        };
        let seconds = time - before_s;
        let share = |cutoff_hz: f64| 1.0 / (1.0 + 1.0 / (std::f64::consts::TAU * cutoff_hz * seconds));
        let turn = (direction - before) / seconds as f32;
        self.turn = self.turn.lerp(turn, share(self.speed_hz) as f32);
        let speed_deg_s = f64::from(self.turn.length().to_degrees());
        let filtered = before.lerp(direction, share(self.least_hz + self.beta * speed_deg_s) as f32);
        self.last = Some((filtered.normalize(), time));
    }

    fn state(&self, _now_s: f64) -> GazeState {
        told(self.last.map(|(direction, _)| direction), self.turn.length().to_degrees().min(1000.0))
    }
}

fn told(direction: Option<Vec3>, velocity_deg_s: f32) -> GazeState {
    let Some(direction) = direction else { return GazeState::LOST };
    GazeState {
        directions: [direction; 2],
        velocity_deg_s,
        phase: GazePhase::Fixation,
        trust: 1.0,
        ..GazeState::LOST
    }
}
