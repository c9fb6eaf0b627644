//! Failures of gaze in the field, one test each.

use super::*;
use crate::geometry::Fov;

/// From the eye to the frame, in most of these.
const LATENCY: i64 = 50 * MS;

/// A tracker of `step_ms` between samples that are `LATENCY` old when they come, after a second of fixation at `yaw_deg`, and
/// the time of the last sample.
fn late(yaw_deg: f32, step_ms: i64) -> (GazeTracker, i64) {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let mut time = 1000 * MS;
    while time < 2000 * MS {
        time += step_ms * MS;
        tracker.push_at(&sample(yaw_deg, time), time + LATENCY);
    }
    (tracker, time)
}

/// Progress of a saccade of least jerk after a part of its time.
fn way(s: f32) -> f32 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}

#[test]
fn a_sample_as_old_as_trackers_are_is_no_blink() {
    for step_ms in [8, 11, 16] {
        let (tracker, time) = late(4.0, step_ms);
        let now = time + LATENCY + step_ms * MS + 11 * MS;
        assert_eq!(tracker.state(now).phase, GazePhase::Fixation, "{step_ms} ms");
    }
}

#[test]
fn a_slow_tracker_is_no_blink_between_two_samples() {
    let (tracker, time) = late(4.0, 66);
    assert_eq!(tracker.state(time + LATENCY + 66 * MS + 11 * MS).phase, GazePhase::Fixation);
    assert_eq!(tracker.state(time + LATENCY).trust, 1.0);
    assert_eq!(tracker.state(time + LATENCY + 200 * MS).phase, GazePhase::Blink, "but three are missing");
}

#[test]
fn a_sample_time_that_is_not_known_is_the_usual_latency_ago() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    let mut now = 5000 * MS;
    // Pursuit at 20 deg/s; the source gives the gaze of 50 ms ago, without its time.
    for frame in 0..90 {
        now = 5000 * MS + frame * 11 * MS;
        let yaw_deg = 20.0 * (frame * 11 - 50) as f32 * 1e-3;
        tracker.push_at(&sample(yaw_deg, 0), now);
    }
    let state = tracker.state(now);
    assert_eq!(state.phase, GazePhase::Pursuit);
    let truth_deg = 20.0 * (89 * 11) as f32 * 1e-3;
    assert!(eccentricity(state.directions[0], yaw(truth_deg)).to_degrees() < 0.1, "{state:?}");
}

#[test]
fn without_times_a_repeated_answer_is_no_sample() {
    // A tracker of 30 Hz that follows at 20 deg/s, read at 90 Hz: each answer comes three times, by poses of a head that trembles.
    for composed in [false, true] {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut now = 0;
        for frame in 0..180 {
            now = 5000 * MS + frame * 11 * MS;
            let mut seen = sample(0.66 * (frame / 3) as f32, 0);
            if composed {
                let trembling = Quat::from_rotation_y(0.001 * (frame * 31 % 17) as f32);
                seen.directions = seen.directions.map(|gaze| by_poses(trembling, gaze));
            }
            tracker.push_at(&seen, now);
            if frame > 60 {
                assert_eq!(tracker.state(now).phase, GazePhase::Pursuit, "frame {frame}");
            }
        }
        assert!((tracker.state(now).velocity_deg_s - 20.0).abs() < 0.5, "{:?}", tracker.state(now));
    }
}

/// A gaze from the head, by a runtime that turns it into the world and back.
fn by_poses(head: Quat, gaze: Vec3) -> Vec3 {
    head.inverse() * (head * gaze)
}

#[test]
fn without_times_a_gaze_that_never_changes_is_not_lost() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    for frame in 0..900 {
        let now = 5000 * MS + frame * 11 * MS;
        tracker.push_at(&sample(6.0, 0), now);
        if frame > 60 {
            assert_eq!(tracker.state(now).phase, GazePhase::Fixation, "frame {frame}");
            assert_eq!(tracker.state(now).trust, 1.0);
        }
    }
}

#[test]
fn a_tracker_that_repeats_its_last_sample_for_ever_is_lost() {
    let (mut tracker, time) = late(4.0, 10);
    let last = sample(4.0, time);
    for frame in 0..90 {
        tracker.push_at(&last, time + LATENCY + frame * 11 * MS);
    }
    assert_eq!(tracker.state(time + LATENCY + 990 * MS).phase, GazePhase::Lost);
}

