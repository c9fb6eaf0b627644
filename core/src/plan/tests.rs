use super::*;
use crate::audio::AudioFeatures;
use crate::fixed_foveation::FixedFoveation;
use crate::gaze::{GazePhase, GazeState};
use crate::geometry::{Fov, eccentricity};
use crate::image::Plane;
use crate::perception::{ContrastMap, TileContrast};
use crate::presets::Preset;
use crate::rate::{PAPER_RATES, ShadingRate, VULKAN_RATES};
use crate::schedule::{Phase, Schedule, UpdateConfiguration};
use glam::{Quat, Vec3};
use proptest::prelude::*;

/// A frame at 100 Hz.
const FRAME_NS: i64 = 10_000_000;

pub(super) fn gaze(left: Vec3, right: Vec3) -> GazeState {
    GazeState { directions: [left, right], velocity_deg_s: 0.0, phase: GazePhase::Fixation, trust: 1.0 }
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

fn without_rails(settings: PlanSettings) -> PlanSettings {
    PlanSettings { rails: RailSettings::PAPER, ..settings }
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

fn middle_of(eye: &EyePlan, x: u32, y: u32) -> Vec3 {
    let centre = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * 16.0;
    eye.plane().direction(centre)
}

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_filter_map("too short", |(x, y, z)| Vec3::new(x, y, z).try_normalize())
}

fn ahead() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0).prop_map(|(x, y)| Vec3::new(x, y, -1.0).normalize())
}

fn any_quat() -> impl Strategy<Value = Quat> {
    (direction(), -3.1f32..3.1).prop_map(|(axis, angle)| Quat::from_axis_angle(axis, angle))
}

fn any_map() -> impl Strategy<Value = FixedFoveation> {
    let peripheral = prop_oneof![Just(ShadingRate::R4X4), Just(ShadingRate::R2X2), Just(ShadingRate::R2X4)];
    (0.0f32..40.0, 0.0f32..60.0, peripheral).prop_map(|(foveal_deg, transitional_deg, peripheral)| {
        FixedFoveation { foveal_deg, transitional_deg, peripheral }
    })
}

#[test]
fn off_is_full_rate() {
    let mut planner = Planner::new(PlanSettings::default());
    for eye in &settled(&mut planner, input()).eyes {
        assert!(is_full(eye));
        assert_eq!((eye.statistics.mean_rate, eye.statistics.pixel_share), (1.0, 1.0));
        assert_eq!(eye.focus, None);
    }
}

#[test]
fn first_frame_is_full_and_coarsens_within_the_limit() {
    let mut planner = Planner::new(fixed());
    assert!(is_full(&planner.plan(&input()).eyes[0]), "first frame");
    let share: Vec<f32> = (1..=60)
        .map(|frame| {
            let plan = planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, ..input() });
            // 4 octaves a second: 4x4 after half a second, the corner is far outside of all rings.
            let octaves = plan.eyes[0].rate(0, 0).octaves();
            assert!(octaves <= 4.0 * 0.01 * frame as f32 + 1e-4, "frame {frame}: {octaves} octaves");
            plan.eyes[0].statistics.pixel_share
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
    assert!((f64::from(eye.statistics.mean_rate) - rate / pixels).abs() < 1e-6);
    assert!((f64::from(eye.statistics.pixel_share) - share / pixels).abs() < 1e-6);
    assert_eq!(eye.statistics.tiles_due as usize, due);
    assert!(eye.statistics.pixel_share < eye.statistics.mean_rate, "something is re-used");
}

#[test]
fn schedule_leaves_out_its_share_in_every_frame() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11233, Phase::Staggered));
    settled(&mut planner, input());
    for frame in 101..107 {
        let plan = planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, ..input() });
        let Statistics { tiles, tiles_due, .. } = plan.eyes[0].statistics;
        // About 7 % of the tiles within 10 degrees, 0.23 to 19, the rest beyond; and half a patch more at its edges.
        let share = tiles_due as f32 / tiles as f32;
        assert!((0.40..0.60).contains(&share), "{share} in frame {frame}");
    }
}

