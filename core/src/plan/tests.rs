use super::*;
use crate::audio::AudioFeatures;
use crate::chroma::ChromaSettings;
use crate::fixed_foveation::FixedFoveation;
use crate::gaze::{GazePhase, GazeState};
use crate::geometry::{Fov, eccentricity};
use crate::image::Plane;
use crate::perception::{ContrastMap, TileContrast};
use crate::rate::{ShadingRate, VULKAN_RATES};
use crate::schedule::{Phase, Schedule, UpdateConfiguration};
use glam::{Quat, Vec3};

mod feedback;
mod lenses;
mod properties;
mod safety;
mod update_unit;

/// A frame at 100 Hz.
const FRAME_NS: i64 = 10_000_000;

pub(super) fn gaze(left: Vec3, right: Vec3) -> GazeState {
    GazeState { directions: [left, right], phase: GazePhase::Fixation, trust: 1.0, ..GazeState::LOST }
}

/// Two canted eyes of 640 x 560 pixels that look ahead.
pub(super) fn input<'a>() -> PlanInput<'a> {
    let eye = |sign: f32| EyeInput {
        offset: [0, 0],
        extent: [640, 560],
        fov: Fov { left: -0.8 - 0.1 * sign, right: 0.8 - 0.1 * sign, up: 0.75, down: -0.8 },
        orientation: Quat::from_rotation_y(0.1 * sign),
        contrast: None,
        refresh: false,
    };
    PlanInput {
        time_ns: 0,
        frame: 0,
        frame_rate_hz: 100.0,
        eyes: [eye(1.0), eye(-1.0)],
        head: Quat::IDENTITY,
        gaze: gaze(Vec3::NEG_Z, Vec3::NEG_Z),
        audio: None,
    }
}

fn fixed() -> PlanSettings {
    PlanSettings { rates: RateSettings::Fixed(FixedFoveation::L1_C1), ..PlanSettings::default() }
}

fn without_safety_limits(settings: PlanSettings) -> PlanSettings {
    PlanSettings { safety: SafetySettings::PAPER, ..settings }
}

fn with_schedule(configuration: UpdateConfiguration, phase: Phase) -> PlanSettings {
    let schedule = Schedule { configuration, phase, ..Schedule::default() };
    PlanSettings { schedule: Some(schedule.into()), ..fixed() }
}

fn loud() -> AudioFeatures {
    AudioFeatures { loudness_lufs: -10.0, gamma_ld: 25.0, gamma_fq_kilomel: 1.0, silent: false }
}

/// Frames from `first` on with the same input, until nothing moves any more.
fn settled<'a>(planner: &'a mut Planner, first: PlanInput) -> &'a FramePlan {
    for frame in 0..100 {
        planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, ..first });
    }
    planner.plan(&PlanInput { frame: 100, time_ns: 100 * FRAME_NS, ..first })
}

fn is_full(eye: &EyePlan) -> bool {
    eye.rates.texels().iter().all(|texel| *texel == 0) && eye.ages.texels().iter().all(|age| *age == 0)
}

#[test]
fn a_gaze_that_stays_is_measured_anew_in_another_view() {
    let mut planner = Planner::new(without_safety_limits(fixed()));
    let wide = input();
    planner.plan(&wide);
    let mut narrow = input();
    for eye in &mut narrow.eyes {
        // As many tiles, which look elsewhere.
        eye.fov = Fov { left: -0.3, right: 1.2, ..eye.fov };
    }
    let same_gaze = planner.plan(&PlanInput { frame: 1, time_ns: FRAME_NS, ..narrow }).clone();
    let fresh = Planner::new(without_safety_limits(fixed())).plan(&narrow).clone();
    assert_eq!(same_gaze.eyes[0].rates, fresh.eyes[0].rates);
    assert_ne!(
        same_gaze.eyes[0].rates,
        Planner::new(without_safety_limits(fixed())).plan(&wide).eyes[0].rates
    );
}

fn middle_of(eye: &EyePlan, x: u32, y: u32) -> Vec3 {
    let centre = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * 16.0;
    eye.plane().direction(centre)
}

#[test]
fn off_is_full_rate() {
    let mut planner = Planner::new(PlanSettings::default());
    for eye in &settled(&mut planner, input()).eyes {
        assert!(is_full(eye));
        assert_eq!((eye.statistics().mean_rate, eye.statistics().pixel_share), (1.0, 1.0));
        assert_eq!(eye.focus, None);
    }
}

