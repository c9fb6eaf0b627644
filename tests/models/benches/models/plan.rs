//! Cost of `plan`: two eyes of 2160 x 2160 with tiles of 16 x 16, 36,450 tiles, while eyes and head move.

use criterion::Criterion;
use glam::{Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{AudioVisual, EyeInput, PlanInput, PlanSettings, Planner, RateSettings};
use parafovea_core::schedule::{Schedule, UpdateConfiguration};
use std::hint::black_box;
use std::time::Duration;

/// Pixels along each side of a view.
const SIDE: u32 = 2160;

pub fn benches(criterion: &mut Criterion) {
    let rings = PlanSettings { rates: RateSettings::Fixed(FixedFoveation::L1_C1), ..PlanSettings::default() };
    let schedule = Schedule { configuration: UpdateConfiguration::F11233, ..Schedule::default() };
    let rings_and_schedule = PlanSettings { schedule: Some(schedule.into()), ..rings };
    let audio_visual =
        PlanSettings { rates: RateSettings::AudioVisual(AudioVisual::default()), ..rings_and_schedule };
    let paper = PlanSettings { rates: RateSettings::AudioVisual(AudioVisual::PAPER), ..rings_and_schedule };
    let contrast = contrast();
    let mut group = criterion.benchmark_group("plan");
    group.sample_size(20).measurement_time(Duration::from_secs(1));
    for (name, settings) in [
        ("rings", rings),
        ("rings and schedule", rings_and_schedule),
        ("audio-visual and schedule", audio_visual),
        ("audio-visual as in the paper, and schedule", paper),
    ] {
        group.bench_function(name, |bencher| {
            let mut planner = Planner::new(settings);
            let mut frame = 0;
            bencher.iter(|| {
                frame += 1;
                black_box(planner.plan(&input(frame, &contrast)));
            });
        });
    }
    group.finish();
}

/// Contrast of 0.05 to 0.8 at 1 to 100 cd/m^2.
fn contrast() -> ContrastMap {
    let tiles = SIDE / 16;
    let tile = |x: u32, y: u32| {
        let part = |seed: u32| (x * 7 + y * 13 + seed) % 16;
        TileContrast {
            bands: [1, 5, 9, 12].map(|seed| 0.05 * (part(seed) + 1) as f32),
            adaptation_cd_m2: 100.0 / (1 << (part(3) % 7)) as f32,
        }
    };
    ContrastMap { tiles: Plane::from_fn(tiles, tiles, tile) }
}

/// A frame in which the eyes look around, faster than the head.
fn input(frame: u64, contrast: &ContrastMap) -> PlanInput<'_> {
    let angle = frame as f32 * 0.05;
    let look = |turn: f32| Vec3::new(0.3 * angle.cos() + turn, 0.3 * angle.sin(), -1.0).normalize();
    PlanInput {
        time_ns: frame as i64 * 11_111_111,
        frame,
        frame_rate_hz: 90.0,
        eyes: [0.1f32, -0.1].map(|turn| EyeInput {
            offset: [0, 0],
            extent: [SIDE, SIDE],
            fov: Fov { left: -0.9, right: 0.7, up: 0.8, down: -0.85 },
            orientation: Quat::from_rotation_y(turn),
            contrast: Some(contrast),
            refresh: false,
        }),
        head: Quat::from_rotation_y(0.1 * angle),
        gaze: GazeState {
            directions: [look(0.01), look(-0.01)],
            velocity_deg_s: 3.0,
            phase: GazePhase::Fixation,
            trust: 1.0,
            ..GazeState::LOST
        },
        audio: Some(AudioFeatures {
            loudness_lufs: -20.0,
            gamma_ld: 15.0,
            gamma_fq_kilomel: 1.2,
            silent: false,
        }),
    }
}
