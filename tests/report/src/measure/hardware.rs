//! Maps over the pictures of the application alone.

use super::{EYE_OF_JOD, at_once, errors, flights, show};
use crate::hardware::{HardwarePoint, Look, Rates};
use crate::plan::Plan;
use crate::points::Sweep;
use crate::results::{Cost, PointResults, SceneResults, mean};
use glam::{Quat, Vec2, Vec3};
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::image::Plane;
use parafovea_core::mask::{Mask, MaskView, TileRates};
use parafovea_core::plan::{EyeInput, PlanInput, PlanSettings, Planner, RateSettings, SafetySettings};
use parafovea_core::rate::ShadingRate;
use parafovea_models::errors::Picture;
use parafovea_scene::openxr_toolkit::ScreenEllipses;
use parafovea_test_layers::{
    SHADING_RATE_GPU_VARIABLE, SHADING_RATE_TEXELS_VARIABLE, ShadingRateLine, ShadingRatePass,
    ShadingRateProfile,
};
use parafovea_tests::HarnessError;
use parafovea_tests::measure::{Effort, JudgedRun, Subject, Technique, fov, jod_shaded, judge_shaded};
use parafovea_tests::run::Outcome;
use parafovea_tests::scenario::Scenario;
use std::thread::available_parallelism;

/// Side of a tile where we choose it, pixels: paper A's.
const TEXEL: u32 = 16;

/// The rates of one eye in one frame.
#[derive(Clone, Debug)]
struct EyeRates {
    tile: [u32; 2],
    rates: Plane<ShadingRate>,
}

impl EyeRates {
    fn at(&self, x: u32, y: u32) -> ShadingRate {
        self.rates.at(x / self.tile[0], y / self.tile[1])
    }

    /// Samples for each pixel.
    fn share(&self) -> f64 {
        let texels = self.rates.texels();
        texels.iter().map(|rate| f64::from(rate.fraction())).sum::<f64>() / texels.len().max(1) as f64
    }

    /// The mask of a device without shading rates.
    fn mask(&self, extent: [u32; 2]) -> Mask {
        let bytes: Vec<u8> = self.rates.texels().iter().map(|rate| rate.texel()).collect();
        let tiles = TileRates { texel: self.tile, first: [0; 2], columns: self.rates.width(), rates: &bytes };
        let mut mask = Mask::new(extent, 1);
        mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent, tiles }]);
        mask
    }
}

/// All points in a scene, behind the application alone. `others` were judged by their own pictures, which look on any device as they
/// do here; their cost is the share of the pixels that they have.
pub fn measure(
    plan: &Plan,
    (subject, scenario, effort): (&Subject, &Scenario, Effort),
    reference: &Outcome,
    others: &[PointResults],
) -> Result<SceneResults, HarnessError> {
    let frames = effort.frames as usize;
    let in_flight = flights(subject, effort);
    let mut found = vec![result(Sweep::Off, "off", vec![1.0; frames], None)];
    found.extend(others.iter().filter(|other| other.sweep == Sweep::RenderScale).map(|other| {
        let scale = other.technique.rsplit(' ').next().and_then(|scale| scale.parse::<f64>().ok());
        let share = scale.map_or(f64::NAN, |scale| scale * scale);
        result(other.sweep, &other.technique, vec![share; frames], other.errors.clone())
    }));
    let run = JudgedRun { subject, scenario, outcome: reference };
    for together in plan.hardware.chunks(available_parallelism().map_or(1, usize::from)) {
        let planned = together
            .iter()
            .map(|point| Ok((point, maps(&point.rates, (subject, scenario, effort), reference)?)));
        let planned = planned.collect::<Result<Vec<_>, HarnessError>>()?;
        let judged = at_once(&planned, |(_, maps)| {
            let look = |frame: u64, eye: usize, picture: &Picture| {
                let map = &maps[(frame - effort.run_up) as usize][eye];
                match plan.look {
                    Look::Rates => picture.shaded_at(|x, y| map.at(x, y)),
                    Look::Mask => picture.filled_by(&map.mask(picture.extent())),
                }
            };
            let report = judge_shaded(subject, scenario, reference, look)?;
            let jod = plan.fvvdp.as_ref().map(|fvvdp| {
                jod_shaded(fvvdp, run, EYE_OF_JOD, |frame, picture| look(frame, EYE_OF_JOD, picture))
            });
            Ok(errors(&report, &in_flight, jod.transpose()?.map(|jod| jod.differences)))
        })?;
        for ((HardwarePoint { sweep, name, .. }, maps), errors) in planned.iter().zip(judged) {
            let share = |eye: &EyeRates| match plan.look {
                Look::Rates => eye.share(),
                Look::Mask => f64::from(eye.mask([effort.size; 2]).shaded()),
            };
            let shares = maps.iter().map(|eyes| eyes.iter().map(share).sum::<f64>() / 2.0);
            found.push(result(*sweep, name, shares.collect(), Some(errors)));
        }
    }
    let scene = subject.name().to_owned();
    Ok(SceneResults { scene, points: found, bits: Vec::new(), frames_of_script: frames })
}