/// Rates by contrast change faster while the head turns.
#[test]
fn a_head_at_rest_turns_by_no_tile() {
    let mut planner = Planner::new(PlanSettings::default());
    let golden = |number: u32, factor: f32| (number as f32 * factor).fract() * std::f32::consts::TAU;
    for number in 0..1000 {
        let head = Quat::from_euler(
            glam::EulerRot::YXZ,
            golden(number, 0.618_034),
            golden(number, 0.754_878),
            golden(number, 0.569_84),
        );
        planner.turned_tiles(&input(), head);
        let at_rest = planner.turned_tiles(&input(), head);
        assert!(at_rest < 1e-4, "{head}: {at_rest} tiles");
        // A tile is about three degrees wide.
        let turned = planner.turned_tiles(&input(), head * Quat::from_rotation_y(0.01));
        assert!((0.15..0.25).contains(&turned), "{turned} tiles");
    }
}

#[test]
fn first_frame_is_full_and_coarsens_within_the_limit() {
    let mut planner = Planner::new(fixed());
    assert!(is_full(&planner.plan(&input()).eyes[0]), "first frame");
    let share: Vec<f32> = (1..=60)
        .map(|frame| {
            let plan = planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, ..input() });
            // 8 octaves a second: 4x4 after half a second, the corner is far outside of all rings.
            let octaves = plan.eyes[0].rate(0, 0).octaves();
            assert!(octaves <= 8.0 * 0.01 * frame as f32 + 1e-4, "frame {frame}: {octaves} octaves");
            plan.eyes[0].statistics().pixel_share
        })
        .collect();
    assert!(share.is_sorted_by(|a, b| a >= b), "{share:?}");
    assert_eq!(
        planner.plan(&PlanInput { frame: 61, time_ns: 61 * FRAME_NS, ..input() }).eyes[0].rate(0, 0),
        ShadingRate::R4X4
    );
    // FR_L1-C1's mean rate is .161 with tiles on a headset of wider view.
    assert!((0.15..0.45).contains(&share[59]), "{}", share[59]);
}

#[test]
fn statistics_are_sums_over_pixels() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11233, Phase::Staggered));
    let mut odd = input();
    for eye in &mut odd.eyes {
        (eye.offset, eye.extent) = ([5, 24], [601, 333]);
    }
    let eye = &settled(&mut planner, odd).eyes[1];
    let (mut rate, mut share, mut due) = (0.0, 0.0, 0);
    for y in 0..333 {
        for x in 0..601 {
            let [column, row] = eye.tile_of([x, y]);
            let fraction = f64::from(eye.rate(column, row).fraction());
            rate += fraction;
            share += if eye.is_due(column, row) { fraction } else { 0.0 };
        }
    }
    due += eye.ages.texels().iter().filter(|age| **age == 0).count();
    let pixels = 601.0 * 333.0;
    assert!((f64::from(eye.statistics().mean_rate) - rate / pixels).abs() < 1e-6);
    assert!((f64::from(eye.statistics().pixel_share) - share / pixels).abs() < 1e-6);
    assert_eq!(eye.statistics().tiles_due as usize, due);
    assert!(eye.statistics().pixel_share < eye.statistics().mean_rate, "something is re-used");
}

#[test]
fn schedule_leaves_out_its_share_in_every_frame() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11233, Phase::Staggered));
    settled(&mut planner, input());
    for frame in 101..107 {
        let plan = planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, ..input() });
        let Statistics { tiles, tiles_due, .. } = plan.eyes[0].statistics();
        // About 7 % of the tiles within 10 degrees, 0.23 to 19, the rest beyond; and half a patch more at its edges.
        let share = tiles_due as f32 / tiles as f32;
        assert!((0.40..0.60).contains(&share), "{share} in frame {frame}");
    }
}

