//! Hard cases of `plan`.

use super::Case;
use crate::reference::plan::{View, fixed_rate};
use glam::{DQuat, DVec3, Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{
    AudioVisual, EyeInput, EyePlan, FramePlan, PlanInput, PlanSettings, Planner, RateSettings, SafetySettings,
};
use parafovea_core::rate::PAPER_RATES;
use parafovea_core::schedule::{Schedule, UpdateConfiguration};

pub(super) fn cases() -> Vec<Case> {
    [images(), views(), gazes(), clocks(), contrasts()].concat()
}

/// FR_L1-C1.
const MAP: FixedFoveation = FixedFoveation::L1_C1;

fn eye<'a>(extent: [u32; 2]) -> EyeInput<'a> {
    EyeInput {
        offset: [0, 0],
        extent,
        fov: Fov { left: -0.9, right: 0.75, up: 0.8, down: -0.85 },
        orientation: Quat::IDENTITY,
        contrast: None,
        refresh: false,
    }
}

fn input(eye: EyeInput<'_>) -> PlanInput<'_> {
    let gaze = Vec3::new(0.1, 0.05, -1.0).normalize();
    PlanInput {
        time_ns: 0,
        frame: 0,
        frame_rate_hz: 100.0,
        eyes: [eye; 2],
        head: Quat::IDENTITY,
        gaze: looking(gaze),
        audio: None,
    }
}

fn looking(gaze: Vec3) -> GazeState {
    GazeState { directions: [gaze; 2], phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST }
}

/// A plan without safety limits, which is settled at once.
fn plan(input: &PlanInput) -> FramePlan {
    planner(SafetySettings::PAPER).plan(input).clone()
}

fn planner(safety: SafetySettings) -> Planner {
    Planner::new(PlanSettings { rates: RateSettings::Fixed(MAP), safety, ..PlanSettings::default() })
}

fn is_full(eye: &EyePlan) -> bool {
    eye.rates.texels().iter().all(|texel| *texel == 0) && eye.ages.texels().iter().all(|age| *age == 0)
}

/// Mean rate by the reference, weighted by the pixels of each tile.
fn reference_mean(eye: &EyeInput, gaze: Vec3) -> f64 {
    let view = View {
        offset: eye.offset,
        extent: eye.extent,
        fov: eye.fov,
        orientation: DQuat::IDENTITY,
        texel: [16, 16],
    };
    let gazes = [DVec3::from(gaze).normalize(); 2];
    // First pixel of the view in, and pixels beyond, each column or row of tiles.
    let covered = |axis: usize| {
        let (first, last) = (eye.offset[axis], eye.offset[axis] + eye.extent[axis]);
        let lines = (first / 16..last.div_ceil(16))
            .map(move |line| f64::from((line * 16 + 16).min(last)) - f64::from((line * 16).max(first)));
        lines.collect::<Vec<f64>>()
    };
    let (widths, heights) = (covered(0), covered(1));
    let mut sum = 0.0;
    for (y, height) in heights.iter().enumerate() {
        for (x, width) in widths.iter().enumerate() {
            let angle = view.least_eccentricity_deg([x as u32, y as u32], gazes);
            sum += f64::from(fixed_rate(&MAP, angle, &PAPER_RATES).fraction()) * width * height;
        }
    }
    sum / (f64::from(eye.extent[0]) * f64::from(eye.extent[1]))
}

fn images() -> Vec<Case> {
    let sizes = [
        ("1x1 image", [0, 0], [1, 1]),
        ("1x4000 image", [0, 0], [1, 4000]),
        ("odd size and offset", [7, 21], [1283, 957]),
        ("8192x8192 image", [0, 0], [8192, 8192]),
    ];
    let cases = sizes.map(|(name, offset, extent)| {
        let eye = EyeInput { offset, ..eye(extent) };
        let input = input(eye);
        let mean = f64::from(plan(&input).eyes[0].statistics().mean_rate);
        let expected = reference_mean(&eye, input.gaze.directions[0]);
        let error = (mean - expected).abs();
        Case {
            model: "plan",
            case: name.to_owned(),
            expected: format!("mean rate {expected:.5} within 1e-4"),
            got: format!("{mean:.5}"),
            error: Some(error),
            passed: error < 1e-4,
        }
    });
    let extremes = vec![
        told("image without pixels", "no tiles, mean rate 1", || {
            let plan = plan(&input(eye([0, 500])));
            (plan.eyes[0].statistics().tiles, plan.eyes[0].statistics().mean_rate) == (0, 1.0)
        }),
        told("image of 2^32 - 1 pixels a side at that offset", "finite, no panic", || {
            let eye = EyeInput { offset: [u32::MAX; 2], ..eye([u32::MAX, 3]) };
            plan(&input(eye)).eyes[0].statistics().mean_rate.is_finite()
        }),
    ];
    [cases.to_vec(), extremes].concat()
}

/// A case that either holds or does not.
fn told(case: &str, expected: &'static str, holds: impl FnOnce() -> bool) -> Case {
    let passed = holds();
    Case {
        model: "plan",
        case: case.to_owned(),
        expected: expected.to_owned(),
        got: if passed { "as expected" } else { "not so" }.to_owned(),
        error: None,
        passed,
    }
}

fn views() -> Vec<Case> {
    let usual = || eye([640, 560]);
    let fov = |left, right, up, down| EyeInput { fov: Fov { left, right, up, down }, ..usual() };
    let turned = |orientation| EyeInput { orientation, ..usual() };
    let rates = |eye: EyeInput| plan(&input(eye)).eyes[0].rates.clone();
    let about = Quat::from_rotation_x(0.2);
    let full = |eye: EyeInput| is_full(&plan(&input(eye)).eyes[0]);
    vec![
        told("fov NaN", "full rate", || full(fov(f32::NAN, 0.7, 0.8, -0.8))),
        told("fov infinite", "full rate", || full(fov(f32::NEG_INFINITY, 0.7, 0.8, -0.8))),
        told("fov of zero width", "full rate", || full(fov(0.3, 0.3, 0.8, -0.8))),
        told("fov of zero", "full rate", || full(fov(0.0, 0.0, 0.0, 0.0))),
        told("fov flipped in y", "the map upside down", || {
            let (map, flipped) = (rates(fov(-0.9, 0.75, 0.8, -0.85)), rates(fov(-0.9, 0.75, -0.85, 0.8)));
            (0..35).all(|y| map.row(y) == flipped.row(34 - y))
        }),
        told("fov of 178 degrees and beyond", "finite, periphery at 1/16", || {
            let map = rates(fov(-1.7, 1.7, 1.7, -1.7));
            map.at(0, 0) == 10
        }),
        told("orientation zero", "full rate", || full(turned(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)))),
        told("orientation NaN", "full rate", || full(turned(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)))),
        told("orientation -q", "as q", || rates(turned(-about)) == rates(turned(about))),
        told("orientation 1000 q", "as q", || rates(turned(about * 1000.0)) == rates(turned(about))),
    ]
}