#[test]
fn nothing_coarsens_in_blinks_and_after_saccades() {
    for phase in [GazePhase::Blink, GazePhase::Saccade, GazePhase::PostSaccade] {
        let mut planner = Planner::new(fixed());
        settled(&mut planner, input());
        let looking_right = gaze(Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.6, 0.0, -0.8));
        let mut before = planner.plan(&PlanInput { frame: 101, time_ns: 101 * FRAME_NS, ..input() }).clone();
        for frame in 102..110 {
            let gaze = GazeState { phase, ..looking_right };
            let plan = planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, gaze, ..input() });
            for (x, y) in (0..40).flat_map(|x| (0..35).map(move |y| (x, y))) {
                let (was, is) = (before.eyes[0].rate(x, y), plan.eyes[0].rate(x, y));
                assert!(is.octaves() <= was.octaves(), "{phase:?}: tile {x}, {y} from {was:?} to {is:?}");
            }
            before = plan.clone();
        }
        let at_gaze = before.eyes[0].gaze_pixel().expect("the gaze is in view");
        let [x, y] = before.eyes[0].tile_of([at_gaze.x as u32, at_gaze.y as u32]);
        assert_eq!(before.eyes[0].rate(x, y), ShadingRate::R1X1, "refined where the gaze went");
    }
}

#[test]
fn lost_gaze_ramps_to_full_rate_and_then_to_wide_fixed_rates() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11233, Phase::Staggered));
    let to_the_side = gaze(Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.6, 0.0, -0.8));
    settled(&mut planner, PlanInput { gaze: to_the_side, ..input() });
    let mut lost = |frame: u64, trust: f32| {
        let gaze = GazeState { phase: GazePhase::Lost, trust, ..to_the_side };
        planner.plan(&PlanInput { frame, time_ns: frame as i64 * FRAME_NS, gaze, ..input() }).clone()
    };
    let shares = [0.95, 0.9, 0.8, 0.5].map(|trust| lost(101, trust).eyes[0].statistics.mean_rate);
    assert!(shares.is_sorted() && shares[0] < shares[3] && shares[3] == 1.0, "{shares:?}");
    let plan = lost(102, 0.0);
    assert!(plan.reasons.contains(Reason::GazeLost));
    let plan = (103..200).map(|frame| lost(frame, 0.0)).last().expect("a hundred frames");
    for eye in &plan.eyes {
        assert!(eye.ages.texels().iter().all(|age| *age == 0), "nothing is re-used");
        assert_eq!(eye.gaze, Vec3::ZERO);
        let lost = RailSettings::default().lost.expect("wide rates");
        for (x, y) in (0..40).flat_map(|x| (0..35).map(move |y| (x, y))) {
            let angle = eccentricity(eye.centres[0], middle_of(eye, x, y)).to_degrees();
            let rate = eye.rate(x, y);
            assert!(rate == ShadingRate::R1X1 || angle > lost.foveal_deg, "{rate:?} at {angle}");
            assert!(rate.octaves() <= lost.peripheral.octaves(), "{rate:?} at {angle}");
        }
        assert_eq!(eye.rate(0, 0), ShadingRate::R2X2, "the corner, 50 degrees out");
    }
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
            Planner::new(without_rails(with_schedule(UpdateConfiguration::F12345, Phase::Staggered)));
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
            Planner::new(without_rails(with_schedule(UpdateConfiguration::F12345, Phase::Staggered)));
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
    let mean = |plan: &FramePlan| plan.eyes[0].statistics.mean_rate;
    let judged = RateSettings::AudioVisual(model);
    let cap = share(RateSettings::Fixed(model.cap.expect("a cap")), None, None);
    let of_plain = share(judged, Some(&plain), Some(loud()));
    let of_busy = share(judged, Some(&busy), Some(loud()));
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
        let plan = share(judged, map, audio);
        assert_eq!(plan.eyes[0].rates, fixed.eyes[0].rates, "{case}");
        assert!(plan.reasons.contains(reason), "{case}");
    }
}

