use super::*;

mod properties;
mod sampling;
mod scenarios;

const MS: i64 = 1_000_000;

/// A direction `yaw_deg` to the right of -z.
fn yaw(yaw_deg: f32) -> Vec3 {
    let angle = yaw_deg.to_radians();
    Vec3::new(angle.sin(), 0.0, -angle.cos())
}

fn sample(yaw_deg: f32, time_ns: i64) -> GazeSample {
    GazeSample { directions: [yaw(yaw_deg); 2], time_ns, uncertainty_ns: 0, valid: true }
}

fn missing(time_ns: i64) -> GazeSample {
    GazeSample { valid: false, ..sample(0.0, time_ns) }
}

/// A tracker that has followed `yaws` for one sample each `step_ms`, and the time of the last.
fn followed(yaws: impl IntoIterator<Item = f32>, step_ms: i64) -> (GazeTracker, i64) {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let mut time = 0;
    for (i, yaw_deg) in yaws.into_iter().enumerate() {
        time = i as i64 * step_ms * MS;
        tracker.push(&sample(yaw_deg, time));
    }
    (tracker, time)
}

#[test]
fn a_source_that_never_delivers_is_lost_at_once() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    assert_eq!(tracker.state(0), GazeState::LOST);
    tracker.push(&missing(0));
    tracker.source_ended(1);
    assert_eq!(tracker.state(30 * 86_400_000 * MS), GazeState::LOST);
}

#[test]
fn trust_ramps_up_to_a_steady_fixation() {
    let (tracker, now) = followed(vec![3.0; 11], 10);
    let state = tracker.state(now);
    assert_eq!(state.phase, GazePhase::Fixation);
    assert!((state.trust - 0.5).abs() < 1e-6, "{state:?}");
    assert_eq!(state.velocity_deg_s, 0.0);
    let (tracker, now) = followed(vec![3.0; 100], 10);
    assert_eq!(tracker.state(now).trust, 1.0);
}

#[test]
fn pursuit_has_its_speed() {
    let (tracker, now) = followed((0..100).map(|i| i as f32 * 0.3), 10);
    let state = tracker.state(now);
    assert!((state.velocity_deg_s - 30.0).abs() < 0.01, "{state:?}");
    assert_eq!(state.phase, GazePhase::Pursuit);
    // 50 ms later, where the frame is shown that it is for.
    let later = tracker.state(now + 50 * MS);
    assert!(eccentricity(later.directions[0], yaw(29.7 + 1.5)).to_degrees() < 0.02, "{later:?}");
}

#[test]
fn a_saccade_is_followed_by_60_ms_of_care() {
    let yaws = (0..50).map(|i| ((i - 40).max(0) as f32 * 3.0).min(15.0));
    let (mut tracker, mut now) = followed(yaws.clone().take(44), 10);
    assert_eq!(tracker.state(now).phase, GazePhase::Saccade);
    assert!((tracker.state(now).velocity_deg_s - 300.0).abs() < 0.1);
    for yaw_deg in [12.0, 15.0, 15.0] {
        now += 10 * MS;
        tracker.push(&sample(yaw_deg, now));
    }
    for (later_ms, phase) in [(0, GazePhase::PostSaccade), (20, GazePhase::PostSaccade)] {
        let state = tracker.state(now + later_ms * MS);
        assert!(state.phase == phase && state.is_suppressed, "{state:?}");
    }
    let landed = now;
    while now < landed + 60 * MS {
        let state = tracker.state(now);
        assert!(state.phase == GazePhase::PostSaccade && state.is_suppressed, "{} ns after", now - landed);
        now += 10 * MS;
        tracker.push(&sample(15.0, now));
    }
    let state = tracker.state(now);
    assert_eq!(state.phase, GazePhase::Fixation);
    assert!(state.may_coarsen() && !state.is_suppressed);
}