/// SteamVR with a Pimax headset.
#[test]
fn a_gaze_out_of_the_back_of_the_head_is_rejected() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    for frame in 1..100 {
        tracker.push_at(
            &GazeSample { directions: [Vec3::Z; 2], ..sample(0.0, frame * 11 * MS) },
            frame * 11 * MS,
        );
        assert_eq!(tracker.rejection(), Some(Rejection::Behind));
        assert_eq!(tracker.state(frame * 11 * MS), GazeState::LOST);
    }
    let (mut tracker, time) = late(4.0, 10);
    let behind = GazeSample { directions: [yaw(176.0); 2], ..sample(0.0, time + 10 * MS) };
    tracker.push_at(&behind, time + 10 * MS + LATENCY);
    let state = tracker.state(time + 60 * MS + LATENCY);
    assert_eq!((state.phase, state.trust), (GazePhase::Blink, 1.0));
    assert!(eccentricity(state.directions[0], yaw(4.0)).to_degrees() < 0.01, "the last one is held");
}

#[test]
fn a_gaze_farther_to_the_side_than_eyes_turn_is_rejected() {
    let (mut tracker, time) = late(4.0, 10);
    tracker.push_at(&sample(80.0, time + 10 * MS), time + 10 * MS + LATENCY);
    assert_eq!(tracker.rejection(), Some(Rejection::OutOfReach));
}

#[test]
fn a_gaze_outside_of_both_views_is_held_and_then_lost() {
    let (mut tracker, time) = late(30.0, 10);
    let fov = |left_deg: f32, right_deg: f32| Fov {
        left: left_deg.to_radians(),
        right: right_deg.to_radians(),
        up: 0.7,
        down: -0.7,
    };
    // Canted by 5 degrees each: the left view ends at 35 to the right, the right one at 45.
    let canted = |yaw_deg: f32| Quat::from_rotation_y(-yaw_deg.to_radians());
    tracker.set_views(Some([(fov(-45.0, 40.0), canted(-5.0)), (fov(-40.0, 40.0), canted(5.0))]));
    let mut phases = [None; 2];
    for (index, yaw_deg, samples) in [(0, 50.0f32, 100), (1, 58.0, 30)] {
        let mut tracker = tracker.clone();
        for number in 1..samples {
            // Slowly enough to get there.
            let at = yaw_deg.min(30.0 + number as f32);
            let time = time + number * 10 * MS;
            tracker.push_at(&sample(at, time), time + LATENCY);
            phases[index] = Some((tracker.rejection(), tracker.state(time + LATENCY).phase));
        }
    }
    let seen = Some((None, GazePhase::Fixation));
    let outside = Some((Some(Rejection::OutsideViews), GazePhase::Blink));
    assert_eq!(phases[0], seen, "within the margin");
    assert_eq!(phases[1], outside, "held, at first");
    for number in 1..100 {
        tracker.push_at(&sample(58.0, time + number * 10 * MS), time + number * 10 * MS + LATENCY);
    }
    assert_eq!(tracker.state(time + 990 * MS + LATENCY).phase, GazePhase::Lost);
    // With invalid views the gaze counts as plausible.
    tracker.set_views(Some([(fov(f32::NAN, 40.0), canted(0.0)); 2]));
    tracker.push_at(&sample(58.0, time + 1000 * MS), time + 1000 * MS + LATENCY);
    assert_eq!(tracker.rejection(), None);
}