#[test]
fn small_motion_does_not_change_rates() {
    // There and back by 0.3 degrees, less than the hysteresis, each for long enough to grow by 2 octaves.
    let turned = Vec3::new(0.3f32.to_radians().sin(), 0.0, -1.0).normalize();
    for (hysteresis_deg, changes) in [(0.5, false), (0.0, true)] {
        let rails = RailSettings { hysteresis_deg, ..RailSettings::default() };
        let mut planner = Planner::new(PlanSettings { rails, ..fixed() });
        let mut plan_of = |frame: u64| {
            let direction = if (frame / 50).is_multiple_of(2) { Vec3::NEG_Z } else { turned };
            let gaze = gaze(direction, direction);
            let input = PlanInput { frame, time_ns: frame as i64 * FRAME_NS, gaze, ..input() };
            planner.plan(&input).eyes[0].rates.clone()
        };
        // Tiles grow to what both directions permit.
        let settled = (0..300).map(&mut plan_of).last();
        let changed = (300..400).any(|frame| Some(plan_of(frame)) != settled);
        assert_eq!(changed, changes, "{hysteresis_deg} degrees");
    }
}

#[test]
fn clock_that_stands_or_goes_back_coarsens_nothing() {
    let mut planner = Planner::new(fixed());
    planner.plan(&input());
    for (frame, time_ns) in [(1, 0), (2, -5_000_000), (3, i64::MIN)] {
        let plan = planner.plan(&PlanInput { frame, time_ns, ..input() });
        assert!(is_full(&plan.eyes[0]) && plan.reasons.contains(Reason::ClockStopped), "{time_ns}");
    }
    // 292 years later, a tenth of a second counts.
    let plan = planner.plan(&PlanInput { frame: 4, time_ns: i64::MAX, ..input() });
    assert_eq!(plan.eyes[0].rate(0, 0).octaves(), 0.0, "2x2 is an octave away, .4 are allowed");
}

#[test]
fn updates_are_faster_in_pursuit_and_at_low_frame_rates() {
    let periods = |frame_rate_hz: f32, velocity_deg_s: f32, uncapped: bool| {
        let schedule = Schedule { configuration: UpdateConfiguration::F12345, ..Schedule::default() };
        let updates = UpdateSettings { uncapped, ..UpdateSettings::from(schedule) };
        let mut planner = Planner::new(PlanSettings { schedule: Some(updates), ..fixed() });
        let gaze = GazeState { velocity_deg_s, ..input().gaze };
        let plan = planner.plan(&PlanInput { frame_rate_hz, gaze, ..input() });
        let pursuit = plan.reasons.contains(Reason::Pursuit);
        assert_eq!(pursuit, velocity_deg_s > 5.0);
        assert_eq!(plan.reasons.contains(Reason::LeastFrequency), !uncapped);
        plan.periods
    };
    assert_eq!(periods(90.0, 1.0, false), [1, 2, 3, 3, 3], "30 Hz");
    assert_eq!(periods(72.0, 1.0, false), [1, 2, 2, 2, 2], "36 Hz");
    assert_eq!(periods(59.0, 1.0, false), [1; 5], "nothing is left out");
    assert_eq!(periods(90.0, 1.0, true), [1, 2, 3, 4, 5]);
    assert_eq!(periods(90.0, 20.0, true), [1, 1, 2, 3, 4], "pursuit");
}

