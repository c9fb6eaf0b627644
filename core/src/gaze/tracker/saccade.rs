//! A saccade in flight, and its landing.
//!
//! Saccades are ballistic: the duration follows from the amplitude (main sequence: 21 ms + 2.2 ms a degree, Carpenter 1988),
//! and the path is nearly that of least jerk (Flash and Hogan 1985). So the samples since departure give the likelihood of
//! each amplitude, departure and pace, and with these the directions of the eyes at any later time.

use super::line_fit::EyeSample;
use crate::geometry::eccentricity;
use glam::{Quat, Vec3, Vec4};
use std::iter;

/// Samples that are kept, evenly enough over the longest saccade.
const KEPT: usize = 10;

/// Least time between two that are kept: the longest saccade has room.
const KEPT_STEP_NS: i64 = 7_500_000;

/// Amplitudes that are weighed, from the least on, each larger by the same factor; degrees.
const AMPLITUDES: usize = 28;
const LEAST_AMPLITUDE_DEG: f32 = 1.0;
const AMPLITUDE_FACTOR: f32 = 1.145;

/// Mean amplitude of saccades before anything is known of one, degrees: most natural ones are below 15 (Bahill et al. 1975).
const USUAL_AMPLITUDE_DEG: f32 = 10.0;

/// Times of departure that are weighed, four in a vector.
const DEPARTURES: usize = 12;

/// Sum of squared misses, in standard deviations, from which on a course has a likelihood of 0.
const MOST_MISSES: f32 = 170.0;

/// Durations beside the main sequence's, and how usual they are: single saccades and single people differ by about 15 % (Bahill,
/// Clark and Stark 1975).
const PACES: [(f32, f32); 3] = [(0.85, 0.25), (1.0, 0.5), (1.2, 0.25)];

/// Longest time for which a saccade may have been in flight at the last sample before it showed, seconds: a margin.
const UNSEEN_S: f32 = 0.005;

/// Part of its duration after which less than 1 % of its way is left.
const LANDED: f32 = 0.9;

/// Possible deviation of a path from that of least jerk, as a part of its amplitude.
const PATH_ERROR: f32 = 0.04;

/// A saccade under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct SaccadePath {
    /// Starting point, with a time at which it had not left, or only just.
    start: EyeSample,
    samples: [EyeSample; KEPT],
    count: usize,
    /// Times of the last sample that did not show it, and of the first that did.
    left_ns: i64,
    shown_ns: i64,
    /// The newest sample.
    newest: EyeSample,
    /// Speed over the last step, degrees a second.
    pub(super) speed_deg_s: f32,
    /// Its landing, as estimated at the newest sample.
    pub(super) landing: Landing,
}

/// Landing of a saccade.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing {
    /// Standard deviation, degrees.
    pub(super) error_deg: f32,
    /// Landing time by the main sequence from the last sample before the saccade showed: no later than it is expected.
    pub(super) time_ns: i64,
    /// Time at which hardly any of the way is left, by the course.
    nearly_ns: i64,
    course: Course,
}

/// Course of a saccade: the median of the amplitudes, and means of the others at that.
#[derive(Clone, Copy, Debug)]
struct Course {
    /// Axis about which the eyes turn.
    axis: Vec3,
    amplitude_deg: f32,
    /// Standard deviation of the amplitude.
    deviation_deg: f32,
    /// From the start of the saccade to the departure, seconds.
    departure_s: f32,
    duration_s: f32,
}

impl SaccadePath {
    /// One that has just shown in `shown`, after samples since the start that did not show it; samples scatter by `noise_deg`.
    pub(super) fn new(start: EyeSample, before: &[EyeSample], shown: EyeSample, noise_deg: f32) -> Self {
        let last = before.last().unwrap_or(&start);
        let seconds = shown.seconds_since(last.time_ns);
        let speed_deg_s = shown.angle_deg(last.directions) / seconds;
        let mut samples = [shown; KEPT];
        samples[..before.len()].copy_from_slice(before);
        let landing = Landing {
            error_deg: 0.0,
            time_ns: start.time_ns,
            nearly_ns: start.time_ns,
            course: Course::NONE,
        };
        let count = before.len() + 1;
        let mut saccade = Self {
            start,
            samples,
            count,
            left_ns: last.time_ns,
            shown_ns: shown.time_ns,
            newest: shown,
            speed_deg_s,
            landing,
        };
        saccade.landing = saccade.predicted(noise_deg);
        saccade
    }