/// As that of a canted display does when it is computed from poses of a moving head.
#[test]
fn a_view_whose_orientation_trembles_keeps_its_tiles() {
    let mut planners = [fixed(), fixed()].map(Planner::new);
    for frame in 0..60 {
        let input = PlanInput { frame, time_ns: frame as i64 * FRAME_NS, ..input() };
        let mut trembling = input;
        for eye in &mut trembling.eyes {
            eye.orientation.y += if frame % 2 == 0 { 1e-7 } else { 0.0 };
        }
        planners[0].plan(&input);
        planners[1].plan(&trembling);
    }
    let [still, trembling] = planners.map(|mut planner| {
        planner.plan(&PlanInput { frame: 60, time_ns: 60 * FRAME_NS, ..input() }).eyes[0]
            .statistics()
            .mean_rate
    });
    assert!((still - trembling).abs() < 1e-3 && still < 0.5, "{still} and {trembling}");
}

#[test]
fn garbage_is_full_rate() {
    let unknown = [
        ("gaze NaN", PlanInput { gaze: gaze(Vec3::NAN, Vec3::NAN), ..input() }),
        ("gaze zero", PlanInput { gaze: gaze(Vec3::ZERO, Vec3::ZERO), ..input() }),
        ("gaze infinite", PlanInput { gaze: gaze(Vec3::INFINITY, Vec3::INFINITY), ..input() }),
        ("trust NaN", PlanInput { gaze: GazeState { trust: f32::NAN, ..input().gaze }, ..input() }),
    ];
    for (case, unknown) in unknown {
        let mut planner =
            Planner::new(without_safety_limits(with_schedule(UpdateConfiguration::F12345, Phase::Staggered)));
        let plan = settled(&mut planner, unknown);
        assert!(plan.eyes.iter().all(is_full), "{case}");
    }
    for (case, change) in [
        ("fov NaN", (|eye: &mut EyeInput| eye.fov.left = f32::NAN) as fn(&mut EyeInput)),
        ("fov without width", |eye| eye.fov.left = eye.fov.right),
        ("orientation zero", |eye| eye.orientation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        ("orientation NaN", |eye| eye.orientation = Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0)),
    ] {
        let mut malformed = input();
        change(&mut malformed.eyes[0]);
        let mut planner =
            Planner::new(without_safety_limits(with_schedule(UpdateConfiguration::F12345, Phase::Staggered)));
        let plan = settled(&mut planner, malformed);
        assert!(is_full(&plan.eyes[0]), "{case}");
        assert!(!is_full(&plan.eyes[1]), "{case}: the other eye is not concerned");
        assert!(plan.reasons.contains(Reason::ViewMalformed), "{case}");
    }
}

#[test]
fn contrast_and_sound_lead_to_coarser_rates_down_to_the_cap() {
    let flat = TileContrast { bands: [0.0; 4], adaptation_cd_m2: 50.0 };
    let plain = ContrastMap { tiles: Plane::filled(40, 35, flat) };
    let busy = ContrastMap { tiles: Plane::filled(40, 35, TileContrast { bands: [1.0; 4], ..flat }) };
    let model = AudioVisual::default();
    let share = |settings: RateSettings, map: Option<&ContrastMap>, audio: Option<AudioFeatures>| {
        let mut planner = Planner::new(PlanSettings { rates: settings, ..PlanSettings::default() });
        let mut input = PlanInput { audio, ..input() };
        input.eyes.iter_mut().for_each(|eye| eye.contrast = map);
        settled(&mut planner, input).clone()
    };
    let mean = |plan: &FramePlan| plan.eyes[0].statistics().mean_rate;
    let by_contrast = RateSettings::AudioVisual(model);
    let cap = share(RateSettings::Fixed(model.cap.expect("a cap")), None, None);
    let of_plain = share(by_contrast, Some(&plain), Some(loud()));
    let of_busy = share(by_contrast, Some(&busy), Some(loud()));
    assert_eq!(of_plain.eyes[0].rates, cap.eyes[0].rates, "without contrast the cap alone limits");
    assert!(mean(&of_busy) > mean(&of_plain) * 1.5, "{} and {}", mean(&of_busy), mean(&of_plain));
    assert!(of_busy.budget.is_some_and(|budget| budget > 0.0));

    let fixed = share(RateSettings::Fixed(model.fixed), None, None);
    let silent = AudioFeatures { silent: true, ..loud() };
    for (case, map, audio, reason) in [
        ("silence", Some(&plain), Some(silent), Reason::Silence),
        ("no sound known", Some(&plain), None, Reason::NothingMeasured),
        ("no contrast known", None, Some(loud()), Reason::NothingMeasured),
    ] {
        let plan = share(by_contrast, map, audio);
        assert_eq!(plan.eyes[0].rates, fixed.eyes[0].rates, "{case}");
        assert!(plan.reasons.contains(reason), "{case}");
    }
}

