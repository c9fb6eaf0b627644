//! The plan against its reference in double precision, and its demand for memory.

use glam::{DQuat, DVec3, Quat, Vec3};
use parafovea_core::audio::AudioFeatures;
use parafovea_core::avpm::{BudgetSettings, SensitivityUnit};
use parafovea_core::chroma::ChromaSettings;
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::gaze::{GazePhase, GazeState};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::plan::{
    AudioVisual, EyeInput, FramePlan, PlanInput, PlanSettings, Planner, RateSettings, SafetySettings,
};
use parafovea_core::rate::{PAPER_RATES, ShadingRate};
use parafovea_core::schedule::{Schedule, UpdateConfiguration};
use parafovea_models::reference::plan::{Sensitivity, View, contrast_rate, fixed_rate};
use proptest::prelude::*;

/// Angle to which the plan places the borders of rings, degrees.
const TIE_DEG: f64 = 1e-3;

fn input(eyes: [EyeInput<'_>; 2], gazes: [Vec3; 2]) -> PlanInput<'_> {
    PlanInput {
        time_ns: 0,
        frame: 0,
        frame_rate_hz: 90.0,
        eyes,
        head: Quat::IDENTITY,
        gaze: GazeState { directions: gazes, phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST },
        audio: None,
    }
}

fn eye<'a>() -> EyeInput<'a> {
    EyeInput {
        offset: [0, 0],
        extent: [640, 560],
        fov: Fov { left: -0.9, right: 0.75, up: 0.8, down: -0.85 },
        orientation: Quat::from_rotation_y(0.1),
        contrast: None,
        refresh: false,
    }
}

fn any_eye() -> impl Strategy<Value = EyeInput<'static>> {
    let fov = (-1.1f32..-0.2, 0.2f32..1.1, 0.2f32..1.1, -1.1f32..-0.2);
    let turn = (-0.5f32..0.5, -0.5f32..0.5, 0.5f32..3.0);
    ([0u32..100, 0u32..100], [1u32..900, 1u32..900], fov, turn).prop_map(
        |(offset, extent, (left, right, up, down), (yaw, pitch, length))| EyeInput {
            offset,
            extent,
            fov: Fov { left, right, up, down },
            orientation: Quat::from_euler(glam::EulerRot::YXZ, yaw, pitch, 0.1) * length,
            contrast: None,
            refresh: false,
        },
    )
}

fn gaze() -> impl Strategy<Value = Vec3> {
    (-1.3f32..1.3, -1.3f32..1.3).prop_map(|(x, y)| Vec3::new(x, y, -1.0).normalize())
}

fn map() -> impl Strategy<Value = FixedFoveation> {
    let peripheral = prop_oneof![Just(ShadingRate::R4X4), Just(ShadingRate::R2X2)];
    (0.0f32..30.0, 0.0f32..50.0, peripheral).prop_map(|(foveal_deg, more_deg, peripheral)| FixedFoveation {
        foveal_deg,
        transitional_deg: foveal_deg + more_deg,
        peripheral,
    })
}

fn without_safety_limits(rates: RateSettings) -> PlanSettings {
    PlanSettings { rates, safety: SafetySettings::PAPER, ..PlanSettings::default() }
}

fn reference(eye: &EyeInput) -> View {
    View {
        offset: eye.offset,
        extent: eye.extent,
        fov: eye.fov,
        orientation: eye.orientation.as_dquat().normalize(),
        texel: [16, 16],
    }
}

fn exact(gazes: [Vec3; 2]) -> [DVec3; 2] {
    gazes.map(|gaze| gaze.as_dvec3().normalize())
}

/// Tiles of a plan, each with its eye and its eccentricity in double precision.
fn tiles<'a>(
    plan: &'a FramePlan,
    input: &'a PlanInput,
) -> impl Iterator<Item = (usize, [u32; 2], f64, ShadingRate)> + 'a {
    let gazes = exact(input.gaze.directions);
    plan.eyes.iter().zip(&input.eyes).enumerate().flat_map(move |(index, (planned, eye))| {
        let (columns, rows) = (planned.rates.width(), planned.rates.height());
        let tiles = (0..rows).flat_map(move |y| (0..columns).map(move |x| [x, y]));
        tiles.map(move |tile| {
            let angle = reference(eye).least_eccentricity_deg(tile, gazes);
            (index, tile, angle, planned.rate(tile[0], tile[1]))
        })
    })
}