/// Windows Mixed Reality advertises a gaze that is the head's direction; trackers also hang.
#[test]
fn a_gaze_that_never_changes_while_the_head_turns_is_no_gaze() {
    for (head_deg_s, frozen, composed) in
        [(30.0, true, false), (0.0, false, false), (30.0, true, true), (0.0, false, true)]
    {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut lost_at = None;
        for frame in 0..270i64 {
            let now = 5000 * MS + frame * 11 * MS;
            let seconds = frame as f32 * 0.011;
            let head = Quat::from_rotation_y((head_deg_s * seconds).to_radians());
            tracker.head_turned(head, now);
            let gaze = if composed { by_poses(head, yaw(12.0)) } else { yaw(12.0) };
            tracker.push_at(&GazeSample { directions: [gaze; 2], ..sample(12.0, now - LATENCY) }, now);
            if tracker.rejection() == Some(Rejection::Frozen) {
                lost_at.get_or_insert(seconds);
                assert_eq!(tracker.state(now).phase, GazePhase::Lost);
            }
        }
        assert_eq!(lost_at.is_some(), frozen, "head at {head_deg_s} deg/s");
        assert!(lost_at.is_none_or(|seconds| (0.99..1.05).contains(&seconds)), "{lost_at:?}");
        if frozen {
            let now = 5000 * MS + 270 * 11 * MS;
            assert_eq!(tracker.state(now).trust, 0.0);
            tracker.push_at(&sample(12.01, now - LATENCY), now);
            assert_eq!(tracker.rejection(), None, "a tracker that goes on is believed again");
            assert_eq!(tracker.state(now).phase, GazePhase::PostSaccade);
        }
    }
}

/// Turn of a head that rests until `start_ns` and turns at 200 deg/s from then on, degrees.
fn turned_deg(time_ns: i64, start_ns: i64) -> f32 {
    200.0 * ((time_ns - start_ns).max(0) as f64 * 1e-9) as f32
}

#[test]
fn eyes_that_turn_against_the_head_rest() {
    // Frames of 11 ms; the tracker has a sample each 8 ms, 50 ms late; the eyes rest on the world.
    let start = 2500 * MS;
    let mut courses = Vec::new();
    for told in [true, false] {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let (mut saccades, mut pursuits, mut farthest_deg) = (0, 0, 0.0f32);
        for frame in 0..170 {
            let now = 1000 * MS + frame * 11 * MS;
            if told {
                tracker.head_turned(Quat::from_rotation_y(turned_deg(now, start).to_radians()), now);
            }
            let sampled = (now - LATENCY) / (8 * MS) * (8 * MS);
            // Samples differ from frame to frame, so that they do not count as frozen.
            let jitter_deg = 1e-3 * (frame % 7) as f32;
            tracker.push_at(&sample(-20.0 + jitter_deg + turned_deg(sampled, start), sampled), now);
            let state = tracker.state(now);
            saccades += u32::from(state.phase == GazePhase::Saccade);
            if now > start + 20 * MS {
                pursuits += u32::from(state.phase == GazePhase::Pursuit);
                let truth = yaw(-20.0 + turned_deg(now, start));
                farthest_deg = farthest_deg.max(eccentricity(state.directions[0], truth).to_degrees());
            }
        }
        courses.push((saccades, pursuits, farthest_deg));
    }
    let [(saccades, pursuits, off_deg), (jumps, turns, behind_deg)] = courses[..] else { unreachable!() };
    assert!(saccades == 0 && pursuits == 0 && off_deg < 0.1, "{courses:?}");
    assert!(jumps + turns > 10 && behind_deg > 10.0, "without being told, they do not: {courses:?}");
}

/// Times of another clock, or of a later frame.
#[test]
fn times_that_cannot_be_true_are_not_read() {
    for (ahead_ms, head_deg_s) in [(1000, 0.0), (70, 0.0), (-10_000, 30.0)] {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut saccades = 0;
        let head = |time: i64| {
            let seconds = (time - 21_400 * MS) as f32 * 1e-9;
            Quat::from_rotation_y((head_deg_s * seconds).to_radians())
        };
        for frame in 0..250i64 {
            let now = 20_000 * MS + frame * 11 * MS;
            let taken = now - LATENCY;
            tracker.head_turned(head(now), now);
            // A saccade in the middle, by eyes that rest on the world before and after.
            let gaze = yaw(15.0 * way((taken - 21_500 * MS) as f32 * 1e-6 / 54.0));
            let directions = [head(taken).inverse() * gaze; 2];
            tracker.push_at(&GazeSample { directions, ..sample(0.0, taken + ahead_ms * MS) }, now);
            let state = tracker.state(now);
            saccades += u32::from(state.phase == GazePhase::Saccade);
            if taken > 22_600 * MS {
                let told = (state.phase, state.is_suppressed, state.trust);
                assert_eq!(told, (GazePhase::Fixation, false, 1.0), "{ahead_ms} ms ahead, frame {frame}");
            }
        }
        assert!(saccades > 0, "{ahead_ms} ms ahead");
    }
}

