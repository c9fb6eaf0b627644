//! A saccade in flight, and where it will land.
//!
//! Saccades are ballistic: how long one takes follows from how far it goes (main sequence: 21 ms + 2.2 ms a degree, Carpenter
//! 1988), and in between it follows nearly the path of least jerk (Flash and Hogan 1985). So the samples since it left say
//! how likely each amplitude is, and with it each place of landing.

use super::line_fit::EyeSample;
use crate::geometry::eccentricity;
use glam::{Quat, Vec3};

/// Samples that are kept, evenly enough over the longest saccade.
const KEPT: usize = 16;

/// Least time between two that are kept: the longest saccade has room.
const KEPT_STEP_NS: i64 = 8_000_000;

/// Amplitudes that are weighed, from the least on, each larger by the same factor; degrees.
const AMPLITUDES: usize = 28;
const LEAST_AMPLITUDE_DEG: f32 = 1.0;
const AMPLITUDE_FACTOR: f32 = 1.145;

/// Mean amplitude of saccades before anything is known of one, degrees: most natural ones are below 15 (Bahill et al. 1975).
const USUAL_AMPLITUDE_DEG: f32 = 10.0;

/// Times of departure that are weighed.
const DEPARTURES: u8 = 10;

/// How long a saccade may have been on its way before it showed: 10 to 17 ms take it, by its amplitude, 1.3 degrees far.
const UNSEEN_S: f32 = 0.02;

/// Unseen distance from its start, standard deviation, degrees.
const UNSEEN_DEG: f32 = 0.6;

/// By how much a path may differ from that of least jerk, part of its amplitude.
const PATH_ERROR: f32 = 0.04;

/// A saccade in saccade.
#[derive(Clone, Copy, Debug)]
pub(super) struct SaccadePath {
    /// Where it left, and when it certainly had not left for long.
    start: EyeSample,
    samples: [EyeSample; KEPT],
    count: usize,
    /// The newest sample, kept or not.
    newest: EyeSample,
    /// Speed over the last step, degrees a second.
    pub(super) speed_deg_s: f32,
    /// Where it will land, as far as the newest sample tells.
    pub(super) landing: Landing,
}

/// Where a saccade will land.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing {
    pub(super) directions: [Vec3; 2],
    /// Standard deviation, degrees.
    pub(super) error_deg: f32,
    /// When, by the main sequence from the last sample before the saccade showed: no later than it is expected.
    pub(super) time_ns: i64,
}

impl SaccadePath {
    /// One that has just shown; samples scatter by `noise_deg`.
    pub(super) fn new(start: EyeSample, first: EyeSample, noise_deg: f32) -> Self {
        let seconds = first.seconds_since(start.time_ns);
        let speed_deg_s = first.angle_deg(start.directions) / seconds;
        let landing = Landing { directions: first.directions, error_deg: 0.0, time_ns: start.time_ns };
        let mut saccade =
            Self { start, samples: [first; KEPT], count: 1, newest: first, speed_deg_s, landing };
        saccade.landing = saccade.predicted(noise_deg);
        saccade
    }

    /// Takes one more sample, after the newest.
    pub(super) fn add(&mut self, sample: EyeSample, noise_deg: f32) {
        let seconds = sample.seconds_since(self.newest.time_ns);
        self.speed_deg_s = sample.angle_deg(self.newest.directions) / seconds;
        self.newest = sample;
        let last = self.samples[self.count - 1];
        let replaced = sample.time_ns.saturating_sub(last.time_ns) < KEPT_STEP_NS || self.count == KEPT;
        if !(replaced && self.count > 1) {
            self.count = (self.count + 1).min(KEPT);
        }
        self.samples[self.count - 1] = sample;
        self.landing = self.predicted(noise_deg);
    }

    pub(super) fn newest(&self) -> &EyeSample {
        &self.newest
    }

    /// Whether there is one sample only.
    pub(super) fn is_single(&self) -> bool {
        self.newest.time_ns == self.samples[0].time_ns
    }

    /// When its first sample was taken.
    pub(super) fn first_ns(&self) -> i64 {
        self.samples[0].time_ns
    }