fn gazes() -> Vec<Case> {
    let of = |gaze: Vec3| plan(&PlanInput { gaze: looking(gaze), ..input(eye([640, 560])) }).eyes[0].clone();
    let ahead = of(Vec3::NEG_Z);
    vec![
        told("gaze NaN", "full rate", || is_full(&of(Vec3::NAN))),
        told("gaze zero", "full rate", || is_full(&of(Vec3::ZERO))),
        told("gaze infinite", "full rate", || is_full(&of(Vec3::INFINITY))),
        told("gaze of length 1e-20 and 1e20", "as of length 1", || {
            of(Vec3::new(0.0, 0.0, -1e-20)).rates == ahead.rates
                && of(Vec3::new(0.0, 0.0, -1e20)).rates == ahead.rates
        }),
        told("gaze 1e-8, 1e-7 and 1e-6 rad beside ahead", "as ahead", || {
            [1e-8, 1e-7, 1e-6].iter().all(|angle| of(Vec3::new(*angle, 0.0, -1.0)).rates == ahead.rates)
        }),
        told("gaze at 90 degrees", "coarse, finer on that side", || {
            let eye = of(Vec3::X);
            eye.rate(0, 17).octaves() == 2.0 && eye.statistics().mean_rate < 0.07
        }),
        told("gaze at 180 degrees", "1/16 everywhere", || of(Vec3::Z).statistics().mean_rate == 0.0625),
        told("one eye's gaze NaN", "that of the other for both", || {
            let gaze = GazeState { directions: [Vec3::NAN, Vec3::NEG_Z], ..looking(Vec3::NEG_Z) };
            plan(&PlanInput { gaze, ..input(eye([640, 560])) }).eyes[0].rates == ahead.rates
        }),
        told("speed of the eyes NaN", "30 degrees at full rate", || {
            let gaze = GazeState { velocity_deg_s: f32::NAN, ..looking(Vec3::NEG_Z) };
            planner(SafetySettings::default()).plan(&PlanInput { gaze, ..input(eye([64, 64])) }).inflation_deg
                == 25.0
        }),
    ]
}

