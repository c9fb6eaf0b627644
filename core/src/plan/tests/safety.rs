//! The safety limits.

use super::*;

#[test]
fn nothing_coarsens_in_blinks_and_where_a_saccade_is_in_doubt() {
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
fn in_a_blink_tiles_become_coarser_by_contrast_alone() {
    use crate::plan::reasons::Reasons;
    use crate::plan::safety::SafetyState;
    for (by_contrast, phase, may_coarsen) in [
        (true, GazePhase::Blink, true),
        (false, GazePhase::Blink, false),
        (true, GazePhase::Saccade, false),
        (true, GazePhase::PostSaccade, false),
        (true, GazePhase::Lost, false),
    ] {
        let gaze = GazeState { phase, ..gaze(Vec3::NEG_Z, Vec3::NEG_Z) };
        let mut state = SafetyState::default();
        let mut coarsening = |time_ns| {
            let settings = SafetySettings::default();
            let by_contrast = by_contrast.then_some(0.0);
            state.frame(&settings, by_contrast, time_ns, &gaze, &mut Reasons::default()).coarsening
        };
        assert_eq!(coarsening(0), 0, "{phase:?}: no time has passed");
        let later = coarsening(50_000_000);
        assert_eq!(later > 0, may_coarsen, "{phase:?}, {by_contrast}: {later} steps in 50 ms");
    }
}

#[test]
fn tiles_become_coarser_as_the_head_turns_other_content_into_them() {
    // 16 pixels of 640 at the centre of this view.
    let Fov { left, right, .. } = input().eyes[0].fov;
    let tile = (right.tan() - left.tan()) * 16.0 / 640.0;
    let coarsening = |rates, turned_tiles: f32| {
        let mut planner = Planner::new(PlanSettings { rates, ..PlanSettings::default() });
        planner.plan(&input());
        let head = Quat::from_rotation_y(turned_tiles * tile);
        planner.plan(&PlanInput { frame: 1, time_ns: FRAME_NS, head, ..input() }).eyes[0].decision.coarsening
    };
    let by_contrast = RateSettings::AudioVisual(AudioVisual::default());
    // 4 octaves a second, of 64 steps each, over 10 ms; and 128 steps for a tile.
    for (turned_tiles, expected) in [(0.0, 2), (0.25, 34), (0.5, 66), (1.0, 130), (20.0, 130)] {
        assert_eq!(coarsening(by_contrast, turned_tiles), expected, "{turned_tiles} tiles");
    }
    let rings = RateSettings::Fixed(FixedFoveation::L1_C1);
    assert_eq!(coarsening(rings, 0.0), coarsening(rings, 20.0));
}

#[test]
fn tiles_are_coarse_at_once_in_a_saccade_outside_of_the_possible_landing() {
    let ahead = input().gaze.directions[0];
    let right = Vec3::new(0.6, 0.0, -0.8);
    for (suppressed_octaves_per_s, error_deg, is_coarse) in [
        (f32::INFINITY, 1.0, true),
        (f32::INFINITY, 30.0, false),
        (f32::INFINITY, f32::NAN, false),
        (0.0, 1.0, false),
    ] {
        let safety = SafetySettings { suppressed_octaves_per_s, ..SafetySettings::default() };
        let mut planner = Planner::new(PlanSettings { safety, ..fixed() });
        settled(&mut planner, input());
        let before = planner.newest().eyes[0].gaze_pixel().expect("the gaze is in view");
        let phase = GazePhase::Saccade;
        let gaze = GazeState {
            phase,
            is_suppressed: true,
            velocity_deg_s: 300.0,
            prediction_error_deg: Some(error_deg),
            ..gaze(right, right)
        };
        let plan = planner.plan(&PlanInput { frame: 101, time_ns: 101 * FRAME_NS, gaze, ..input() });
        assert!(plan.reasons.contains(Reason::Suppressed) && !plan.reasons.contains(Reason::Saccade));
        let [x, y] = plan.eyes[0].tile_of([before.x as u32, before.y as u32]);
        let left_behind = plan.eyes[0].rate(x, y) != ShadingRate::R1X1;
        assert_eq!(
            left_behind, is_coarse,
            "{suppressed_octaves_per_s} octaves, {error_deg} degrees, from {ahead}"
        );
        let landing = plan.eyes[0].gaze_pixel().expect("the landing is in view");
        let [x, y] = plan.eyes[0].tile_of([landing.x as u32, landing.y as u32]);
        assert_eq!(plan.eyes[0].rate(x, y), ShadingRate::R1X1);
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
    let shares = [0.95, 0.9, 0.8, 0.5].map(|trust| lost(101, trust).eyes[0].statistics().mean_rate);
    assert!(shares.is_sorted() && shares[0] < shares[3] && shares[3] == 1.0, "{shares:?}");
    let plan = lost(102, 0.0);
    assert!(plan.reasons.contains(Reason::GazeLost));
    let plan = (103..200).map(|frame| lost(frame, 0.0)).last().expect("a hundred frames");
    for eye in &plan.eyes {
        assert!(eye.ages.texels().iter().all(|age| *age == 0), "nothing is re-used");
        assert_eq!(eye.gaze, Vec3::ZERO);
        let lost = SafetySettings::default().lost.expect("wide rates");
        for (x, y) in (0..40).flat_map(|x| (0..35).map(move |y| (x, y))) {
            let angle = eccentricity(eye.centres[0], middle_of(eye, x, y)).to_degrees();
            let rate = eye.rate(x, y);
            assert!(rate == ShadingRate::R1X1 || angle > lost.foveal_deg, "{rate:?} at {angle}");
            assert!(rate.octaves() <= lost.peripheral.octaves(), "{rate:?} at {angle}");
        }
        assert_eq!(eye.rate(0, 0), ShadingRate::R2X2, "the corner, 50 degrees out");
    }
}

/// With an assumed vergence, both eyes may look along the ray between the two directions, where two circles are narrow.
#[test]
fn the_fovea_reaches_as_far_from_the_ray_as_from_the_eyes_directions() {
    let rates = RateSettings::Fixed(FixedFoveation::ANYWHERE);
    let safety = SafetySettings { hysteresis_deg: 0.0, ..SafetySettings::default() };
    let fovea_deg = safety.least_foveal_deg + safety.tracker_error_deg;
    let eyes_m = [-0.0315, 0.0315].map(|x| Vec3::new(x, 0.0, 0.0));
    let ahead = gaze(Vec3::NEG_Z, Vec3::NEG_Z);
    let share = |gaze: GazeState| {
        let mut planner = Planner::new(PlanSettings { rates, safety, ..PlanSettings::default() });
        let plan = settled(&mut planner, PlanInput { gaze, ..input() });
        for (eye, view) in plan.eyes.iter().zip(input().eyes) {
            let ray = view.orientation.inverse() * Vec3::NEG_Z;
            for (x, y) in (0..40).flat_map(|x| (0..35).map(move |y| (x, y))) {
                let angle = eccentricity(ray, middle_of(eye, x, y)).to_degrees();
                assert!(angle > fovea_deg || eye.rate(x, y) == ShadingRate::R1X1, "{angle} degrees");
            }
        }
        plan.eyes[0].statistics().mean_rate
    };
    let (assumed, known) = (ahead.with_nearest(eyes_m, 0.4), ahead);
    assert!(assumed.ray.is_some());
    assert!(share(assumed) > share(known));
    // Of a vergence that is known, the circles are as they were.
    let mut state = crate::plan::safety::SafetyState::default();
    let mut widening = |gaze| {
        let reasons = &mut Reasons::default();
        state.frame(&safety, None, 0, &gaze, reasons).vergence_deg
    };
    let measured = GazeState { ray: None, ..assumed };
    assert_eq!([known, measured].map(&mut widening), [0.0; 2]);
    let widened = widening(assumed);
    assert!((widened - 1.48).abs() < 0.01, "{widened}");
}

#[test]
fn small_motion_does_not_change_rates() {
    // There and back by 0.3 degrees, less than the hysteresis, each for long enough to grow by 2 octaves.
    let turned = Vec3::new(0.3f32.to_radians().sin(), 0.0, -1.0).normalize();
    for (hysteresis_deg, changes) in [(0.5, false), (0.0, true)] {
        let safety = SafetySettings { hysteresis_deg, ..SafetySettings::default() };
        let mut planner = Planner::new(PlanSettings { safety, ..fixed() });
        let mut plan_of = |frame: u64| {
            let direction = if (frame / 50).is_multiple_of(2) { Vec3::NEG_Z } else { turned };
            let gaze = gaze(direction, direction);
            let input = PlanInput { frame, time_ns: frame as i64 * FRAME_NS, gaze, ..input() };
            planner.plan(&input).eyes[0].rates.clone()
        };
        // Tiles become as coarse as both directions permit.
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
        let phase = if velocity_deg_s > 5.0 { GazePhase::Pursuit } else { GazePhase::Fixation };
        let gaze = GazeState { velocity_deg_s, phase, ..input().gaze };
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
fn rails_that_are_no_numbers_are_the_usual_ones() {
    let wild = SafetySettings {
        least_foveal_deg: f32::NAN,
        tracker_error_deg: f32::NAN,
        latency_s: f32::NAN,
        hysteresis_deg: f32::NAN,
        hysteresis_budget: f32::NAN,
        coarsening_octaves_per_s: f32::NAN,
        contrast_octaves_per_s: f32::NAN,
        ..SafetySettings::default()
    };
    let planner = Planner::new(PlanSettings { safety: wild, ..fixed() });
    assert_eq!(planner.settings().safety, SafetySettings::default());
}

#[test]
fn the_schedule_is_one_step_faster_in_pursuit_if_the_settings_ask_for_it() {
    for (faster_in_pursuit, pursuit) in [(true, [1, 1, 1, 1, 2]), (false, [1, 1, 2, 2, 3])] {
        let periods = |phase: GazePhase| {
            let schedule = Schedule { configuration: UpdateConfiguration::F11223, ..Schedule::default() };
            let updates = UpdateSettings { faster_in_pursuit, ..UpdateSettings::from(schedule) };
            let mut planner = Planner::new(PlanSettings { schedule: Some(updates), ..fixed() });
            let gaze = GazeState { phase, ..input().gaze };
            planner.plan(&PlanInput { frame_rate_hz: 90.0, gaze, ..input() }).periods
        };
        assert_eq!(periods(GazePhase::Fixation), [1, 1, 2, 2, 3]);
        assert_eq!(periods(GazePhase::Pursuit), pursuit);
    }
}