/// Times at which changes are taken to go unnoticed, milliseconds after the start of a saccade of 15 degrees and 54 ms, which is known to 3
/// ms. Its samples arrive `latency_ms` late; `dated_ms` is their age by the source, if it gives one, and that may be off by `uncertainty_ms`.
fn suppressed_ms(latency_ms: i64, dated_ms: Option<i64>, uncertainty_ms: i64) -> Vec<i64> {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let arrival = |index: i64| 1_000 * MS + index * 9 * MS;
    let mut suppressed = Vec::new();
    for index in 0..80 {
        // Least jerk from sample 40 on.
        let s = ((index - 40).clamp(0, 6) as f32) / 6.0;
        let yaw_deg = 15.0 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let time_ns = dated_ms.map_or(0, |dated_ms| arrival(index) - dated_ms * MS);
        let uncertainty_ns = uncertainty_ms * MS;
        tracker.push_at(&GazeSample { uncertainty_ns, ..sample(yaw_deg, time_ns) }, arrival(index));
        if tracker.state(arrival(index)).is_suppressed {
            suppressed.push((arrival(index) - (arrival(40) - latency_ms * MS)) / MS);
        }
    }
    suppressed
}

#[test]
fn changes_go_unnoticed_until_60_ms_after_the_landing_and_not_after_its_arrival() {
    for latency_ms in [0, 30, 50, 80] {
        let suppressed = suppressed_ms(latency_ms, Some(latency_ms), 0);
        let latest = suppressed.iter().copied().max().unwrap_or(0);
        assert!(latest <= 54 + 60 + 3, "{latency_ms} ms late: {suppressed:?}");
        assert!(latest > 80, "{latency_ms} ms late: {suppressed:?}");
    }
    assert_eq!(suppressed_ms(140, Some(140), 0), Vec::<i64>::new(), "too late");
    // An undated sample may be older than its estimated time.
    for latency_ms in [50, 81] {
        let suppressed = suppressed_ms(latency_ms, None, 0);
        assert!(suppressed.iter().all(|after| *after <= 54 + 60 + 3), "{latency_ms} ms late: {suppressed:?}");
    }
    // And so may one whose time is an estimate.
    for latency_ms in [50, 80, 110, 140] {
        let suppressed = suppressed_ms(latency_ms, Some(50), 90);
        assert!(suppressed.iter().all(|after| *after <= 54 + 60 + 3), "{latency_ms} ms late: {suppressed:?}");
    }
    let latest = suppressed_ms(50, Some(50), 10).into_iter().max().unwrap_or(0);
    assert!((80..=54 + 50 + 3).contains(&latest), "{latest}");
}

/// A source that predicts gives the gaze of now without a time: the landing is later than the estimate by its latency.
#[test]
fn tiles_keep_their_rates_until_60_ms_after_the_latest_landing() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let (mut coarsened, mut landed_ns) = (Vec::new(), 0);
    for index in 0..120 {
        let now = 1_000 * MS + index * 9 * MS;
        let s = ((index - 80).clamp(0, 6) as f32) / 6.0;
        let yaw_deg = 15.0 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        // Noise: without it, samples without a time are repetitions.
        tracker.push_at(&sample(yaw_deg + 0.02 * (index % 3) as f32, 0), now);
        landed_ns = if index == 86 { now } else { landed_ns };
        let state = tracker.state(now);
        if index > 82 && state.may_coarsen() && !state.is_suppressed {
            coarsened.push((now - landed_ns) / MS);
        }
    }
    assert!(coarsened.first().is_some_and(|first| (60 - 19 - 9..150).contains(first)), "{coarsened:?}");
}

/// A sample that is too old to be used, of another source, says nothing of the time of the newest.
#[test]
fn a_dropped_sample_changes_no_uncertainty() {
    let (mut tracker, mut now) = followed((0..46).map(|i| ((i - 40).max(0) as f32 * 3.0).min(15.0)), 10);
    for _ in 0..3 {
        now += 10 * MS;
        tracker.push(&sample(15.0, now));
    }
    let before = tracker.state(now);
    assert!(before.is_suppressed);
    let late = GazeSample { uncertainty_ns: 90 * MS, ..sample(15.0, now - 40 * MS) };
    tracker.push_at(&late, now);
    assert_eq!((tracker.rejection(), tracker.state(now)), (Some(Rejection::OutOfOrder), before));
}

