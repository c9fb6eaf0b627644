//! The images of `manifest/HOW-IT-WORKS.md`: each `debug.view`, over grey squares that stand for a scene.
//!
//! One eye looks up and to the left; rates are rings, and the periphery is re-used.

use glam::{Quat, Vec3};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::kernels::compose::PixelFormat;
use parafovea_core::kernels::debug_view::{
    DebugView, DebugViewParams, MapShape, debug_view_image, map_row_bytes,
};
use parafovea_core::plan::{EyeInput, EyePlan, PlanInput, PlanSettings, Planner, RateSettings};
use parafovea_core::schedule::{Schedule, UpdateConfiguration};

/// Pixels along each side.
pub const SIDE: u32 = 480;

const FOV: Fov = Fov { left: -0.82, right: 0.82, up: 0.82, down: -0.82 };

/// Each view with the name of its picture, without folder and extension.
pub const VIEWS: [(DebugView, &str); 4] = [
    (DebugView::Gaze, "gaze"),
    (DebugView::Eccentricity, "eccentricity"),
    (DebugView::Rates, "rates"),
    (DebugView::Age, "age"),
];

/// The left eye's image with a view on, sRGB.
pub fn picture(view: DebugView) -> Plane<[u8; 3]> {
    let eye = plan();
    let tiles = match view {
        DebugView::Age => &eye.ages,
        DebugView::Rates | DebugView::Eccentricity | DebugView::Gaze | DebugView::Ahead => &eye.rates,
    };
    let shape = MapShape { extent: eye.extent, texel: eye.texel, tiles: [tiles.width(), tiles.height()] };
    let mut map = Vec::new();
    for row in 0..tiles.height() {
        map.extend_from_slice(tiles.row(row));
        map.resize((row + 1) as usize * map_row_bytes(tiles.width()) as usize, 0);
    }
    let params = DebugViewParams::new(view, [0, 0], [SIDE; 2], FOV, eye.gaze, &shape);
    let squares = |index: u32| {
        let [x, y] = [index % SIDE, index / SIDE];
        let grey = if (x / 30 + y / 30).is_multiple_of(2) { 150 } else { 90 };
        [grey, grey, grey, 255]
    };
    let mut pixels: Vec<u8> = (0..SIDE * SIDE).flat_map(squares).collect();
    debug_view_image(&mut pixels, SIDE, PixelFormat::Rgba8Srgb, &params, &map);
    Plane::from_fn(SIDE, SIDE, |x, y| {
        let at = (y * SIDE + x) as usize * 4;
        [pixels[at], pixels[at + 1], pixels[at + 2]]
    })
}

/// The plan of the left eye after a second, when rates have settled.
fn plan() -> EyePlan {
    let schedule = Schedule { configuration: UpdateConfiguration::F11223, ..Schedule::default() };
    let mut planner = Planner::new(PlanSettings {
        rates: RateSettings::Fixed(FixedFoveation::L1_C1),
        schedule: Some(schedule.into()),
        ..PlanSettings::default()
    });
    for frame in 0..90 {
        planner.plan(&input(frame));
    }
    planner.plan(&input(90)).eyes[0].clone()
}

fn input(frame: u64) -> PlanInput<'static> {
    let eye = EyeInput {
        offset: [0, 0],
        extent: [SIDE, SIDE],
        fov: FOV,
        orientation: Quat::IDENTITY,
        contrast: None,
        refresh: false,
    };
    let gaze = Vec3::new(-0.25, 0.15, -1.0).normalize();
    PlanInput {
        time_ns: frame as i64 * 11_111_111,
        frame,
        frame_rate_hz: 90.0,
        eyes: [eye; 2],
        head: Quat::IDENTITY,
        gaze: GazeState { directions: [gaze; 2], phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST },
        audio: None,
    }
}
