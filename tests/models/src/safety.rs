//! Cost of the safety limits while the eyes move, and loss at the true gaze: shares of fully shaded pixels and losses of visible contrast,
//! by the [`Planner`] behind a [`GazeTracker`], in simulated time.
//!
//! Every tile shows the same contrast in each octave, so that no place of the view hides a coarse rate. Losses are
//! castleCSF's at each eye's true gaze in the shown frame, regardless of the tracker.

mod report;

pub use report::{Row, cases, rows, table};

use crate::eyes::{Event, EyePath, HALF_IPD_M, TrackerErrors, TrackerModel, nanoseconds};
use glam::{Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::avpm::SensitivityUnit;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::frco;
use parafovea_core::gaze::{GazePhase, GazeSettings, GazeState, GazeTracker};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{
    AudioVisual, AvailableRates, DeviceRates, EyeInput, EyePlan, LatticeShape, PlanInput, PlanSettings,
    Planner, RateSettings, SafetySettings, Sensitivity, TileLattice,
};
use parafovea_core::rate::VULKAN_RATES;

/// Side of a view, pixels.
pub const SIDE: u32 = 1024;

/// Side of a tile, pixels.
const TEXEL: u32 = 32;

/// Half of a view's field of view, degrees: paper A's headset.
const EDGE_DEG: f32 = 52.0;

/// Frames a second.
const FRAME_HZ: f64 = 90.0;

/// Start of the time that counts, seconds: trust has to rise first.
const WARM_UP_S: f64 = 1.0;

/// Changes are not noticed for so long after landing, seconds (Loschky and Wolverton 2007).
const UNNOTICED_S: f64 = 0.06;

/// Radius of the central area around the true gaze, degrees: the full rate of [`FixedFoveation::L1_C1`], less a tile.
const CENTRAL_DEG: f32 = 12.0;

/// Contrast of every tile in each octave, of the order of natural pictures (Brady and Field 2000), and its luminance, cd/m^2.
const CONTRAST: f32 = 0.1;
const LUMINANCE_CD_M2: f32 = 50.0;

/// Source of the gaze.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gaze {
    /// The true gaze, without safety limits.
    TrueWithoutSafety,
    /// A tracker.
    Tracked {
        /// The tracker.
        model: TrackerModel,
        /// Its errors.
        errors: TrackerErrors,
        /// Whether the fixation distance is known.
        depth: bool,
    },
}

/// Source of rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rates {
    /// Eccentricity alone.
    Rings,
    /// Contrast and a loud sound, too.
    Contrast,
}

/// Whether the eyes move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eyes {
    /// They rest on one thing, far away at the centre of the view.
    Resting,
    /// Fixations, saccades, pursuits and blinks.
    Moving,
}

/// A case: eye movement, gaze and settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// As it is printed.
    pub name: &'static str,
    /// Movement of the eyes.
    pub eyes: Eyes,
    /// Source of the gaze.
    pub gaze: Gaze,
    /// Source of rates.
    pub rates: Rates,
}

/// State of the eyes in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In a saccade.
    Flight,
    /// Within 60 ms after landing.
    Landing,
    /// Later.
    Looking,
}

impl When {
    /// All.
    pub const ALL: [Self; 3] = [Self::Flight, Self::Landing, Self::Looking];

    fn of(path: &EyePath, t: f64) -> Option<Self> {
        if path.is_blink(t) {
            return None;
        }
        Some(match path.event(t) {
            Event::Jumping(_) => Self::Flight,
            Event::Looking(number) if t < path.looks()[number].start_s + UNNOTICED_S => Self::Landing,
            Event::Looking(_) => Self::Looking,
        })
    }
}

/// Means over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    frames: u32,
    sums: [f64; 4],
}

impl Mean {
    fn add(&mut self, values: [f64; 4]) {
        self.frames += 1;
        for (sum, value) in self.sums.iter_mut().zip(values) {
            *sum += value;
        }
    }

    fn of(&self, index: usize) -> f64 {
        self.sums[index] / f64::from(self.frames)
    }

    /// Invocations for each pixel.
    pub fn share(&self) -> f64 {
        self.of(0)
    }

    /// Loss over all tiles, just noticeable differences.
    pub fn loss(&self) -> f64 {
        self.of(1)
    }

    /// Loss over the tiles around the true gaze, just noticeable differences.
    pub fn central_loss(&self) -> f64 {
        self.of(2)
    }

    /// Share of the tiles around the true gaze that lose more than a just noticeable difference.
    pub fn central_detected(&self) -> f64 {
        self.of(3)
    }
}

/// Measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Over all frames, including blinks; losses exclude blinks.
    pub all: Mean,
    /// By [`When::ALL`].
    pub when: [Mean; 3],
}

/// Follows the gaze of some seeds, each for `duration_s`.
pub fn follow(case: &Case, coarsens_suppressed: bool, seeds: &[u64], duration_s: f64) -> Score {
    let mut score = Score::default();
    for seed in seeds {
        let path = match case.eyes {
            Eyes::Moving => EyePath::new(*seed, duration_s),
            Eyes::Resting => EyePath::resting(duration_s),
        };
        follow_path(case, coarsens_suppressed, &path, *seed, duration_s, &mut score);
    }
    score
}

fn fov() -> Fov {
    let edge = EDGE_DEG.to_radians();
    Fov { left: -edge, right: edge, up: edge, down: -edge }
}

