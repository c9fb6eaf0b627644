//! The plan that is shown in the README of `parafovea-core`.
//!
//! Two canted eyes look at a made-up room, up and to the left, while it is loud: a plain upper half, a lower half full
//! of detail, and a few bright bars.

use glam::{Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{Buffers, ContrastSettings, analyze};
use parafovea_core::perception::ContrastMap;
use parafovea_core::plan::{
    AudioVisual, EyeInput, FramePlan, PlanInput, PlanSettings, Planner, RateSettings,
};
use parafovea_core::schedule::{Schedule, UpdateConfiguration};

/// Pixels along each side of a view.
const SIDE: u32 = 1440;

/// Width of each eye's view in the README's picture, pixels.
pub const PICTURE_WIDTH: u32 = 600;

/// The plan of the room after a second, when all rates have settled.
pub fn plan() -> FramePlan {
    let mut contrast = ContrastMap::default();
    analyze(&room(), &ContrastSettings::default(), &mut Buffers::default(), &mut contrast);
    let schedule = Schedule { configuration: UpdateConfiguration::F11223, ..Schedule::default() };
    let mut planner = Planner::new(PlanSettings {
        rates: RateSettings::AudioVisual(AudioVisual::default()),
        schedule: Some(schedule.into()),
        ..PlanSettings::default()
    });
    for frame in 0..90 {
        planner.plan(&input(frame, &contrast));
    }
    planner.plan(&input(90, &contrast)).clone()
}

fn input(frame: u64, contrast: &ContrastMap) -> PlanInput<'_> {
    let eye = |sign: f32| EyeInput {
        offset: [0, 0],
        extent: [SIDE, SIDE],
        fov: Fov { left: -0.85 - 0.08 * sign, right: 0.85 - 0.08 * sign, up: 0.85, down: -0.9 },
        orientation: Quat::from_rotation_y(0.09 * sign),
        contrast: Some(contrast),
        refresh: false,
    };
    // At something a metre away.
    let look = |sign: f32| Vec3::new(-0.2 + 0.032 * sign, 0.1, -1.0).normalize();
    PlanInput {
        time_ns: frame as i64 * 11_111_111,
        frame,
        frame_rate_hz: 90.0,
        eyes: [eye(1.0), eye(-1.0)],
        head: Quat::IDENTITY,
        gaze: GazeState {
            directions: [look(1.0), look(-1.0)],
            velocity_deg_s: 2.0,
            phase: GazePhase::Fixation,
            trust: 1.0,
            ..GazeState::LOST
        },
        audio: Some(AudioFeatures {
            loudness_lufs: -18.0,
            gamma_ld: 17.0,
            gamma_fq_kilomel: 1.4,
            silent: false,
        }),
    }
}

/// Luminance of the room, cd/m^2.
fn room() -> Plane {
    Plane::from_fn(SIDE, SIDE, |x, y| {
        let bar = x % 360 < 12 && y > 200;
        let grain =
            (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519)).wrapping_mul(3_266_489_917);
        let detail = if y > SIDE / 2 { (grain >> 24) as f32 / 255.0 } else { 0.5 };
        if bar { 90.0 } else { 20.0 + 10.0 * (y as f32 * 0.004).sin() + 24.0 * (detail - 0.5) }
    })
}