    /// Where it will land, from all samples so far.
    fn predicted(&self, noise_deg: f32) -> Landing {
        let start = middle(&self.start);
        let now = middle(&self.newest);
        let gone_deg = eccentricity(start, now).to_degrees();
        let (mean_deg, deviation_deg) = self.amplitude(start, now, noise_deg);
        // Across its way it is as uncertain as the way so far tells its direction.
        let across_deg = noise_deg * mean_deg / gone_deg.max(noise_deg);
        let turn = Quat::from_axis_angle(axis(start, now), mean_deg.to_radians());
        Landing {
            directions: self.start.directions.map(|from| (turn * from).normalize_or(from)),
            error_deg: deviation_deg.hypot(across_deg),
            time_ns: self.start.time_ns.saturating_add((f64::from(duration_s(mean_deg)) * 1e9) as i64),
        }
    }

    /// Mean and standard deviation of the amplitude, degrees.
    fn amplitude(&self, start: Vec3, now: Vec3, noise_deg: f32) -> (f32, f32) {
        let away = (now - start * now.dot(start)).normalize_or_zero();
        let mut gone = [(0.0f32, 0.0f32); KEPT];
        for (gone, sample) in gone.iter_mut().zip(&self.samples[..self.count]) {
            let direction = middle(sample);
            let angle = direction.dot(away).atan2(direction.dot(start)).to_degrees();
            *gone = (sample.seconds_since(self.start.time_ns), angle);
        }
        let gone = &gone[..self.count];
        // It left between the sample before the start and the first that shows it.
        let window = UNSEEN_S + 0.95 * gone[0].0;
        let (mut weights, mut mean, mut square) = (0.0f32, 0.0f32, 0.0f32);
        let mut amplitude = LEAST_AMPLITUDE_DEG;
        for _ in 0..AMPLITUDES {
            let scatter = noise_deg.hypot(PATH_ERROR * amplitude);
            let duration = duration_s(amplitude);
            let mut ways = 0.0f32;
            for departure in 0..DEPARTURES {
                let left = window * f32::from(departure) / f32::from(DEPARTURES - 1) - UNSEEN_S;
                let away = |at: f32| amplitude * minimum_jerk((at - left) / duration);
                let at_rest = (away(0.0) / scatter.hypot(UNSEEN_DEG)).powi(2);
                let missed = |(at, angle): &(f32, f32)| ((angle - away(*at)) / scatter).powi(2);
                ways += (-0.5 * (at_rest + gone.iter().map(missed).sum::<f32>())).exp();
            }
            // Each step stands for a range of amplitudes that is as wide as it is large.
            let usual = amplitude * (-amplitude / USUAL_AMPLITUDE_DEG).exp();
            let weight = usual * ways / scatter.powi(gone.len() as i32);
            weights += weight;
            mean += weight * amplitude;
            square += weight * amplitude * amplitude;
            amplitude *= AMPLITUDE_FACTOR;
        }
        // NaN is not more either.
        let told = weights > f32::MIN_POSITIVE;
        if !told {
            // Like no saccade at all: as far as it is, and half as far again.
            let gone = gone[gone.len() - 1].1.abs();
            return (gone, 0.25 * gone);
        }
        let mean = mean / weights;
        (mean, (square / weights - mean * mean).max(0.0).sqrt())
    }
}

/// How long a saccade of an amplitude in degrees takes, seconds: the main sequence (Carpenter 1988).
fn duration_s(amplitude_deg: f32) -> f32 {
    0.021 + 0.0022 * amplitude_deg
}

/// The direction between both eyes'.
fn middle(sample: &EyeSample) -> Vec3 {
    let [left, right] = sample.directions;
    (left + right).normalize_or(left)
}

/// Axis of the shortest turn from one direction to another; any across `from` where they agree.
fn axis(from: Vec3, to: Vec3) -> Vec3 {
    from.cross(to).try_normalize().unwrap_or_else(|| from.any_orthonormal_vector())
}

/// The path of least jerk from 0 to 1 as time goes from 0 to 1.
fn minimum_jerk(s: f32) -> f32 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}
