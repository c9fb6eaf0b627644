//! Errors at the true gaze.

use super::movement::{Movement, Movements};
use crate::eyes::{Follower, Random, Report, nanoseconds};
use glam::{DVec3, Vec3};
use parafovea_core::gaze::{GazeSample, GazeSettings, GazeState, GazeTracker};

/// Rates of trackers, Hz.
pub const RATES_HZ: [f64; 4] = [20.0, 60.0, 120.0, 240.0];

/// From the eye to the image, milliseconds.
pub const DELAYS_MS: [f64; 4] = [10.0, 30.0, 50.0, 80.0];

/// Seeds of the table. The constants of the tracker were chosen on 7, 19 and 42.
pub const SEEDS: [u64; 5] = [101, 102, 103, 104, 105];

/// Length of the gaze of one seed, seconds.
const DURATION_S: f64 = 120.0;

/// Time that a frame is shown, seconds.
const FRAME_S: f64 = 1.0 / 90.0;

/// Earlier frames do not count.
const WARM_UP_S: f64 = 1.0;

/// Standard deviation of a sample along either axis, degrees: as of the tracker of [`crate::eyes`].
const NOISE_DEG: f64 = 0.3;

/// Time from the start of a saccade to the first sample that shows it, seconds: a fifth of the way, with noise.
const TOLD_S: f64 = 0.01;

/// Frames of a mean error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// From the beginning of a saccade until 100 ms after its landing.
    Saccades,
    /// Of these, the ones for which a sample that shows the saccade is known. The others cannot be predicted.
    Told,
    /// The eyes rest.
    Fixations,
    /// They follow something.
    Pursuits,
}

impl Frames {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 4] = [Self::Saccades, Self::Told, Self::Fixations, Self::Pursuits];
}

/// Source of the gaze of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    /// The newest sample.
    NewestSample,
    /// [`GazeTracker`].
    Tracker,
}

/// Mean errors.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    sums: [f64; 4],
    counts: [u32; 4],
}

impl Errors {
    /// Mean error, degrees.
    pub fn mean_deg(&self, frames: Frames) -> f64 {
        self.sums[frames as usize] / f64::from(self.counts[frames as usize])
    }

    fn add(&mut self, frames: Frames, error_deg: f64) {
        self.sums[frames as usize] += error_deg;
        self.counts[frames as usize] += 1;
    }
}

/// Errors over all of some seeds.
pub fn measure(predictor: Predictor, rate_hz: f64, delay_ms: f64, seeds: &[u64]) -> Errors {
    let mut errors = Errors::default();
    for seed in seeds {
        let path = Movements::new(*seed, DURATION_S + 1.0);
        let reports = reports(&path, rate_hz, delay_ms * 1e-3, *seed);
        match predictor {
            Predictor::NewestSample => follow(&mut NewestSample::default(), &path, &reports, &mut errors),
            Predictor::Tracker => {
                follow(&mut GazeTracker::new(GazeSettings::default()), &path, &reports, &mut errors);
            }
        }
    }
    errors
}

fn reports(path: &Movements, rate_hz: f64, delay_s: f64, seed: u64) -> Vec<Report> {
    let random = &mut Random::new(seed, 12);
    let phase = random.within(0.0, 1.0);
    let report = |number: u32| {
        let t = (f64::from(number) + phase + random.within(-0.03, 0.03)) / rate_hz;
        let truth = path.at(t);
        let (right, up) = truth.any_orthonormal_pair();
        let noise = [right, up].map(|axis| axis * random.normal() * NOISE_DEG.to_radians());
        let seen = (truth + noise[0] + noise[1]).normalize().as_vec3();
        let sample =
            GazeSample { directions: [seen; 2], time_ns: nanoseconds(t), uncertainty_ns: 0, valid: true };
        Report { sample, known_s: t + delay_s }
    };
    (0..(DURATION_S * rate_hz) as u32).map(report).collect()
}

fn follow(follower: &mut dyn Follower, path: &Movements, reports: &[Report], errors: &mut Errors) {
    let (mut next, mut newest_ns) = (0, 0);
    for frame in 0..(DURATION_S / FRAME_S) as u32 {
        let shown = f64::from(frame) * FRAME_S;
        while let Some(report) = reports.get(next).filter(|report| report.known_s <= shown) {
            follower.take(report, shown);
            newest_ns = report.sample.time_ns;
            next += 1;
        }
        if shown < WARM_UP_S {
            continue;
        }
        let error_deg = angle_deg(follower.state(shown).directions[0].as_dvec3(), path.at(shown));
        match path.movement(shown) {
            Movement::Saccade { begun_s } => {
                errors.add(Frames::Saccades, error_deg);
                if newest_ns >= nanoseconds(begun_s + TOLD_S) {
                    errors.add(Frames::Told, error_deg);
                }
            }
            Movement::Fixation => errors.add(Frames::Fixations, error_deg),
            Movement::Pursuit => errors.add(Frames::Pursuits, error_deg),
        }
    }
}

/// Angle between unit vectors, degrees, exact for small ones too.
fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[derive(Debug, Default)]
struct NewestSample(Option<Vec3>);

impl Follower for NewestSample {
    fn take(&mut self, report: &Report, _now_s: f64) {
        self.0 = Some(report.sample.directions[0]);
    }

    fn state(&self, _now_s: f64) -> GazeState {
        GazeState { directions: [self.0.unwrap_or(Vec3::NEG_Z); 2], ..GazeState::LOST }
    }
}