#[test]
fn colour_follows_the_gaze_and_comes_back_when_that_is_lost() {
    let settings = PlanSettings::of(Preset::Streaming, false, &VULKAN_RATES, [16, 16]);
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
fn presets_shade_less_from_quality_to_performance() {
    let settings = |preset, by_sound| PlanSettings::of(preset, by_sound, &VULKAN_RATES, [16, 16]);
    let shares = [Preset::Quality, Preset::Balanced, Preset::Performance].map(|preset| {
        let mut planner = Planner::new(settings(preset, false));
        settled(&mut planner, input()).eyes[0].statistics.pixel_share
    });
    assert!(shares.is_sorted_by(|a, b| a > b), "{shares:?}");
    let paper = settings(Preset::Paper, true);
    assert_eq!(paper.rails, RailSettings::PAPER);
    assert_eq!(paper.device.available, AvailableRates::new(&PAPER_RATES));
    assert!(matches!(paper.rates, RateSettings::AudioVisual(AudioVisual { cap: None, .. })));
}

#[test]
fn rails_that_are_no_numbers_are_the_usual_ones() {
    let wild = RailSettings {
        least_foveal_deg: f32::NAN,
        tracker_error_deg: f32::NAN,
        latency_s: f32::NAN,
        hysteresis_deg: f32::NAN,
        hysteresis_budget: f32::NAN,
        coarsening_octaves_per_s: f32::NAN,
        ..RailSettings::default()
    };
    let planner = Planner::new(PlanSettings { rails: wild, ..fixed() });
    assert_eq!(planner.settings().rails, RailSettings::default());
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn rate_does_not_rise_with_eccentricity(map in any_map(), left in ahead(), right in ahead()) {
        let rates = RateSettings::Fixed(map);
        let mut planner = Planner::new(without_rails(PlanSettings { rates, ..PlanSettings::default() }));
        let plan = planner.plan(&PlanInput { gaze: gaze(left, right), ..input() });
        for eye in &plan.eyes {
            let mut tiles: Vec<(f32, f32)> = (0..40)
                .flat_map(|x| (0..35).map(move |y| (x, y)))
                .map(|(x, y)| (eye.centres.map(|at| eccentricity(at, middle_of(eye, x, y))), eye.rate(x, y)))
                .map(|(angles, rate)| (angles[0].min(angles[1]).to_degrees(), rate.octaves()))
                .collect();
            tiles.sort_by(|a, b| a.0.total_cmp(&b.0));
            // The nearest point of a tile is within 2.2 degrees of its middle.
            for (index, (far, octaves)) in tiles.iter().enumerate() {
                let nearer = tiles[..index].iter().filter(|(near, _)| near + 4.4 < *far);
                prop_assert!(nearer.clone().all(|(_, before)| before <= octaves), "{octaves} at {far}");
            }
        }
    }

    /// The rate of a direction is that of the rings, the same in both eyes; a tile has the finest of its directions.
    #[test]
    fn both_eyes_give_one_direction_the_same_rate(map in any_map(), left in ahead(), right in ahead(), seen in ahead()) {
        let settings = PlanSettings { rates: RateSettings::Fixed(map), ..PlanSettings::default() };
        let mut planner = Planner::new(without_rails(settings));
        let input = PlanInput { gaze: gaze(left, right), ..input() };
        let plan = planner.plan(&input);
        prop_assert_eq!(plan.eyes[0].rings, plan.eyes[1].rings);
        let rates = [0, 1].map(|index: usize| {
            let eye = &plan.eyes[index];
            let to_view = input.eyes[index].orientation.inverse();
            let angles = eye.centres.map(|centre| eccentricity(centre, to_view * seen).to_degrees());
            (angles[0].min(angles[1]), to_view * seen)
        });
        prop_assert!((rates[0].0 - rates[1].0).abs() < 1e-3, "{rates:?}");
        for (eye, (angle, direction)) in plan.eyes.iter().zip(rates) {
            let at = (direction.truncate() / -direction.z - eye.plane().origin) / eye.plane().step;
            if direction.z < 0.0 && at.cmpge(glam::Vec2::ZERO).all() && at.x < 640.0 && at.y < 560.0 {
                let [x, y] = eye.tile_of([at.x as u32, at.y as u32]);
                let finest = eye.rings.rate_at(&plan.available, angle + 1e-3).octaves();
                prop_assert!(eye.rate(x, y).octaves() <= finest, "{:?} at {angle}", eye.rate(x, y));
            }
        }
    }

    #[test]
    fn joint_rotation_changes_nothing(map in any_map(), left in ahead(), right in ahead(), turn in any_quat()) {
        let settings = without_rails(PlanSettings { rates: RateSettings::Fixed(map), ..PlanSettings::default() });
        let before = PlanInput { gaze: gaze(left, right), ..input() };
        let mut after = PlanInput { gaze: gaze(turn * left, turn * right), ..before };
        after.eyes.iter_mut().for_each(|eye| eye.orientation = turn * eye.orientation);
        let mut planners = [Planner::new(settings), Planner::new(settings)];
        let [first, second] = &mut planners;
        let (first, second) = (first.plan(&before), second.plan(&after));
        for (a, b) in first.eyes.iter().zip(&second.eyes) {
            let differ = a.rates.texels().iter().zip(b.rates.texels()).filter(|(a, b)| a != b).count();
            prop_assert!(differ <= 3, "{differ} tiles");
        }
    }

    /// With any settings, whatever contrast and sound say.
    #[test]
    fn fovea_has_full_rate(
        map in any_map(), left in ahead(), velocity_deg_s in 0.0f32..800.0, judged in any::<bool>(), cap in any::<bool>(),
    ) {
        let model = AudioVisual { cap: cap.then_some(map), fixed: map, ..AudioVisual::default() };
        let rates = if judged { RateSettings::AudioVisual(model) } else { RateSettings::Fixed(map) };
        let tile = TileContrast { bands: [0.0; 4], adaptation_cd_m2: 1.0 };
        let plain = ContrastMap { tiles: Plane::filled(40, 35, tile) };
        let gaze = GazeState { velocity_deg_s, ..gaze(left, left) };
        let mut input = PlanInput { gaze, audio: Some(loud()), ..input() };
        input.eyes.iter_mut().for_each(|eye| eye.contrast = Some(&plain));
        let mut planner = Planner::new(PlanSettings { rates, ..PlanSettings::default() });
        let plan = settled(&mut planner, input);
        prop_assert!(plan.inflation_deg >= 1.1 - 1e-5);
        for eye in &plan.eyes {
            for (x, y) in (0..40).flat_map(|x| (0..35).map(move |y| (x, y))) {
                let angle = eccentricity(eye.centres[0], middle_of(eye, x, y)).to_degrees();
                let inside = angle <= 5.0 + plan.inflation_deg - 1e-3;
                prop_assert!(!inside || eye.rate(x, y) == ShadingRate::R1X1, "{:?} at {angle}", eye.rate(x, y));
            }
        }
    }

    /// Every direction that stays in view is rendered within its period, however the head turns, and as it comes
    /// into view.
    #[test]
    fn directions_are_rendered_within_their_period(
        factors in prop_oneof![Just("11223"), Just("12345"), Just("11112")],
        phase in prop_oneof![Just(Phase::Aligned), Just(Phase::Staggered), Just(Phase::AlternateEye)],
        axis in direction(), speed in 0.0f32..0.06, seen in proptest::collection::vec(direction(), 40),
    ) {
        let configuration: UpdateConfiguration = factors.parse().expect("a configuration");
        let schedule = Schedule { configuration, phase, ..Schedule::default() };
        let updates = UpdateSettings { schedule, faster_in_pursuit: false, uncapped: true };
        let mut planner = Planner::new(PlanSettings { schedule: Some(updates), ..fixed() });
        // Frames since a direction was rendered; nothing while it is out of view.
        let mut ages = vec![[None::<u8>; 2]; seen.len()];
        for frame in 0..60u64 {
            let head = Quat::from_axis_angle(axis, speed * frame as f32);
            let input = PlanInput { frame, time_ns: frame as i64 * FRAME_NS, head, ..input() };
            let plan = planner.plan(&input);
            for (direction, ages) in seen.iter().zip(&mut ages) {
                for (index, age) in ages.iter_mut().enumerate() {
                    let eye = &plan.eyes[index];
                    let in_view = (head * input.eyes[index].orientation).inverse() * *direction;
                    let at = (in_view.truncate() / -in_view.z - eye.plane().origin) / eye.plane().step;
                    let outside = (-at).max_element().max(at.x - 640.0).max(at.y - 560.0);
                    if in_view.z >= 0.0 || outside > -0.01 {
                        // Less than a pixel beyond the border, what is there stands for it.
                        *age = (in_view.z < 0.0 && outside < 1.0).then_some(0);
                        continue;
                    }
                    let [x, y] = eye.tile_of([at.x as u32, at.y as u32]);
                    let next = age.map_or(u8::MAX, |age| age.saturating_add(1));
                    *age = Some(if eye.is_due(x, y) { 0 } else { next });
                    let angles = eye.centres.map(|centre| eccentricity(centre, in_view).to_degrees());
                    let reach = angles[0].min(angles[1]);
                    let region = plan.regions_deg.iter().filter(|radius| reach > **radius).count();
                    prop_assert!(
                        age.is_some_and(|age| age < plan.periods[region]),
                        "{age:?} at {reach} degrees in frame {frame}, periods {:?}", plan.periods
                    );
                }
            }
        }
    }
}