fn follow_path(
    case: &Case,
    coarsens_suppressed: bool,
    path: &EyePath,
    seed: u64,
    duration_s: f64,
    score: &mut Score,
) {
    let (reports, safety) = match case.gaze {
        Gaze::TrueWithoutSafety => (Vec::new(), SafetySettings::PAPER),
        Gaze::Tracked { model, errors, .. } => {
            let mut safety = SafetySettings::default();
            if !coarsens_suppressed {
                safety.suppressed_octaves_per_s = 0.0;
            }
            (model.reports_with(errors, path, seed, duration_s), safety)
        }
    };
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let mut planner = Planner::new(PlanSettings {
        rates: match case.rates {
            Rates::Rings => RateSettings::Fixed(FixedFoveation::L1_C1),
            // Within rings, so that the central region is at full rate in both.
            Rates::Contrast => RateSettings::AudioVisual(AudioVisual {
                cap: Some(FixedFoveation::L1_C3),
                ..AudioVisual::default()
            }),
        },
        safety,
        device: DeviceRates { available: AvailableRates::new(&VULKAN_RATES), texel: [TEXEL; 2] },
        ..PlanSettings::default()
    });
    let eyes_m = [-HALF_IPD_M, HALF_IPD_M].map(|x| Vec3::X * x as f32);
    let mut judge = Judge::new();
    let [columns, rows] = judge.lattice.tiles();
    let tile = TileContrast { bands: [CONTRAST; 4], adaptation_cd_m2: LUMINANCE_CD_M2 };
    let contrast = ContrastMap { tiles: Plane::filled(columns, rows, tile) };
    let mut reports = reports.iter().peekable();
    for frame in 0..(duration_s * FRAME_HZ) as u64 {
        let shown = frame as f64 / FRAME_HZ;
        while let Some(report) = reports.next_if(|report| report.known_s <= shown) {
            tracker.push_at(&report.sample, nanoseconds(shown));
        }
        let truth = path.eyes_at(shown).map(|direction| direction.as_vec3());
        let state = match case.gaze {
            Gaze::TrueWithoutSafety => {
                GazeState { directions: truth, phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST }
            }
            Gaze::Tracked { depth, errors, .. } => {
                let distance_m = depth.then(|| (1.0 / path.at(shown - errors.latency_s).1) as f32);
                tracker.state(nanoseconds(shown)).with_vergence(eyes_m, distance_m)
            }
        };
        let eye = EyeInput {
            offset: [0; 2],
            extent: [SIDE; 2],
            fov: fov(),
            orientation: Quat::IDENTITY,
            contrast: (case.rates == Rates::Contrast).then_some(&contrast),
            refresh: false,
        };
        let plan = planner.plan(&PlanInput {
            time_ns: nanoseconds(shown),
            frame,
            frame_rate_hz: FRAME_HZ as f32,
            eyes: [eye, eye],
            head: Quat::IDENTITY,
            gaze: state,
            audio: Some(AudioFeatures {
                loudness_lufs: -15.0,
                gamma_ld: 20.0,
                gamma_fq_kilomel: 1.0,
                silent: false,
            }),
        });
        if shown < WARM_UP_S {
            continue;
        }
        for (eye, truth) in plan.eyes.iter().zip(truth) {
            let values = judge.values(eye, truth);
            if let Some(when) = When::of(path, shown) {
                score.when[when as usize].add(values);
            }
            score.all.add(values);
        }
    }
}

/// Losses of plans.
struct Judge {
    lattice: TileLattice,
    chords: Vec<f32>,
    sensitivity: Sensitivity,
}

impl Judge {
    fn new() -> Self {
        let mut lattice = TileLattice::default();
        lattice.set(&LatticeShape { offset: [0; 2], extent: [SIDE; 2], fov: fov(), texel: [TEXEL; 2] });
        let [columns, rows] = lattice.tiles();
        Self {
            chords: vec![0.0; (columns * rows) as usize],
            lattice,
            sensitivity: Sensitivity::new(SensitivityUnit::CastleCsf),
        }
    }

    /// As [`Mean`] has them.
    fn values(&mut self, plan: &EyePlan, gaze: Vec3) -> [f64; 4] {
        self.lattice.nearest([gaze; 2], &mut self.chords);
        let [columns, _] = self.lattice.tiles();
        let (mut loss, mut central, mut detected, mut count) = (0.0, 0.0, 0.0, 0.0f64);
        let tiles = (0..).zip(&self.chords).zip(self.lattice.resolution());
        for ((index, chord), resolution) in tiles {
            let rate = plan.rate(index % columns, index / columns);
            let eccentricity_deg = (2.0 * (chord.sqrt() / 2.0).min(1.0).asin()).to_degrees();
            let is_central = eccentricity_deg < CENTRAL_DEG;
            count += f64::from(u8::from(is_central));
            if rate.octaves() == 0.0 {
                continue;
            }
            let seen = self.sensitivity.bands(*resolution, eccentricity_deg, LUMINANCE_CD_M2);
            let lost = f64::from(frco::loss(seen.map(|seen| seen * CONTRAST), rate));
            loss += lost;
            if is_central {
                central += lost;
                detected += f64::from(u8::from(lost > 1.0));
            }
        }
        let share = f64::from(plan.statistics().mean_rate);
        [share, loss / self.chords.len() as f64, central / count.max(1.0), detected / count.max(1.0)]
    }
}