fn clocks() -> Vec<Case> {
    /// 30 days in nanoseconds.
    const DAYS_30: i64 = 30 * 24 * 3600 * 1_000_000_000;
    let after = |stamps: &[i64]| {
        let mut planner = planner(SafetySettings::default());
        let input = input(eye([640, 560]));
        for (frame, &time_ns) in stamps.iter().enumerate() {
            planner.plan(&PlanInput { frame: frame as u64, time_ns, ..input });
        }
        planner
            .plan(&PlanInput { frame: stamps.len() as u64, time_ns: stamps[stamps.len() - 1], ..input })
            .clone()
    };
    let from = |start: i64| (0..60).map(|frame| start + frame * 10_000_000).collect::<Vec<i64>>();
    let reused = |first: u64, frame_rate_hz: f32| {
        let schedule = Schedule { configuration: UpdateConfiguration::F12345, ..Schedule::default() };
        let mut planner =
            Planner::new(PlanSettings { schedule: Some(schedule.into()), ..PlanSettings::default() });
        let shares: Vec<f32> = (0..10)
            .map(|frame| {
                let frame =
                    PlanInput { frame: first.wrapping_add(frame), frame_rate_hz, ..input(eye([640, 560])) };
                planner.plan(&frame).eyes[0].statistics().pixel_share
            })
            .collect();
        shares[1..].iter().all(|share| *share < 0.8)
    };
    vec![
        told("time of 30 days", "as from 0", || {
            after(&from(DAYS_30)).eyes[0].rates == after(&from(0)).eyes[0].rates
        }),
        told("all stamps equal", "full rate", || is_full(&after(&[5; 60]).eyes[0])),
        told("reversed stamps", "full rate", || {
            is_full(&after(&from(0).into_iter().rev().collect::<Vec<i64>>()).eyes[0])
        }),
        told("from the first to the last stamp there is", "0.4 octaves at most", || {
            is_full(&after(&[i64::MIN, i64::MAX]).eyes[0])
        }),
        told("frame numbers up to 2^64 and from 0 on", "re-used as before", || reused(u64::MAX - 4, 100.0)),
        told("frame rate NaN, 0, infinite", "nothing re-used", || {
            [f32::NAN, 0.0, f32::INFINITY].iter().all(|rate| !reused(0, *rate))
        }),
    ]
}

fn contrasts() -> Vec<Case> {
    let loud = AudioFeatures { loudness_lufs: -10.0, gamma_ld: 25.0, gamma_fq_kilomel: 1.0, silent: false };
    let rates = |map: &ContrastMap, audio: AudioFeatures| {
        let model = AudioVisual { cap: None, ..AudioVisual::default() };
        let mut planner = Planner::new(PlanSettings {
            rates: RateSettings::AudioVisual(model),
            safety: SafetySettings::PAPER,
            ..PlanSettings::default()
        });
        let eye = EyeInput { contrast: Some(map), ..eye([640, 560]) };
        planner.plan(&PlanInput { audio: Some(audio), ..input(eye) }).eyes[0].rates.clone()
    };
    let of = |tile: TileContrast| ContrastMap { tiles: Plane::filled(40, 35, tile) };
    let flat = |adaptation_cd_m2: f32| TileContrast { bands: [0.0; 4], adaptation_cd_m2 };
    let with = |odd: f32, adaptation_cd_m2: f32| {
        let mut map = of(flat(50.0));
        map.tiles.row_mut(3)[4] = TileContrast { bands: [odd, 0.0, 0.0, 0.0], adaptation_cd_m2 };
        rates(&map, loud)
    };
    let all_but_that_coarse = |rates: &Plane<u8>| {
        let others = rates.texels().iter().enumerate().filter(|(index, _)| *index != 3 * 40 + 4);
        others.into_iter().all(|(_, texel)| *texel == 10)
    };
    vec![
        told("contrast NaN, infinite in one tile", "full rate there, 1/16 elsewhere", || {
            [f32::NAN, f32::INFINITY]
                .iter()
                .map(|odd| with(*odd, 50.0))
                .all(|rates| rates.at(4, 3) == 0 && all_but_that_coarse(&rates))
        }),
        told("luminance NaN, infinite, negative in one tile", "1/16 elsewhere", || {
            [f32::NAN, f32::INFINITY, -1.0].iter().all(|odd| all_but_that_coarse(&with(0.5, *odd)))
        }),
        told("black, white, 10,000 cd/m^2 without contrast", "1/16", || {
            [0.0, 100.0, 1e4]
                .iter()
                .all(|light| rates(&of(flat(*light)), loud).texels().iter().all(|it| *it == 10))
        }),
        told("features of sound NaN", "fixed foveation", || {
            let unknown = AudioFeatures { gamma_ld: f32::NAN, gamma_fq_kilomel: f32::NAN, ..loud };
            rates(&of(flat(50.0)), unknown) == plan(&input(eye([640, 560]))).eyes[0].rates
        }),
        told("contrast of another size", "fixed foveation", || {
            let other = ContrastMap { tiles: Plane::filled(39, 35, flat(50.0)) };
            rates(&other, loud) == plan(&input(eye([640, 560]))).eyes[0].rates
        }),
    ]
}
