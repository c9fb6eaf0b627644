//! A simulated eye tracker: one ray for both eyes, with delay, error, noise and quantization, and blind while the lids are shut.

use super::path::{Event, EyePath, turned};
use super::random::Random;
use glam::DVec3;
use parafovea_core::gaze::GazeSample;

/// From the eye to the first image that can be made with a sample, seconds.
pub const LATENCY_S: f64 = 0.05;

/// Error of the tracker in one fixation, degrees, in a direction that differs from fixation to fixation.
const BIAS_DEG: f64 = 1.1;

/// Standard deviation of each sample along either axis, degrees.
const JITTER_DEG: f64 = 0.3;

/// An eye tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerModel {
    /// Samples a second.
    pub rate_hz: f64,
    /// Whether it reports the times of samples.
    pub tells_time: bool,
}

/// Errors and delay of a tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerErrors {
    /// From the eye to the first image that can be made with a sample, seconds.
    pub latency_s: f64,
    /// Error in one fixation, degrees, in a direction that differs from fixation to fixation.
    pub bias_deg: f64,
    /// Standard deviation of each sample along either axis, degrees.
    pub jitter_deg: f64,
}

impl TrackerErrors {
    /// None.
    pub const NONE: Self = Self { latency_s: 0.0, bias_deg: 0.0, jitter_deg: 0.0 };
}

impl Default for TrackerErrors {
    fn default() -> Self {
        Self { latency_s: LATENCY_S, bias_deg: BIAS_DEG, jitter_deg: JITTER_DEG }
    }
}

/// One sample, and when it is known.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// The sample, with its time; with time 0 if the tracker does not report it.
    pub sample: GazeSample,
    /// Time from which images can be made with it, seconds.
    pub known_s: f64,
}

impl TrackerModel {
    /// Its samples of a path until `duration_s`, with the usual errors.
    pub fn reports(&self, path: &EyePath, seed: u64, duration_s: f64) -> Vec<Report> {
        self.reports_with(TrackerErrors::default(), path, seed, duration_s)
    }

    /// Its samples of a path until `duration_s`.
    pub fn reports_with(
        &self,
        errors: TrackerErrors,
        path: &EyePath,
        seed: u64,
        duration_s: f64,
    ) -> Vec<Report> {
        let random = &mut Random::new(seed, 3);
        let phase = random.within(0.0, 1.0);
        let biases: Vec<f64> =
            path.looks().iter().map(|_| random.within(0.0, std::f64::consts::TAU)).collect();
        let count = (duration_s * self.rate_hz) as u32;
        (0..count)
            .map(|number| {
                // Its clock is no better than its samples are even.
                let t = (f64::from(number) + phase + random.within(-0.03, 0.03)) / self.rate_hz;
                let (truth, _) = path.at(t);
                let off = |look: usize| turned(truth, biases[look], errors.bias_deg) - truth;
                let bias = match path.event(t) {
                    Event::Looking(look) => off(look),
                    Event::Jumping(look) => off(look).lerp(off(look + 1), path.way(t)),
                };
                let (right, up) = truth.any_orthonormal_pair();
                let jitter = [right, up].map(|axis| axis * random.normal() * errors.jitter_deg.to_radians());
                let seen = (truth + bias + jitter[0] + jitter[1]).normalize();
                Report { sample: self.sample(seen, t, !path.is_blink(t)), known_s: t + errors.latency_s }
            })
            .collect()
    }

    fn sample(&self, seen: DVec3, t: f64, valid: bool) -> GazeSample {
        let time_ns = if self.tells_time { nanoseconds(t) } else { 0 };
        GazeSample { directions: [seen.as_vec3(); 2], time_ns, uncertainty_ns: 0, valid }
    }
}

/// Seconds of a path on the clock of the samples, on which 0 is not a time.
pub fn nanoseconds(seconds: f64) -> i64 {
    1_000_000_000 + (seconds * 1e9) as i64
}