fn is_between(rate: ShadingRate, fine: ShadingRate, coarse: ShadingRate) -> bool {
    (fine.octaves()..=coarse.octaves()).contains(&rate.octaves())
}

#[test]
fn rates_change_where_the_rings_of_the_pilot_study_do() {
    for map in FixedFoveation::PILOT {
        let input = input([eye(), eye()], [Vec3::NEG_Z, Vec3::new(0.05, 0.0, -1.0)]);
        let mut planner = Planner::new(without_safety_limits(RateSettings::Fixed(map)));
        for (index, tile, angle, rate) in tiles(planner.plan(&input), &input) {
            let expected = fixed_rate(&map, angle, &PAPER_RATES);
            assert_eq!(rate, expected, "tile {tile:?} of eye {index} at {angle} degrees");
        }
    }
}

#[test]
fn steady_frames_ask_for_no_memory() {
    let tile = TileContrast { bands: [0.3, 0.2, 0.1, 0.1], adaptation_cd_m2: 40.0 };
    let contrast = ContrastMap { tiles: Plane::filled(40, 35, tile) };
    let schedule = Schedule { configuration: UpdateConfiguration::F11233, ..Schedule::default() };
    for rates in [
        RateSettings::Fixed(FixedFoveation::L1_C1),
        RateSettings::AudioVisual(AudioVisual::default()),
        RateSettings::AudioVisual(AudioVisual::PAPER),
    ] {
        let mut planner = Planner::new(PlanSettings {
            rates,
            schedule: Some(schedule.into()),
            chroma: Some(ChromaSettings::default()),
            ..PlanSettings::default()
        });
        let mut plan = |frame: u64| {
            let turn = frame as f32 * 0.03;
            let gaze = Vec3::new(0.5 * turn.sin(), 0.3 * turn.cos(), -1.0);
            let eye = EyeInput { contrast: Some(&contrast), ..eye() };
            let audio =
                AudioFeatures { loudness_lufs: -18.0, gamma_ld: 17.0, gamma_fq_kilomel: 1.5, silent: false };
            planner.plan(&PlanInput {
                time_ns: frame as i64 * 11_111_111,
                frame,
                head: Quat::from_rotation_y(turn),
                audio: Some(audio),
                ..input([eye, eye], [gaze, gaze])
            });
        };
        // The first frames make room; a turn of the head can meet an edge of the cube of cells later.
        (0..210).for_each(&mut plan);
        let demand = allocation_counter::measure(|| (210..420).for_each(&mut plan));
        assert_eq!(demand.count_total, 0, "{rates:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn rings_are_those_of_the_reference(eyes in [any_eye(), any_eye()], gazes in [gaze(), gaze()], map in map()) {
        let input = input(eyes, gazes);
        let mut planner = Planner::new(without_safety_limits(RateSettings::Fixed(map)));
        let (mut count, mut ties) = (0, 0);
        for (index, tile, angle, rate) in tiles(planner.plan(&input), &input) {
            let fine = fixed_rate(&map, angle - TIE_DEG, &PAPER_RATES);
            let coarse = fixed_rate(&map, angle + TIE_DEG, &PAPER_RATES);
            prop_assert!(
                is_between(rate, fine, coarse), "tile {tile:?} of eye {index} at {angle} degrees: {rate:?}, not {fine:?}"
            );
            count += 1;
            ties += usize::from(fine != coarse);
        }
        // A tile is a degree or so wide, of which 2 TIE_DEG are a tie with each of four borders; but a map that
        // begins at 0 degrees has its border in the tile that is looked at.
        prop_assert!(ties <= 6 + count / 100, "{ties} of {count} tiles are ties");
    }

    /// With all safety limits, once the rates have settled.
    #[test]
    fn settled_rates_are_those_of_the_widened_rings(eyes in [any_eye(), any_eye()], gazes in [gaze(), gaze()], map in map()) {
        let settings = PlanSettings { rates: RateSettings::Fixed(map), ..PlanSettings::default() };
        let safety = settings.safety;
        let mut planner = Planner::new(settings);
        let input = input(eyes, gazes);
        for frame in 0..15 {
            planner.plan(&PlanInput { frame, time_ns: frame as i64 * 50_000_000, ..input });
        }
        let plan = planner.plan(&PlanInput { frame: 15, time_ns: 15 * 50_000_000, ..input });
        let at = |angle: f64| {
            if angle < f64::from(safety.least_foveal_deg) {
                ShadingRate::R1X1
            } else {
                fixed_rate(&map, angle, &PAPER_RATES)
            }
        };
        let widened = f64::from(safety.tracker_error_deg);
        for (index, tile, angle, rate) in tiles(plan, &input) {
            let fine = at(angle - widened - f64::from(safety.hysteresis_deg) - TIE_DEG);
            let coarse = at(angle - widened + TIE_DEG);
            prop_assert!(
                is_between(rate, fine, coarse), "tile {tile:?} of eye {index} at {angle} degrees: {rate:?}, not {fine:?}"
            );
        }
    }

    #[test]
    fn contrast_permits_what_the_reference_does(
        gazes in [gaze(), gaze()], gamma_ld in 0.0f32..25.0, gamma_fq_kilomel in 1.0f32..2.5, scale in -6.0f32..1.0,
        castle in any::<bool>(),
    ) {
        let tile = |x: u32, y: u32| {
            let part = |factor: u32| (x * 7 + y * 13 + x * y * factor) % 17;
            TileContrast {
                bands: [1, 2, 3, 5].map(|factor| part(factor) as f32 / 16.0 * scale.exp2()),
                adaptation_cd_m2: (part(11) as f32 * 0.75 - 4.0).exp2(),
            }
        };
        let contrast = ContrastMap { tiles: Plane::from_fn(40, 35, tile) };
        let (budget, sensitivity) = if castle {
            (BudgetSettings { unit: SensitivityUnit::CastleCsf, ..BudgetSettings::PAPER }, Sensitivity::Castle)
        } else {
            (BudgetSettings::PAPER, Sensitivity::Tursun)
        };
        let model = AudioVisual { budget, ..AudioVisual::PAPER };
        let eye = EyeInput { contrast: Some(&contrast), ..eye() };
        let audio = AudioFeatures { loudness_lufs: gamma_ld - 35.0, gamma_ld, gamma_fq_kilomel, silent: false };
        let input = PlanInput { audio: Some(audio), ..input([eye, eye], gazes) };
        let mut planner = Planner::new(without_safety_limits(RateSettings::AudioVisual(model)));
        let plan = planner.plan(&input);
        let budget = f64::from(plan.budget.expect("it is loud"));
        let view = reference(&eye);
        let (mut count, mut ties) = (0, 0);
        for (index, at, angle, rate) in tiles(plan, &input) {
            let permitted = |part: f64| {
                let tile = contrast.tiles.at(at[0], at[1]);
                let resolution = view.pixels_per_degree(at);
                contrast_rate(&tile, resolution, angle, sensitivity, budget * part, &PAPER_RATES)
            };
            // The table of castleCSF is within 2 % of it.
            let (fine, coarse) = (permitted(0.97), permitted(1.03));
            prop_assert!(
                is_between(rate, fine, coarse), "tile {at:?} of eye {index} at {angle} degrees: {rate:?}, not {fine:?}"
            );
            count += 1;
            ties += usize::from(fine != coarse);
        }
        prop_assert!(ties * 10 < count, "{ties} of {count} tiles are ties");
    }
}

/// The reference itself: a gaze at the edge of a view at 45 degrees, and the distance from a corner.
#[test]
fn reference_knows_simple_angles() {
    let quarter = std::f32::consts::FRAC_PI_4;
    let view = View {
        offset: [0, 0],
        extent: [64, 64],
        fov: Fov { left: -quarter, right: quarter, up: quarter, down: -quarter },
        orientation: DQuat::IDENTITY,
        texel: [16, 16],
    };
    let ahead = [DVec3::NEG_Z; 2];
    assert_eq!(view.least_eccentricity_deg([1, 1], ahead), 0.0);
    let expected = 0.5f64.atan().to_degrees();
    assert!((view.least_eccentricity_deg([3, 1], ahead) - expected).abs() < 1e-5, "an edge");
    let expected = (0.5f64 * 2f64.sqrt()).atan().to_degrees();
    assert!((view.least_eccentricity_deg([3, 3], ahead) - expected).abs() < 1e-5, "a corner");
    let behind = [DVec3::Z; 2];
    let expected = 180.0 - 2f64.sqrt().atan().to_degrees();
    assert!((view.least_eccentricity_deg([0, 0], behind) - expected).abs() < 1e-5, "the far corner");
}