/// An application that pauses for five seconds right after an outlier, and asks nothing meanwhile: the eyes may be anywhere after it.
#[test]
fn a_pause_after_an_outlier_is_an_interruption() {
    let noise = |i: i32| 0.3 * ((i * 7919 % 13) as f32 / 6.0 - 1.0);
    let (mut tracker, now) = followed((0..100).map(noise), 10);
    tracker.push(&sample(60.0, now + 10 * MS));
    let later = now + 5_000 * MS;
    tracker.push(&sample(0.0, later));
    let state = tracker.state(later);
    assert_eq!(state.phase, GazePhase::PostSaccade);
    assert!(eccentricity(state.directions[0], yaw(0.0)).to_degrees() < 0.5, "{state:?}");
}

#[test]
fn nothing_goes_unnoticed_after_a_blink_and_for_a_sample_alone() {
    let (mut tracker, now) = followed(vec![7.0; 100], 10);
    (1..20).for_each(|step| tracker.push(&missing(now + step * 10 * MS)));
    tracker.push(&sample(-20.0, now + 200 * MS));
    let found = tracker.state(now + 200 * MS);
    assert!(found.phase == GazePhase::PostSaccade && !found.is_suppressed && !found.may_coarsen());
    for jump_deg in [3.0, 25.0] {
        let (mut tracker, now) = followed(vec![1.0; 60], 8);
        tracker.push(&sample(1.0 + jump_deg, now + 8 * MS));
        let state = tracker.state(now + 8 * MS);
        assert!(!state.is_suppressed && !state.may_coarsen(), "{state:?}");
        tracker.push(&sample(1.0, now + 16 * MS));
        assert!(!tracker.state(now + 16 * MS).is_suppressed);
    }
}

#[test]
fn one_outlier_is_no_saccade() {
    let mut yaws = vec![1.0; 60];
    yaws[50] = 25.0;
    for count in 51..=60 {
        let (tracker, now) = followed(yaws[..count].iter().copied(), 8);
        let state = tracker.state(now);
        let phase = if count == 51 { GazePhase::PostSaccade } else { GazePhase::Fixation };
        assert_eq!(state.phase, phase, "{count}");
        assert!(state.velocity_deg_s < 1.0, "{state:?}");
    }
}

#[test]
fn a_blink_is_held_and_a_loss_ramps() {
    let (mut tracker, now) = followed(vec![7.0; 100], 10);
    (1..4).for_each(|step| tracker.push(&missing(now + step * 10 * MS)));
    for (later_ms, phase, trust) in [
        (30, GazePhase::PostSaccade, 1.0),
        (50, GazePhase::Blink, 1.0),
        (500, GazePhase::Blink, 1.0),
        (501, GazePhase::Lost, 0.995),
        (600, GazePhase::Lost, 0.5),
        (700, GazePhase::Lost, 0.0),
        (30 * 86_400_000, GazePhase::Lost, 0.0),
    ] {
        let state = tracker.state(now + later_ms * MS);
        assert_eq!(state.phase, phase, "after {later_ms} ms");
        assert!((state.trust - trust).abs() < 1e-5, "after {later_ms} ms: {state:?}");
        assert_eq!(state.directions, [yaw(7.0); 2]);
        assert_eq!(state.velocity_deg_s, 0.0);
    }
    // Found again half way down: trust goes on from there, upwards, and care is taken at first.
    let found = now + 600 * MS;
    tracker.push(&sample(-20.0, found));
    assert_eq!(tracker.state(found).phase, GazePhase::PostSaccade);
    assert!((tracker.state(found).trust - 0.5).abs() < 1e-5);
    tracker.push(&sample(-20.0, found + 20 * MS));
    assert!((tracker.state(found + 20 * MS).trust - 0.6).abs() < 1e-5);
}