#[test]
fn colour_follows_the_gaze_and_comes_back_when_that_is_lost() {
    let settings = PlanSettings { chroma: Some(ChromaSettings::default()), ..fixed() };
    let mut planner = Planner::new(settings);
    let side = Vec3::new(0.3, 0.0, -1.0).normalize();
    let head = Quat::from_rotation_y(0.4);
    let plan = planner.plan(&PlanInput { gaze: gaze(side, side), head, ..input() });
    for eye in &plan.eyes {
        let focus = eye.focus.expect("colour falls off");
        assert!(eccentricity(focus.direction, eye.gaze) < 1e-3, "{focus:?} around {:?}", eye.gaze);
        assert_eq!(focus.strength, 1.0);
    }
    let lost = GazeState { phase: GazePhase::Lost, trust: 0.9, ..gaze(side, side) };
    let plan = planner.plan(&PlanInput { time_ns: FRAME_NS, gaze: lost, head, ..input() });
    assert!(plan.eyes.iter().all(|eye| eye.focus.is_none()));
    let plan = planner.plan(&PlanInput { time_ns: 2 * FRAME_NS, gaze: gaze(side, side), head, ..input() });
    // Half of it in a second.
    assert!(plan.eyes.iter().all(|eye| eye.focus.is_some_and(|focus| focus.strength < 0.02)));
}

#[test]
fn a_plan_without_a_schedule_has_no_regions() {
    let mut planner = Planner::new(PlanSettings { schedule: None, ..fixed() });
    let plan = settled(&mut planner, input());
    assert_eq!((plan.regions_deg, plan.periods), ([f32::INFINITY; 4], [1; 5]));
    assert!(plan.to_string().contains("updates  every frame\n"), "{plan}");
}

#[test]
fn text_and_picture_show_the_plan() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11223, Phase::Staggered));
    let plan = settled(&mut planner, input());
    let text = plan.to_string();
    assert!(text.contains("frame 100\n") && text.contains("640 x 560"), "{text}");
    assert!(
        text.contains(
            "updates  every 1 to 7.4 deg, 1 to 10.2 deg, 2 to 19.2 deg, 2 to 32.2 deg, 3 frames beyond"
        ),
        "{text}"
    );
    assert_eq!(
        text.lines().skip(1).take(23).map(|line| line.matches('*').count()).sum::<usize>(),
        2,
        "{text}"
    );
    for sign in ['@', ':', '.'] {
        assert!(text.lines().skip(1).take(23).any(|line| line.contains(sign)), "{sign} in\n{text}");
    }
    let picture = plan.picture(320);
    assert_eq!((picture.width(), picture.height()), (645, 280));
    let at = plan.eyes[0].gaze_pixel().expect("in view") * 0.5;
    assert_eq!(picture.at(at.x as u32, at.y as u32), [255, 255, 255], "the gaze");
    let corner = picture.at(2, 2);
    assert!(corner == [65, 68, 135] || corner == [29, 30, 60], "4x4, new or re-used: {corner:?}");
}

#[test]
fn colour_is_kept_around_the_ray_where_the_distance_is_not_known() {
    let ray = Vec3::new(0.2, 0.1, -1.0).normalize();
    let eyes = [Vec3::X * -0.03, Vec3::X * 0.03];
    let focuses = |gaze: GazeState| {
        let mut planner = Planner::new(PlanSettings { chroma: Some(ChromaSettings::default()), ..fixed() });
        let plan = planner.plan(&PlanInput { gaze, ..input() });
        [0, 1].map(|eye| plan.eyes[eye].focus.unwrap().direction)
    };
    let to_view = |eye: usize, direction: Vec3| input().eyes[eye].orientation.inverse() * direction;
    let assumed = focuses(gaze(ray, ray).with_vergence(eyes, None));
    let known = gaze(ray, ray).with_vergence(eyes, Some(0.4));
    let followed = focuses(known);
    for eye in 0..2 {
        assert!(assumed[eye].abs_diff_eq(to_view(eye, ray), 1e-5));
        assert!(followed[eye].abs_diff_eq(to_view(eye, known.directions[eye]), 1e-5));
    }
}
