use super::super::Script;
use super::*;
use crate::scene::SceneName;

const STEP: f64 = 0.001;

/// Speed of the gaze in VIEW, degrees a second.
fn speed(gaze: &TrueGaze, t: f64) -> f32 {
    gaze.at(t).direction.angle_between(gaze.at(t + STEP).direction).to_degrees() / STEP as f32
}

fn scripts() -> impl Iterator<Item = Script> {
    SceneName::ALL.into_iter().map(Script::new)
}

/// Measures duration and amplitude on the gaze itself, not on its plan.
#[test]
fn saccades_follow_the_main_sequence() {
    for script in scripts() {
        let saccades = script.gaze.saccades();
        assert!(saccades.len() >= 10, "{:?} has {} saccades", script.scene, saccades.len());
        for saccade in saccades {
            let (start, end) = (saccade.start_s, saccade.start_s + saccade.duration_s);
            let [from, to] = [start, end].map(|t| script.gaze.at(t).direction);
            let amplitude = from.angle_between(to).to_degrees();
            let expected = 0.021 + 0.0022 * f64::from(amplitude);
            assert!((saccade.duration_s - expected).abs() < 2e-4, "{:?}: {saccade:?}", script.scene);
            assert!((amplitude - saccade.amplitude_deg).abs() < 1e-3, "{saccade:?} spans {amplitude}");
            // Fastest in the middle, 1.875 times the mean; slow at both ends.
            let mean = amplitude / saccade.duration_s as f32;
            let peak = speed(&script.gaze, (start + end) / 2.0);
            assert!((peak / mean - 1.875).abs() < 0.03, "{saccade:?}: peak {peak}, mean {mean}");
            assert!(speed(&script.gaze, start + STEP) < 0.3 * peak, "{saccade:?} starts at once");
            assert!(speed(&script.gaze, end - 2.0 * STEP) < 0.3 * peak, "{saccade:?} ends at once");
        }
    }
}

/// Between saccades the eyes turn no faster than they can follow something, and never jump.
#[test]
fn only_saccades_are_fast() {
    for script in scripts() {
        for t in times(1000.0).take_while(|t| *t < DURATION_S - STEP) {
            let (here, there) = (script.gaze.at(t), script.gaze.at(t + STEP));
            if here.phase != Phase::Saccade && there.phase != Phase::Saccade {
                let speed = speed(&script.gaze, t);
                assert!(
                    speed < 35.0,
                    "{:?} at {t}: {speed} degrees a second in {:?}",
                    script.scene,
                    here.phase
                );
            }
        }
    }
}

/// A fixation stays on its point of the world although the head turns.
#[test]
fn fixations_rest_on_the_world() {
    for script in scripts() {
        let mut turned = false;
        for look in script.gaze.looks.iter().filter(|look| matches!(look.target, Target::Still(_))) {
            let world = |t: f64| {
                let (head, gaze) = (script.head.at(t), script.gaze.at(t));
                head.world_position() + head.orientation() * gaze.direction * gaze.distance_m
            };
            let [first, last] = [look.start, look.end].map(world);
            let far = script.gaze.at(look.start).distance_m;
            assert!(first.distance(last) < 1e-4 * far.max(1.0), "{:?}: {first} to {last}", script.scene);
            turned |= script.head.at(look.start).yaw_deg != script.head.at(look.end).yaw_deg;
        }
        assert!(turned, "the head of {:?} never turns", script.scene);
    }
}

/// All scenes have something that moves and is followed, and eyes stay where eyes can look.
#[test]
fn something_is_pursued_and_the_eyes_stay_within_reach() {
    for script in scripts() {
        let mut pursued = 0;
        for t in times(200.0) {
            let gaze = script.gaze.at(t);
            let off = gaze.direction.angle_between(Vec3::NEG_Z).to_degrees();
            assert!(off < REACH_DEG + 6.0, "{:?} at {t}: {off} degrees from straight ahead", script.scene);
            assert!(gaze.distance_m > 0.2 && gaze.direction.is_normalized(), "{gaze:?}");
            pursued += u32::from(gaze.phase == Phase::Pursuit);
        }
        assert!(pursued > 100, "{:?}: {} s of pursuit", script.scene, f64::from(pursued) / 200.0);
    }
}

#[test]
fn scripts_are_the_same_each_time_and_keyframes_follow_them() {
    for (first, second) in scripts().zip(scripts()) {
        let keyframes = first.gaze.keyframes(90.0);
        assert_eq!(keyframes, second.gaze.keyframes(90.0));
        assert_eq!(first.head.keyframes(90.0), second.head.keyframes(90.0));
        for key in keyframes {
            let off = key.direction().angle_between(first.gaze.at(key.t).direction);
            assert!(off < 1e-3, "{:?} at {}: {off} rad off", first.scene, key.t);
        }
    }
}

#[test]
fn blinks_are_as_long_as_blinks_are() {
    for script in scripts() {
        let blinks = script.gaze.blinks();
        assert!(blinks.len() >= 2, "{:?}", script.scene);
        for blink in blinks {
            assert!((0.1..=0.4).contains(&(blink.end - blink.start)), "{blink:?}");
            assert!(script.gaze.is_blink(blink.start) && !script.gaze.is_blink(blink.end));
        }
    }
}