/// A tracker that has stopped before the session began.
#[test]
fn an_old_sample_that_stays_is_no_gaze() {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    for frame in 0..90 {
        tracker.push_at(&sample(4.0, 1000 * MS), 5000 * MS + frame * 11 * MS);
    }
    assert_eq!(tracker.state(5990 * MS).phase, GazePhase::Lost);
}

#[test]
fn the_error_of_a_sample_of_unknown_age_is_within_the_widened_area() {
    // Eyes that rest on the world, from a tracker that is 80 ms late.
    let start = 2500 * MS;
    for head_deg_s in [0.0, 120.0f32] {
        let head_deg = |time: i64| head_deg_s * ((time - start).max(0) as f64 * 1e-9) as f32;
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut farthest_deg = 0.0f32;
        for frame in 0..190 {
            let now = 1000 * MS + frame * 11 * MS;
            tracker.head_turned(Quat::from_rotation_y(head_deg(now).to_radians()), now);
            let jitter_deg = 1e-2 * (frame % 7) as f32;
            tracker.push_at(&sample(jitter_deg - 35.0 + head_deg(now - 80 * MS), 0), now);
            let state = tracker.state(now);
            let off_deg = eccentricity(state.directions[0], yaw(head_deg(now) - 35.0)).to_degrees();
            let motion_deg = state.motion_deg(0.05);
            assert!(head_deg_s > 0.0 || state.timing_error_deg == 0.0, "a head at rest pays nothing");
            // Before that the turn of the head shows, and that of the eyes does not yet.
            if now > start + 200 * MS {
                assert!(off_deg < motion_deg + 0.1, "frame {frame}: {off_deg} off, {motion_deg} admitted");
                farthest_deg = farthest_deg.max(off_deg);
            }
        }
        assert!(head_deg_s == 0.0 || farthest_deg > 3.0, "{farthest_deg}");
    }
}

#[test]
fn a_gaze_that_turns_with_the_head_is_where_it_was_from_the_head() {
    // To 60 deg/s in 0.2 s.
    let head_deg = |time_ns: i64| {
        let seconds = (time_ns - 2500 * MS).max(0) as f32 * 1e-9;
        150.0 * seconds.min(0.2).powi(2) + 60.0 * (seconds - 0.2).max(0.0)
    };
    let mut tracker = GazeTracker::new(GazeSettings::default());
    for frame in 0..220 {
        let now = 1000 * MS + frame * 11 * MS;
        tracker.head_turned(Quat::from_rotation_y(head_deg(now).to_radians()), now);
        tracker.push_at(&sample(5.0 + 1e-3 * (frame % 7) as f32, now - LATENCY), now);
        let state = tracker.state(now);
        let off_deg = eccentricity(state.directions[0], yaw(5.0)).to_degrees();
        let after_ms = now / MS - 2500;
        assert!(
            matches!(state.phase, GazePhase::PostSaccade | GazePhase::Fixation),
            "{:?} {after_ms} ms after",
            state.phase
        );
        // Until it shows that they turn in the world, they are taken to rest there.
        let (most_deg, speed_deg_s) = if after_ms < 350 { (4.0, 61.0) } else { (0.01, 0.0) };
        assert!(off_deg < most_deg, "{off_deg} off {after_ms} ms after");
        assert!(state.velocity_deg_s <= speed_deg_s, "{state:?} {after_ms} ms after");
    }
}

#[test]
fn a_held_gaze_keeps_its_direction_from_the_head() {
    let (mut tracker, time) = late(20.0, 10);
    for frame in 1..40i64 {
        let now = time + LATENCY + frame * 10 * MS;
        tracker.head_turned(Quat::from_rotation_y((3.0 * frame as f32).to_radians()), now);
        tracker.push_at(&missing(now - LATENCY), now);
        let state = tracker.state(now);
        assert_eq!(state.phase == GazePhase::Blink, frame >= 5, "after {frame} frames");
        // Before that they are taken to rest on the world, in which the head is known from the first frame on.
        let held_deg = if frame < 5 { 20.0 + 3.0 * (frame - 1) as f32 } else { 20.0 };
        let direction = state.directions[0];
        assert!(
            eccentricity(direction, yaw(held_deg)).to_degrees() < 0.01,
            "after {frame} frames: {direction}"
        );
    }
}