    /// Takes one more sample, after the newest.
    pub(super) fn add(&mut self, sample: EyeSample, noise_deg: f32) {
        let seconds = sample.seconds_since(self.newest.time_ns);
        self.speed_deg_s = sample.angle_deg(self.newest.directions) / seconds;
        self.newest = sample;
        // The newest sample is always kept: in place of the last one, if that is too near to its predecessor.
        let before = self.count.checked_sub(2).map(|index| self.samples[index].time_ns);
        let replaced = before
            .is_some_and(|before| self.samples[self.count - 1].time_ns.saturating_sub(before) < KEPT_STEP_NS);
        if !replaced {
            self.count = (self.count + 1).min(KEPT);
        }
        self.samples[self.count - 1] = sample;
        self.landing = self.predicted(noise_deg);
    }

    pub(super) fn newest(&self) -> &EyeSample {
        &self.newest
    }

    /// Whether one sample alone shows it.
    pub(super) fn is_single(&self) -> bool {
        self.newest.time_ns == self.shown_ns
    }

    /// Time of the sample that showed it.
    pub(super) fn shown_ns(&self) -> i64 {
        self.shown_ns
    }

    /// Directions of the eyes some seconds after the newest sample, with their possible error, degrees.
    pub(super) fn ahead(&self, seconds: f32) -> ([Vec3; 2], f32) {
        let course = &self.landing.course;
        let gone_deg = course.gone_deg(self.newest.seconds_since(self.start.time_ns) + seconds);
        let turn = Quat::from_axis_angle(course.axis, gone_deg.to_radians());
        (self.start.directions.map(|from| (turn * from).normalize_or(from)), self.landing.error_deg)
    }

    /// Whether it has landed by its newest sample.
    pub(super) fn has_landed(&self) -> bool {
        self.landing.nearly_ns <= self.newest.time_ns
    }

    /// Time at which it landed, if it has: rather too early, so that changes are not taken to go unnoticed for too long.
    pub(super) fn landed_ns(&self) -> i64 {
        self.landing.time_ns.min(self.landing.nearly_ns)
    }

    /// Predicted landing, from all samples so far.
    fn predicted(&self, noise_deg: f32) -> Landing {
        let start = middle(&self.start);
        let samples = &self.samples[..self.count];
        // The sum gives farther samples more weight: they determine the direction better.
        let away: Vec3 = samples.iter().map(|sample| middle(sample) - start).sum::<Vec3>();
        let toward = (start + away).normalize_or(start);
        let gone_deg = eccentricity(start, middle(&self.newest)).to_degrees();
        let course = self.course(start, toward, noise_deg);
        // Across its path the landing is as uncertain as the direction of the path so far.
        let across_deg = noise_deg * course.amplitude_deg / gone_deg.max(noise_deg);
        let after = |time_ns: i64, seconds: f32| time_ns.saturating_add((f64::from(seconds) * 1e9) as i64);
        Landing {
            error_deg: course.deviation_deg.hypot(across_deg),
            time_ns: after(self.left_ns, duration_s(course.amplitude_deg)),
            nearly_ns: after(self.start.time_ns, course.departure_s + LANDED * course.duration_s),
            course,
        }
    }