#[test]
fn samples_that_stop_are_a_blink_too() {
    let (tracker, now) = followed(vec![7.0; 100], 10);
    assert_eq!(tracker.state(now + 50 * MS).phase, GazePhase::Fixation);
    assert_eq!(tracker.state(now + 51 * MS).phase, GazePhase::Blink);
}

#[test]
fn an_ended_source_is_not_held() {
    let (mut tracker, now) = followed(vec![7.0; 100], 10);
    tracker.source_ended(now + 10 * MS);
    tracker.source_ended(now + 90 * MS);
    assert_eq!(tracker.state(now + 10 * MS).phase, GazePhase::Lost);
    assert!((tracker.state(now + 110 * MS).trust - 0.5).abs() < 1e-5);
    assert_eq!(tracker.state(now + 210 * MS).trust, 0.0);
}

#[test]
fn one_eye_speaks_for_both() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    for blind in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        tracker.push(&GazeSample { directions: [blind, yaw(5.0) * 1e30], ..sample(5.0, 0) });
        let state = tracker.state(0);
        for direction in state.directions {
            assert!((direction - yaw(5.0)).length() < 1e-6, "{state:?}");
        }
    }
}

#[test]
fn eccentricity_is_that_of_the_nearer_eye() {
    let state = GazeState { directions: [yaw(-2.0), yaw(3.0)], ..GazeState::LOST };
    for (yaw_deg, nearest_deg) in [(-10.0, 8.0), (10.0, 7.0), (0.5, 2.5), (3.0, 0.0)] {
        let got = state.eccentricity(yaw(yaw_deg)).to_degrees();
        assert!((got - nearest_deg).abs() < 1e-4, "{yaw_deg}: {got}");
    }
    assert_eq!(state.eccentricity(Vec3::NAN), 0.0);
}

#[test]
fn inflation_adds_error_and_motion() {
    for ((base, error, motion), radius) in [
        ((5.2, 1.1, 0.0), 6.3),
        ((5.2, 1.1, 6.0), 12.3),
        ((5.2, 1.1, 42.0), 30.0),
        ((35.0, 1.1, 42.0), 36.1),
        ((170.0, 20.0, 0.0), 180.0),
        ((5.0, -1.0, -3.0), 5.0),
        ((5.0, 1.0, f32::NAN), 30.0),
        ((5.0, 1.0, f32::INFINITY), 30.0),
        ((5.0, f32::NAN, 0.0), 30.0),
        ((f32::NAN, 0.0, 0.0), 180.0),
        ((5.0, 1.0, f32::MAX), 30.0),
    ] {
        let got = foveal_inflation_deg(base, error, motion);
        assert!((got - radius).abs() < 1e-4, "{base} {error} {motion}: {got}");
    }
}

#[test]
fn a_gaze_that_stays_fast_is_no_saccade_for_ever() {
    // At rest, then at 200 deg/s, as the eyes do against a turning head.
    let yaws = |count| (0..count).map(|i| -30.0 + 2.0 * (i - 20).max(0) as f32);
    let (tracker, now) = followed(yaws(30), 10);
    assert_eq!(tracker.state(now).phase, GazePhase::Saccade);
    let (tracker, now) = followed(yaws(50), 10);
    let state = tracker.state(now);
    assert_eq!(state.phase, GazePhase::Pursuit);
    assert!((state.velocity_deg_s - 200.0).abs() < 1.0, "{state:?}");
}

#[test]
fn motion_is_speed_times_latency_or_the_error_of_the_landing() {
    let moving = GazeState { velocity_deg_s: 300.0, ..GazeState::LOST };
    assert_eq!(moving.motion_deg(0.06), 18.0);
    for (prediction_error_deg, motion_deg) in [(4.0, 4.0), (40.0, 18.0), (-1.0, 0.0), (f32::NAN, 18.0)] {
        let state = GazeState { prediction_error_deg: Some(prediction_error_deg), ..moving };
        assert_eq!(state.motion_deg(0.06), motion_deg);
    }
    assert_eq!(
        GazeState { prediction_error_deg: Some(4.0), ..moving }.motion_deg(0.0),
        0.0,
        "an image of this moment"
    );
    assert_eq!(GazeState { timing_error_deg: 2.0, ..moving }.motion_deg(0.06), 20.0);
}