/// Appends the frames of another gaze script; rings and metrics without frames become means.
pub fn join(all: &mut SceneResults, next: SceneResults) {
    let scripts = all.frames_of_script.max(1);
    for (point, next) in all.points.iter_mut().zip(next.points) {
        if let (Some(cost), Some(next)) = (&mut point.cost, next.cost) {
            cost.frames_ms.extend(next.frames_ms);
            cost.ratio = mean(cost.frames_ms.iter().copied()).unwrap_or(f64::NAN);
            cost.median_ms = cost.ratio;
            cost.p99_ms = cost.p99_ms.max(next.p99_ms);
        }
        let (Some(errors), Some(next)) = (&mut point.errors, next.errors) else { continue };
        let before = (errors.loss.len() / scripts).max(1) as f64;
        let with = |old: &mut Option<f64>, new: Option<f64>| {
            *old = match (*old, new) {
                (Some(old), Some(new)) => Some((before * old + new) / (before + 1.0)),
                (old, new) => old.or(new),
            };
        };
        errors.loss.extend(next.loss);
        errors.detected.extend(next.detected);
        errors.in_flight.extend(next.in_flight);
        if let (Some(fvvdp), Some(next)) = (&mut errors.fvvdp, next.fvvdp) {
            fvvdp.by_frame.extend(next.by_frame);
        }
        errors.sustained.iter_mut().zip(next.sustained).for_each(|(old, new)| with(old, new));
        errors.transient.iter_mut().zip(next.transient).for_each(|(old, new)| with(old, new));
        with(&mut errors.flicker, next.flicker);
        with(&mut errors.chroma, next.chroma);
        with(&mut errors.flip, next.flip);
    }
}

/// The result of a map with these shares of the pixels.
fn result(
    sweep: Sweep,
    name: &str,
    shares: Vec<f64>,
    errors: Option<crate::results::Errors>,
) -> PointResults {
    let ratio = mean(shares.iter().copied()).unwrap_or(f64::NAN);
    let most = shares.iter().copied().fold(0.0, f64::max);
    let cost = Cost { median_ms: ratio, p99_ms: most, ratio, spread: 0.0, frames_ms: shares };
    let technique = name.to_owned();
    PointResults { sweep, technique, fragments: 0, samples: None, cost: Some(cost), errors }
}

/// The maps of both eyes in each frame after the run-up.
fn maps(
    rates: &Rates,
    (subject, scenario, effort): (&Subject, &Scenario, Effort),
    reference: &Outcome,
) -> Result<Vec<[EyeRates; 2]>, HarnessError> {
    let tiles = effort.size.div_ceil(TEXEL);
    let filled = |rate: &dyn Fn(u32, u32) -> ShadingRate| EyeRates {
        tile: [TEXEL; 2],
        rates: Plane::from_fn(tiles, tiles, rate),
    };
    let same = |rate: &dyn Fn(u32, u32) -> ShadingRate| {
        let eye = filled(rate);
        vec![[eye.clone(), eye]; effort.frames as usize]
    };
    Ok(match rates {
        Rates::Uniform(rate) => same(&|_, _| *rate),
        Rates::Ellipses(ellipses) => same(&|x, y| of_ellipses(ellipses, [x, y], tiles)),
        Rates::Fixed(map) => {
            let settings = PlanSettings {
                rates: RateSettings::Fixed(*map),
                safety: SafetySettings::PAPER,
                ..PlanSettings::default()
            };
            let mut planner = Planner::new(settings);
            let frames = effort.run_up..effort.length();
            frames.map(|frame| around_the_gaze(&mut planner, subject, scenario, effort, frame)).collect()
        }
        Rates::Layer(technique) => attached(technique, (subject, scenario, effort), reference)?,
    })
}

