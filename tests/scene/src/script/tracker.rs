//! A simulated eye tracker: delay, error, noise, quantization, and blindness while the lids are shut.

use std::f32::consts::TAU;

use glam::Vec3;

use super::gaze::{GazeKey, TrueGaze, times};
use crate::scene::noise::hash;

/// An eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracker {
    /// From the eye's movement to the report of it, milliseconds.
    pub delay_ms: f64,
    /// Constant error of the reports, in one direction given by the seed, degrees.
    pub bias_deg: f32,
    /// Standard deviation of each report in each of two directions across the gaze, degrees.
    pub noise_deg: f32,
    /// Reports a second; each is held until the next.
    pub rate_hz: f64,
    /// Whether the eyes are lost while the lids are shut; the loss is reported as late as everything else.
    pub loses_blinks: bool,
    /// Of bias and noise.
    pub seed: u32,
}

/// Lead of a keyframe before its report, seconds: players round times to nanoseconds, and would otherwise miss
/// every other report that comes at a frame's own time.
pub const EARLY_S: f64 = 1e-6;

impl Tracker {
    /// Without any error but its steps: four reports a frame at 90 Hz, one of them at the frame's own time.
    pub const IDEAL: Self =
        Self { delay_ms: 0.0, bias_deg: 0.0, noise_deg: 0.0, rate_hz: 360.0, loses_blinks: false, seed: 0 };
    /// As good as the Vive Pro Eye.
    pub const GOOD: Self =
        Self { delay_ms: 58.0, bias_deg: 0.5, noise_deg: 0.2, rate_hz: 120.0, loses_blinks: true, seed: 1 };
    /// As a slow or badly calibrated one.
    pub const POOR: Self =
        Self { delay_ms: 80.0, bias_deg: 1.1, noise_deg: 0.5, rate_hz: 30.0, loses_blinks: true, seed: 2 };

    /// The three by their names.
    pub const NAMED: [(&'static str, Self); 3] =
        [("ideal", Self::IDEAL), ("good", Self::GOOD), ("poor", Self::POOR)];

    /// The tracker of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(other, _)| *other == name).map(|(_, tracker)| *tracker)
    }

    /// Its samples: one entry for each report, at the time of the report.
    pub fn samples(&self, gaze: &TrueGaze) -> Vec<GazeKey> {
        let bias = (hash(0, 1, self.seed) * TAU).sin_cos();
        let report = |(index, t): (u32, f64)| {
            let seen = t - self.delay_ms * 1e-3;
            let noise = normal(index, self.seed);
            let off =
                [0, 1].map(|axis| [bias.0, bias.1][axis] * self.bias_deg + noise[axis] * self.noise_deg);
            let tracked = !(self.loses_blinks && gaze.is_blink(seen));
            GazeKey::new(t, turned(gaze.at(seen).direction, off), tracked)
        };
        (0..).zip(times(self.rate_hz)).map(report).collect()
    }

    /// The same for players that interpolate linearly between keyframes: each report twice, at its own time and again
    /// at the time of the next, so that it is held. All are [`EARLY_S`] early, but none before 0.
    pub fn keyframes(&self, gaze: &TrueGaze) -> Vec<GazeKey> {
        let samples = self.samples(gaze);
        let held = samples.windows(2).flat_map(|pair| [pair[0], GazeKey { t: pair[1].t, ..pair[0] }]);
        held.chain(samples.last().copied())
            .map(|key| GazeKey { t: (key.t - EARLY_S).max(0.0), ..key })
            .collect()
    }
}

/// A direction, turned to its right and upwards by these angles in degrees.
fn turned(direction: Vec3, [right_deg, up_deg]: [f32; 2]) -> Vec3 {
    let right = direction.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(direction);
    let angle = right_deg.hypot(up_deg);
    if angle == 0.0 {
        return direction;
    }
    let across = (right * right_deg + up * up_deg) / angle;
    let (sin, cos) = angle.to_radians().sin_cos();
    (direction * cos + across * sin).normalize()
}

/// Two independent numbers of the standard normal distribution (Box and Muller 1958).
fn normal(index: u32, seed: u32) -> [f32; 2] {
    let radius = (-2.0 * (1.0 - hash(index, 2, seed)).max(1e-7).ln()).sqrt();
    let (sin, cos) = (hash(index, 3, seed) * TAU).sin_cos();
    [radius * cos, radius * sin]
}

#[cfg(test)]
mod tests;