#[test]
fn canted_views_see_one_gaze_at_points_of_their_own() {
    let state = GazeState { directions: [yaw(10.0); 2], ..GazeState::LOST };
    let canted = |yaw_deg: f32| Quat::from_rotation_y(-yaw_deg.to_radians());
    let [left, right] = state.tangent_points([canted(-5.0), canted(5.0)]);
    let (left, right) = (left.expect("in front"), right.expect("in front"));
    assert!((left.x - 15f32.to_radians().tan()).abs() < 1e-6, "{left}");
    assert!((right.x - 5f32.to_radians().tan()).abs() < 1e-6, "{right}");
    assert!(left.y.abs() < 1e-6 && right.y.abs() < 1e-6);
    assert_eq!(state.tangent_points([canted(100.0), Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)]), [None; 2]);
}

#[test]
fn one_ray_for_both_eyes_gets_a_direction_for_each_and_two_are_kept() {
    let eyes = [Vec3::X * -0.03, Vec3::X * 0.03];
    let one = GazeState { directions: [yaw(0.0); 2], ..GazeState::LOST };
    let [left, right] = one.with_vergence(eyes, Some(0.5)).directions;
    for (direction, x) in [(left, 0.06), (right, -0.06)] {
        assert!((direction.x / -direction.z - x).abs() < 1e-6, "{direction}");
    }
    let two = GazeState { directions: [yaw(1.0), yaw(-1.0)], ..GazeState::LOST };
    assert_eq!(two.with_vergence(eyes, Some(0.5)), two);
}

#[test]
fn the_ray_is_kept_where_the_distance_is_not_known() {
    let eyes = [Vec3::X * -0.03, Vec3::X * 0.03];
    let one = GazeState { directions: [yaw(7.0); 2], ..GazeState::LOST };
    let [assumed, beyond] = [one.with_vergence(eyes, None), one.with_nearest(eyes, 2.0)];
    for state in [assumed, beyond] {
        assert_eq!(state.ray, Some(yaw(7.0)));
        assert_ne!(state.directions[0], state.directions[1]);
    }
    let apart = |state: GazeState| eccentricity(state.directions[0], state.directions[1]);
    assert!(apart(beyond) < 0.25 * apart(assumed));
    assert_eq!(one.with_vergence(eyes, Some(0.5)).ray, None);
    let two = GazeState { directions: [yaw(1.0), yaw(-1.0)], ..GazeState::LOST };
    assert_eq!(two.with_vergence(eyes, None), two, "eyes that are tracked apart");
}

#[test]
fn a_head_that_is_told_twice_for_one_frame_keeps_its_speed() {
    // A gaze that turns against a fast head is not a saccade, also for the second sample of a frame.
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let turned = |degrees: f32| Quat::from_rotation_y(degrees.to_radians());
    for step in 0..60 {
        let (now, angle) = (step * 10 * MS, step as f32);
        for _ in 0..2 {
            tracker.head_turned(turned(angle * 1.5), now);
        }
        tracker.push(&sample(angle * 1.5 - 40.0, now));
        assert!(tracker.state(now).phase != GazePhase::Saccade, "step {step}");
    }
}

/// Samples are taken once a frame: further apart than an interruption is long, they are not a fixation.
#[test]
fn a_gaze_is_relied_on_from_seven_frames_a_second_on() {
    let trust = |hz: i64| {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let frames = (0..hz * 10).map(|frame| frame * 1_000_000_000 / hz + 20 * MS);
        frames.fold(0.0, |_, now| {
            tracker.push_at(&sample(3.0, now - 12 * MS), now);
            tracker.state(now).trust
        })
    };
    assert_eq!([2, 5, 6].map(trust), [0.0; 3]);
    assert_eq!([7, 10, 15, 30].map(trust), [1.0; 4]);
}