fn of_ellipses(ellipses: &ScreenEllipses, tile: [u32; 2], tiles: u32) -> ShadingRate {
    let offset = tile.map(|index| (2.0 * index as f32 + 1.0) / tiles as f32 - 1.0);
    ellipses.shading_rate(Vec2::from(offset))
}

/// FR, by where each eye truly looks.
fn around_the_gaze(
    planner: &mut Planner,
    subject: &Subject,
    scenario: &Scenario,
    effort: Effort,
    frame: u64,
) -> [EyeRates; 2] {
    let mut planned = |eye: usize| {
        let Some(view) = scenario.views.get(eye) else {
            return EyeRates { tile: [TEXEL; 2], rates: Plane::filled(1, 1, ShadingRate::R1X1) };
        };
        let input = |extent| EyeInput {
            offset: [0; 2],
            extent,
            fov: fov(view),
            orientation: Quat::IDENTITY,
            contrast: None,
            refresh: false,
        };
        let gaze = subject.true_gaze(frame, view).normalize_or(Vec3::NEG_Z);
        let input = PlanInput {
            time_ns: 0,
            frame,
            frame_rate_hz: 90.0,
            eyes: [input([effort.size; 2]), input([0; 2])],
            head: Quat::IDENTITY,
            gaze: GazeState {
                directions: [gaze; 2],
                phase: GazePhase::Fixation,
                trust: 1.0,
                ..GazeState::LOST
            },
            audio: None,
        };
        let plan = &planner.plan(&input).eyes[0];
        let tiles = effort.size.div_ceil(TEXEL);
        EyeRates { tile: [TEXEL; 2], rates: Plane::from_fn(tiles, tiles, |x, y| plan.rate(x, y)) }
    };
    [planned(0), planned(1)]
}

/// The maps that the layer attached to the passes of each eye, of which there is one a frame: the left one comes first.
fn attached(
    technique: &Technique,
    (subject, scenario, effort): (&Subject, &Scenario, Effort),
    reference: &Outcome,
) -> Result<Vec<[EyeRates; 2]>, HarnessError> {
    // The pictures of this run are not used.
    let mut scenario = scenario.clone();
    scenario.output.save_frames.clear();
    let outcome = show(subject, technique, effort, &scenario, |run| {
        run.shading_rates(ShadingRateProfile::NvkTuring)
            .env(SHADING_RATE_TEXELS_VARIABLE, "1")
            .env(SHADING_RATE_GPU_VARIABLE, "1")
    })?;
    let lines = outcome.shading_rates()?.into_iter();
    let passes: Vec<ShadingRatePass> = lines
        .filter_map(|line| match line {
            ShadingRateLine::Pass(pass) if pass.area[2..] == [effort.size; 2] => Some(pass),
            _ => None,
        })
        .collect();
    let wanted = 2 * effort.frames as usize;
    let Some(first) = passes.len().checked_sub(wanted) else {
        return Err(reference.failed(&format!(
            "{}: {} passes with a map where {wanted} were to be judged",
            technique.name,
            passes.len()
        )));
    };
    let unread = || outcome.failed(&format!("{}: a map could not be read", technique.name));
    let eyes: Option<Vec<EyeRates>> = passes[first..].iter().map(rates_of).collect();
    let eyes = eyes.ok_or_else(unread)?;
    Ok(eyes.as_chunks::<2>().0.to_vec())
}

fn rates_of(pass: &ShadingRatePass) -> Option<EyeRates> {
    let map = pass.map.as_ref()?;
    let [columns, rows, _] = map.extent;
    let digits = map.texels.as_ref()?;
    let texel = |x: u32, y: u32| {
        let at = (y * columns + x) as usize * 2;
        u8::from_str_radix(digits.get(at..at + 2)?, 16).ok().and_then(ShadingRate::from_texel)
    };
    let all: Option<Vec<ShadingRate>> =
        (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
    let all = all?;
    let rates = Plane::from_fn(columns, rows, |x, y| all[(y * columns + x) as usize]);
    Some(EyeRates { tile: pass.texel, rates })
}