    /// The course towards a direction.
    fn course(&self, start: Vec3, toward: Vec3, noise_deg: f32) -> Course {
        let axis = axis(start, toward);
        let away = axis.cross(start);
        let mut gone = [(0.0f32, 0.0f32); KEPT];
        for (gone, sample) in gone.iter_mut().zip(&self.samples[..self.count]) {
            let direction = middle(sample);
            let angle = direction.dot(away).atan2(direction.dot(start)).to_degrees();
            *gone = (sample.seconds_since(self.start.time_ns), angle);
        }
        let gone = &gone[..self.count];
        // It left between the sample before the start and the first that shows it.
        let shown_s = (self.shown_ns.saturating_sub(self.start.time_ns) as f64 * 1e-9) as f32;
        let window = UNSEEN_S + 0.95 * shown_s;
        let farthest = gone.iter().map(|(_, angle)| *angle).fold(0.0, f32::max);
        let step = window / (DEPARTURES - 1) as f32;
        let departures: [Vec4; DEPARTURES / 4] = std::array::from_fn(|vector| {
            Vec4::from(std::array::from_fn(|lane| step * (4 * vector + lane) as f32 - UNSEEN_S))
        });
        let mut likelihoods = [Likelihood::default(); AMPLITUDES];
        let mut amplitude = LEAST_AMPLITUDE_DEG;
        for likelihood in &mut likelihoods {
            likelihood.amplitude_deg = amplitude;
            // Each step stands for a range of amplitudes as wide as its own amplitude.
            let scatter = noise_deg.hypot(PATH_ERROR * amplitude);
            if ((farthest - amplitude).max(0.0) / scatter).powi(2) > MOST_MISSES {
                amplitude *= AMPLITUDE_FACTOR;
                continue;
            }
            let usual =
                amplitude * (-amplitude / USUAL_AMPLITUDE_DEG).exp() / scatter.powi(gone.len() as i32);
            for (pace, share) in PACES {
                let duration = pace * duration_s(amplitude);
                let mut misses = [Vec4::ZERO; DEPARTURES / 4];
                for (at, angle) in iter::once(&(0.0, 0.0)).chain(gone) {
                    for (misses, left) in misses.iter_mut().zip(&departures) {
                        let way = minimum_jerk((*at - *left) * duration.recip());
                        let missed = (*angle - amplitude * way) * scatter.recip();
                        *misses += missed * missed;
                    }
                }
                let lanes = |vectors: [Vec4; DEPARTURES / 4]| {
                    vectors.into_iter().flat_map(|vector| vector.to_array())
                };
                for (misses, left) in lanes(misses).zip(lanes(departures)) {
                    if misses < MOST_MISSES {
                        likelihood.add(share * usual * (-0.5 * misses).exp(), left, duration);
                    }
                }
            }
            amplitude *= AMPLITUDE_FACTOR;
        }
        Course::of(axis, &likelihoods).unwrap_or_else(|| {
            // Like no saccade at all: it is where its newest sample is.
            let (at, gone) = gone[gone.len() - 1];
            let amplitude_deg = gone.abs();
            Course {
                axis,
                amplitude_deg,
                deviation_deg: 0.25 * amplitude_deg,
                departure_s: at - 1.0,
                duration_s: 1.0,
            }
        })
    }
}

/// Likelihood of an amplitude, and sums over the departures and durations that it is likely with.
#[derive(Clone, Copy, Debug, Default)]
struct Likelihood {
    amplitude_deg: f32,
    weight: f32,
    departures: f32,
    durations: f32,
}

impl Likelihood {
    fn add(&mut self, weight: f32, departure_s: f32, duration_s: f32) {
        self.weight += weight;
        self.departures += weight * departure_s;
        self.durations += weight * duration_s;
    }
}

impl Course {
    /// Until something is known.
    const NONE: Self =
        Self { axis: Vec3::Y, amplitude_deg: 0.0, deviation_deg: 0.0, departure_s: 0.0, duration_s: 1.0 };

    /// Angle from the start, degrees, so many seconds after it.
    fn gone_deg(&self, seconds: f32) -> f32 {
        self.amplitude_deg * minimum_jerk(Vec4::splat((seconds - self.departure_s) / self.duration_s)).x
    }

    /// Of the median amplitude, from which the least error is to be expected; `None` where none is likely.
    fn of(axis: Vec3, likelihoods: &[Likelihood; AMPLITUDES]) -> Option<Self> {
        let whole: f32 = likelihoods.iter().map(|likelihood| likelihood.weight).sum();
        // NaN is not more either.
        let told = whole > f32::MIN_POSITIVE;
        if !told {
            return None;
        }
        let mut less = 0.0;
        let median = likelihoods.iter().find(|likelihood| {
            less += likelihood.weight;
            less >= 0.5 * whole
        })?;
        // Share of the median's step below the median.
        let part = (less - 0.5 * whole) / median.weight;
        let amplitude_deg = median.amplitude_deg * AMPLITUDE_FACTOR.powf(0.5 - part);
        let square =
            |likelihood: &Likelihood| likelihood.weight * (likelihood.amplitude_deg - amplitude_deg).powi(2);
        Some(Self {
            axis,
            amplitude_deg,
            deviation_deg: (likelihoods.iter().map(square).sum::<f32>() / whole).sqrt(),
            departure_s: median.departures / median.weight,
            duration_s: median.durations / median.weight,
        })
    }
}

/// Duration of a saccade of an amplitude in degrees, seconds: the main sequence (Carpenter 1988).
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
fn minimum_jerk(s: Vec4) -> Vec4 {
    let s = s.clamp(Vec4::ZERO, Vec4::ONE);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}
