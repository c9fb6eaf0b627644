//! Every number among the options of rates and chroma acts one way, over all of its allowed range.

use super::{Config, PlannedDevice, chroma_settings, plan_settings};
use glam::{Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::chroma::{ChromaTemporalFilter, Curves};
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{EyeInput, PlanInput, PlanSettings, Planner, SafetySettings};
use parafovea_core::rate::VULKAN_RATES;
use parafovea_manifest::config::parse;
use parafovea_manifest::options::{Allowed, OPTIONS};
use std::path::Path;

/// Values of an option that are looked at, ends included.
const STEPS: u16 = 16;

/// Least change of an effect from one half of the range to the other.
const LEAST_CHANGE: f32 = 2e-5;

/// Tiles of a view, which shows 104 degrees.
const TILES: u32 = 48;

fn config(settings: &str) -> Config {
    parse(Path::new("test.toml"), settings)
        .unwrap_or_else(|errors| panic!("{settings}: {:?}", errors.errors()))
}

/// Shading of a view whose contrast rises from left to right, with a sound that hides as much as any, once nothing moves.
fn shaded(config: &Config) -> f32 {
    let device = PlannedDevice { rates: &VULKAN_RATES, texel: [16; 2], is_cpu: true, has_mask: false };
    let settings = plan_settings(config, &device);
    let at_once = f32::INFINITY;
    let safety = SafetySettings {
        coarsening_octaves_per_s: at_once,
        contrast_octaves_per_s: at_once,
        ..settings.safety
    };
    let mut planner = Planner::new(PlanSettings { contrast_on_gpu: false, safety, ..settings });
    let map = ContrastMap {
        tiles: Plane::from_fn(TILES, TILES, |x, _| TileContrast {
            bands: [0.004 * (x + 1) as f32; 4],
            adaptation_cd_m2: 0.05 * config.rates.white_cd_m2,
        }),
    };
    let edge = 52f32.to_radians();
    let eye = EyeInput {
        offset: [0; 2],
        extent: [TILES * 16; 2],
        fov: Fov { left: -edge, right: edge, up: edge, down: -edge },
        orientation: Quat::IDENTITY,
        contrast: Some(&map),
        refresh: false,
    };
    let input = PlanInput {
        time_ns: 0,
        frame: 0,
        frame_rate_hz: 90.0,
        eyes: [eye; 2],
        head: Quat::IDENTITY,
        gaze: GazeState { phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST },
        audio: Some(AudioFeatures {
            loudness_lufs: -10.0,
            gamma_ld: 25.0,
            gamma_fq_kilomel: 1.0,
            silent: false,
        }),
    };
    planner.plan(&input).eyes[0].statistics().mean_rate
}

/// Mean chroma gain.
fn colour(config: &Config, of: fn(parafovea_core::chroma::Gains) -> f32) -> f32 {
    let curves = Curves::new(&chroma_settings(config).unwrap());
    let eccentricities = (0..1000).map(|index| index as f32 * 2e-3);
    eccentricities.map(|eccentricity| of(curves.gains(eccentricity))).sum::<f32>() / 1000.0
}

/// Strength of chroma attenuation 5 ms after it was switched on.
fn strength(config: &Config) -> f32 {
    let settings = chroma_settings(config).unwrap();
    let mut filter = ChromaTemporalFilter::default();
    filter.show_full_color(0);
    filter.update(Some(Vec3::NEG_Z), 5_000_000, &settings).map_or(0.0, |focus| focus.strength)
}

/// The effect of an option, whether it rises with the option, and other settings.
type Effect = (fn(&Config) -> f32, bool, &'static str);

fn effects(key: &str) -> Vec<Effect> {
    let by_sound = "rates.mode = \"audio-visual\"";
    let (attenuated, paper) = ("chroma.mode = \"default\"", "chroma.mode = \"paper\"");
    match key {
        "rates.foveal_deg" | "rates.transitional_deg" => vec![(shaded, true, "")],
        "rates.greatest_loss" => vec![(shaded, false, by_sound)],
        "rates.white_cd_m2" => vec![(shaded, true, by_sound)],
        "chroma.cb_bound" => {
            let cb: fn(&Config) -> f32 = |config| colour(config, |gains| gains.cb);
            vec![(cb, false, paper)]
        }
        "chroma.cr_bound" => {
            let cr: fn(&Config) -> f32 = |config| colour(config, |gains| gains.cr);
            vec![(cr, true, paper)]
        }
        "chroma.plateau_deg" | "chroma.rim_fade" => {
            vec![(|config| colour(config, |gains| gains.mean()), true, attenuated)]
        }
        "chroma.max_eccentricity_deg" => {
            let mean: fn(&Config) -> f32 = |config| colour(config, |gains| gains.mean());
            vec![(mean, true, attenuated), (mean, true, paper)]
        }
        "chroma.max_change_per_s" => vec![(strength, true, attenuated)],
        other => panic!("{other}: no expected direction is listed"),
    }
}

#[test]
fn every_number_acts_one_way_over_its_whole_range() {
    for option in OPTIONS.iter().filter(|option| ["rates", "chroma"].contains(&option.section)) {
        let Allowed::Number { min, max } = option.allowed() else { continue };
        let key = option.key();
        for (effect, rises, with) in effects(&key) {
            let value = |step: u16| min + (max - min) * f32::from(step) / f32::from(STEPS);
            let seen: Vec<_> = (0..=STEPS)
                .map(|step| effect(&config(&format!("{with}\n{key} = {:?}\n", value(step).clamp(min, max)))))
                .map(|seen| if rises { seen } else { -seen })
                .collect();
            assert!(seen.is_sorted_by(|a, b| a <= &(b + 1e-6)), "{key}, {with}: {seen:?}");
            let (first, middle, last) = (seen[0], seen[usize::from(STEPS / 2)], seen[usize::from(STEPS)]);
            let is_felt = middle - first > LEAST_CHANGE && last - middle > LEAST_CHANGE;
            assert!(is_felt, "{key}, {with}: {seen:?}");
        }
    }
}
