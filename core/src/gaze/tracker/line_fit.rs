//! Direction and turn of slow eyes: the straight line of least squares through the samples since they landed.
//!
//! The filter of growing memory of degree one (Morrison 1969, Introduction to Sequential Smoothing and Prediction): its
//! first answers are the samples themselves, it averages more as it knows more, and it does not lag behind an even motion.
//! Once it spans its memory, its gains stay as they are, and it forgets.

use crate::geometry::eccentricity;
use glam::Vec3;

/// Reduction of the squared slope, in units of its variance: up to the newest sample, and beyond it. The estimator of James and Stein
/// reduces by two less than the number of dimensions; extrapolation needs more certainty than interpolation.
/// Chosen on seeds that the table of `cargo dev bench gaze` does not use.
const SHRINKAGE: [f32; 2] = [0.7, 3.5];

/// Both eyes' directions (unit vectors) at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeSample {
    pub(super) directions: [Vec3; 2],
    pub(super) time_ns: i64,
}

impl EyeSample {
    /// Mean of both eyes' angles to where they are in `other`, degrees.
    pub(super) fn angle_deg(&self, other: [Vec3; 2]) -> f32 {
        let angle = |eye: usize| eccentricity(self.directions[eye], other[eye]);
        (0.5 * (angle(0) + angle(1))).to_degrees()
    }

    /// Seconds since an earlier time.
    pub(super) fn seconds_since(&self, time_ns: i64) -> f32 {
        (self.time_ns.saturating_sub(time_ns) as f64 * 1e-9) as f32
    }
}

/// The line, of both eyes.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineFit {
    /// Directions of the eyes at the time of the newest sample.
    newest: EyeSample,
    /// Turn of the eyes in a second, perpendicular to the directions.
    turns: [Vec3; 2],
    /// Samples that the line is through, at least 1, no more than its memory holds.
    count: u16,
    /// Mean time between two of them, seconds.
    interval_s: f32,
}

impl LineFit {
    /// Nothing is known of before.
    pub(super) fn new(sample: EyeSample) -> Self {
        Self { newest: sample, turns: [Vec3::ZERO; 2], count: 1, interval_s: 0.0 }
    }

    /// Through two samples.
    pub(super) fn through(older: &EyeSample, newer: EyeSample) -> Self {
        let mut line = Self::new(*older);
        line.add(newer, 2);
        line
    }

    /// Takes one more sample, after the newest. The line remembers at most `memory` of them, at least 2.
    pub(super) fn add(&mut self, sample: EyeSample, memory: u16) {
        let seconds = sample.seconds_since(self.newest.time_ns);
        let expected = self.at(sample.time_ns);
        let steps = f32::from(self.count);
        self.interval_s += (seconds - self.interval_s) / steps.min(8.0);
        self.count = (self.count + 1).min(memory.max(2));
        let n = f32::from(self.count);
        let (position, slope) = (2.0 * (2.0 * n - 1.0) / (n * (n + 1.0)), 6.0 / (n * (n + 1.0)));
        let eyes = self.newest.directions.iter_mut().zip(&mut self.turns);
        for ((direction, turn), (seen, expected)) in eyes.zip(sample.directions.into_iter().zip(expected)) {
            let missed = seen - expected;
            *direction = (expected + missed * position).normalize_or(seen);
            // Between two samples that come at almost the same time, noise is no turn.
            let turned = *turn + missed * (slope / seconds.max(self.interval_s));
            *turn = turned - *direction * turned.dot(*direction);
        }
        self.newest.time_ns = sample.time_ns;
    }

    /// Directions on the line at the time of the newest sample, with that time.
    pub(super) fn newest(&self) -> &EyeSample {
        &self.newest
    }

    /// Directions on the line at a time.
    pub(super) fn at(&self, time_ns: i64) -> [Vec3; 2] {
        self.ahead((time_ns.saturating_sub(self.newest.time_ns) as f64 * 1e-9) as f32)
    }

    /// Directions on the line some seconds after its newest sample.
    pub(super) fn ahead(&self, seconds: f32) -> [Vec3; 2] {
        [0, 1].map(|eye| {
            let direction = self.newest.directions[eye];
            (direction + self.turns[eye] * seconds).normalize_or(direction)
        })
    }

    /// Directions of the eyes some seconds after the newest sample, where samples scatter by `noise_deg`: on the line if they are known
    /// to turn; else between the mean of the samples and the line, nearer to the line the clearer its slope is above noise: the shrinkage
    /// of James and Stein (1961).
    pub(super) fn estimate(&self, noise_deg: f32, turning: bool, seconds: f32) -> [Vec3; 2] {
        let half_s = 0.5 * f32::from(self.count - 1) * self.interval_s;
        if turning {
            return self.ahead(seconds);
        }
        if self.count < 2 {
            return self.newest.directions;
        }
        let sigmas = self.speed_deg_s() / self.speed_noise_deg_s(noise_deg);
        let told = |taken_off: f32| (1.0 - taken_off / (sigmas * sigmas)).max(0.0);
        // The slope is not extrapolated over a longer time than the samples span.
        let leads = if 2.0 * half_s >= seconds { told(SHRINKAGE[1]) } else { 0.0 };
        self.ahead(told(SHRINKAGE[0]) * half_s + leads * seconds - half_s)
    }

    /// Samples that it is through.
    pub(super) fn count(&self) -> u16 {
        self.count
    }

    /// Angular speed of both eyes together, degrees a second.
    pub(super) fn speed_deg_s(&self) -> f32 {
        (0.5 * (self.turns[0] + self.turns[1])).length().to_degrees()
    }

    /// Standard deviation of that speed along either axis for samples that scatter by `noise_deg`, degrees a second: infinite
    /// for one sample.
    pub(super) fn speed_noise_deg_s(&self, noise_deg: f32) -> f32 {
        let n = f32::from(self.count);
        noise_deg / self.interval_s * (12.0 / (n * (n * n - 1.0))).sqrt()
    }
}