/// A tracker whose exposures are not all usable.
#[test]
fn samples_that_are_lost_one_at_a_time_are_no_blinks() {
    // At rest at 60, 90 and 120 Hz, and following at 20 deg/s.
    for (step_ms, deg_s, phase) in [16, 11, 8]
        .into_iter()
        .flat_map(|ms| [(ms, 0.0, GazePhase::Fixation), (ms, 20.0, GazePhase::Pursuit)])
    {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        for number in 0..150i64 {
            let time = 1000 * MS + number * step_ms * MS;
            let seen = sample(deg_s * (number * step_ms) as f32 * 1e-3 - 15.0, time);
            tracker.push_at(&GazeSample { valid: number % 5 != 4, ..seen }, time + LATENCY);
            assert_eq!(tracker.rejection(), (number % 5 == 4).then_some(Rejection::NotTracked));
            if number > 60 {
                let state = tracker.state(time + LATENCY);
                assert_eq!((state.phase, state.trust), (phase, 1.0), "each {step_ms} ms, sample {number}");
            }
        }
    }
}

#[test]
fn eyes_that_are_gone_for_30_ms_may_be_elsewhere() {
    let (mut tracker, time) = late(4.0, 8);
    let mut phases = Vec::new();
    for number in 1..=7 {
        tracker.push_at(&missing(time + number * 8 * MS), time + number * 8 * MS + LATENCY);
        phases.push(tracker.state(time + number * 8 * MS + LATENCY).phase);
    }
    assert_eq!(phases[..3], [GazePhase::Fixation; 3]);
    assert_eq!(phases[3..6], [GazePhase::PostSaccade; 3]);
    assert_eq!(phases[6], GazePhase::Blink);
    let found = time + 64 * MS;
    tracker.push_at(&sample(4.0, found), found + LATENCY);
    assert_eq!(tracker.state(found + LATENCY).phase, GazePhase::PostSaccade);
}

#[test]
fn a_space_that_jumps_moves_no_gaze() {
    let (mut tracker, mut now) = late(8.0, 10);
    for frame in 1..100i64 {
        now += 10 * MS;
        let recentred = if frame > 50 { 120.0f32 } else { 0.0 };
        tracker.head_turned(Quat::from_rotation_y(recentred.to_radians()), now + LATENCY);
        tracker.push_at(&sample(8.0, now), now + LATENCY);
        let state = tracker.state(now + LATENCY);
        assert_eq!(state.phase, GazePhase::Fixation, "frame {frame}");
        assert!(eccentricity(state.directions[0], yaw(8.0)).to_degrees() < 0.01);
    }
}

#[test]
fn a_lost_gaze_does_not_snap_to_the_centre() {
    let (mut tracker, time) = late(20.0, 10);
    for number in 1..200 {
        let time = time + number * 10 * MS;
        tracker.push_at(&missing(time), time + LATENCY);
        assert_eq!(tracker.rejection(), Some(Rejection::NotTracked));
        let direction = tracker.state(time + LATENCY).directions[0];
        assert!(eccentricity(direction, yaw(20.0)).to_degrees() < 0.01, "{direction}");
    }
}

#[test]
fn a_jump_that_no_eye_makes_needs_a_second_sample() {
    let (mut tracker, time) = late(0.0, 8);
    let mut told = Vec::new();
    for (number, yaw_deg) in [(1, 40.0), (2, 40.2)] {
        let time = time + number * 8 * MS;
        tracker.push_at(&sample(yaw_deg, time), time + LATENCY);
        let state = tracker.state(time + LATENCY);
        told.push((tracker.rejection(), state.phase, state.directions[0].x > 0.5));
    }
    assert_eq!(
        told,
        [(Some(Rejection::TooFast), GazePhase::PostSaccade, true), (None, GazePhase::PostSaccade, true)]
    );
}

/// Between xrBeginFrame and xrLocateViews of one frame.
#[test]
fn a_later_answer_for_the_same_time_is_where_the_eyes_may_be() {
    let (mut tracker, time) = late(0.0, 11);
    tracker.push_at(&sample(-40.0, time), time + LATENCY);
    let state = tracker.state(time + LATENCY);
    assert!(eccentricity(state.directions[0], yaw(-40.0)).to_degrees() < 0.01, "{state:?}");
    assert!(!state.may_coarsen());
}

#[test]
fn answers_that_jump_about_are_no_gaze() {
    let (mut tracker, time) = late(0.0, 8);
    for number in 1..100 {
        let time = time + number * 8 * MS;
        tracker.push_at(&sample([40.0, -40.0, -10.0, 20.0][number as usize % 4], time), time + LATENCY);
        assert!(tracker.state(time + LATENCY).phase != GazePhase::Saccade);
    }
    assert_eq!(tracker.state(time + 99 * 8 * MS + LATENCY).phase, GazePhase::Lost);
}

#[test]
fn samples_in_the_wrong_order_are_dropped_with_a_reason() {
    let (mut tracker, time) = late(4.0, 10);
    let before = tracker.state(time + LATENCY);
    tracker.push_at(&sample(9.0, time - 15 * MS), time + LATENCY);
    assert_eq!(tracker.rejection(), Some(Rejection::OutOfOrder));
    assert_eq!(tracker.state(time + LATENCY), before);
}

#[test]
fn the_eyes_are_awaited_where_a_saccade_will_land() {
    // Of 12 to 28 degrees at 120 Hz: half-way, the landing is known within three tenths of the amplitude, by eyes of any pace.
    for amplitude_deg in [12.0, 20.0, 28.0f32] {
        let (mut tracker, time) = late(-10.0, 8);
        let lasts_ms = 21.0 + 2.2 * amplitude_deg;
        let mut awaited = Vec::new();
        for number in 1..20 {
            let s = (number as f32 * 8.33 - 4.0) / lasts_ms;
            let time = time + number * 8_330_000;
            tracker.push_at(&sample(-10.0 + amplitude_deg * way(s), time), time + LATENCY);
            let state = tracker.state(time + LATENCY);
            let off_deg = eccentricity(state.directions[0], yaw(-10.0 + amplitude_deg)).to_degrees();
            if (0.55..0.9).contains(&s) {
                assert_eq!(state.phase, GazePhase::Saccade, "{amplitude_deg} at {s}");
                let error_deg = state.prediction_error_deg.expect("a landing");
                assert!(off_deg < 0.3 * amplitude_deg, "{amplitude_deg} at {s}: {off_deg} off");
                assert!(off_deg < 2.0 * error_deg + 0.5, "{off_deg} off, {error_deg} admitted");
                awaited.push(off_deg);
            }
            if s > 1.5 {
                assert!(off_deg < 0.2, "{amplitude_deg} at {s}: {off_deg} off");
                assert_eq!(state.prediction_error_deg, None);
            }
        }
        assert!(!awaited.is_empty());
    }
}

/// Runtimes smooth: a saccade then looks slower, and ends slowly.
#[test]
fn a_smoothed_saccade_is_one_and_is_followed_to_its_end() {
    let (mut tracker, time) = late(0.0, 11);
    let (mut smoothed, mut saccades) = (0.0, 0);
    for number in 1..40 {
        smoothed += 0.35 * (20.0 * way(number as f32 * 11.0 / 65.0) - smoothed);
        let time = time + number * 11 * MS;
        tracker.push_at(&sample(smoothed, time), time + LATENCY);
        let state = tracker.state(time + LATENCY);
        saccades += u32::from(state.phase == GazePhase::Saccade);
        if number > 12 {
            let off_deg = eccentricity(state.directions[0], yaw(20.0)).to_degrees();
            assert!(off_deg < 2.0, "{off_deg} degrees off after {} ms", number * 11);
        }
    }
    assert!(saccades >= 3, "{saccades}");
    assert_eq!(tracker.state(time + 39 * 11 * MS + LATENCY).phase, GazePhase::Fixation);
}

#[test]
fn every_reason_reads_differently() {
    let texts: std::collections::BTreeSet<String> =
        Rejection::ALL.iter().map(|reason| reason.to_string()).collect();
    assert_eq!(texts.len(), Rejection::ALL.len());
}
