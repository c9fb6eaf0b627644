//! Properties of any input.

use super::*;
use crate::geometry::Fov;
use proptest::prelude::*;

proptest! {
    #[test]
    fn any_stream_of_samples_gives_a_sound_state(
        samples in proptest::collection::vec(
            (
                prop_oneof![
                    proptest::array::uniform3(prop_oneof![proptest::num::f32::ANY, -1f32..1.0]),
                    (-0.5f32..0.5, -0.5f32..0.5).prop_map(|(x, y)| [x, y, -1.0]),
                    (-0.05f32..0.05).prop_map(|x| [x, 0.0, -1.0]),
                ],
                prop_oneof![any::<i64>(), -20 * MS..20 * MS, 0..20 * MS, Just(0)],
                0u8..12,
            ),
            0..60,
        ),
        later in prop_oneof![any::<i64>(), 0..700 * MS],
    ) {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut time = 0i64;
        for (direction, step, kind) in samples {
            time = time.saturating_add(step);
            let direction = Vec3::from(direction);
            match kind {
                0 => tracker.source_ended(time),
                3 => tracker.head_turned(Quat::from_xyzw(direction.x, direction.y, direction.z, 1.0), time),
                4 => {
                    let fov = Fov { left: direction.x, right: -direction.x, up: direction.y, down: -0.7 };
                    tracker.set_views(Some([(fov, Quat::IDENTITY); 2]));
                }
                5 | 6 => {
                    let time_ns = if kind == 5 { 0 } else { time.saturating_sub(50 * MS) };
                    tracker.push_at(&GazeSample { directions: [direction; 2], uncertainty_ns: step, ..sample(0.0, time_ns) }, time);
                }
                kind => tracker.push(&GazeSample {
                    directions: [direction, if kind == 1 { Vec3::NAN } else { direction }],
                    time_ns: time,
                    uncertainty_ns: 0,
                    valid: kind != 2,
                }),
            }
            for now in [time, time.saturating_add(later)] {
                let state = tracker.state(now);
                prop_assert!((0.0..=1.0).contains(&state.trust), "{state:?}");
                prop_assert!((0.0..=1000.0).contains(&state.velocity_deg_s), "{state:?}");
                prop_assert!(state.directions.iter().all(|direction| direction.is_normalized()), "{state:?}");
                let motion_deg = state.motion_deg(0.06);
                prop_assert!(motion_deg.is_finite() && motion_deg >= 0.0, "{state:?}");
                let radius_deg = foveal_inflation_deg(5.0, 1.1, motion_deg);
                prop_assert!((6.1..=30.0).contains(&radius_deg), "{radius_deg}");
                for direction in state.with_vergence([Vec3::NAN; 2], None).directions {
                    prop_assert!(direction.is_normalized(), "{direction}");
                }
            }
        }
    }

    #[test]
    fn trust_never_jumps(gaps_ms in proptest::collection::vec((1i64..900, any::<bool>()), 1..20)) {
        let (mut tracker, mut now) = followed([0.0; 60], 10);
        let mut before = tracker.state(now).trust;
        for (gap_ms, valid) in gaps_ms {
            for step in 1..=gap_ms {
                let trust = tracker.state(now + step * MS).trust;
                prop_assert!((trust - before).abs() < 0.0051, "{before} to {trust}");
                before = trust;
            }
            now += gap_ms * MS;
            tracker.push(&GazeSample { valid, ..sample(0.0, now) });
            let trust = tracker.state(now).trust;
            // A sample at least every 50 ms adds the time since the last one.
            prop_assert!(trust - before < 0.26 && trust - before > -0.0051, "{before} to {trust}");
            before = trust;
        }
    }

    /// As runtimes do that are asked more often than the tracker answers.
    #[test]
    fn a_sample_that_comes_twice_counts_once(
        steps in proptest::collection::vec((-3f32..3.0, 4i64..30, any::<bool>()), 1..80),
    ) {
        let [mut once, mut twice] = [GazeTracker::new(GazeSettings::default()), GazeTracker::new(GazeSettings::default())];
        let (mut yaw_deg, mut time) = (0.0, 1000 * MS);
        for (turn_deg, step_ms, jumps) in steps {
            yaw_deg = (yaw_deg + if jumps { 5.0 * turn_deg } else { 0.1 * turn_deg }).clamp(-60.0, 60.0);
            time += step_ms * MS;
            once.push_at(&sample(yaw_deg, time), time + 50 * MS);
            twice.push_at(&sample(yaw_deg, time), time + 50 * MS);
            twice.push_at(&sample(yaw_deg, time), time + 52 * MS);
            let now = time + 55 * MS;
            let (a, b) = (once.state(now), twice.state(now));
            // A sample that was rejected as too fast comes again with the same time, and adds no information.
            prop_assert_eq!(a, b);
        }
    }

    /// Nothing becomes coarser by one wrong sample, and with the next one it is forgotten.
    #[test]
    fn one_wrong_sample_changes_nothing_for_good(wrong in (-0.9f32..0.9, -0.9f32..0.9), step_ms in 4i64..17) {
        let (mut tracker, now) = followed(vec![2.0; 60], step_ms);
        let wrong = Vec3::new(wrong.0, wrong.1, -1.0).normalize();
        let off_deg = eccentricity(wrong, yaw(2.0)).to_degrees();
        prop_assume!(off_deg > step_ms as f32 * 1.1);
        let step = step_ms * MS;
        tracker.push(&GazeSample { directions: [wrong; 2], ..sample(0.0, now + step) });
        prop_assert_eq!(tracker.rejection(), Some(Rejection::TooFast));
        prop_assert!(!tracker.state(now + step).may_coarsen());
        tracker.push(&sample(2.0, now + 2 * step));
        let state = tracker.state(now + 2 * step);
        prop_assert_eq!(state.phase, GazePhase::Fixation);
        prop_assert!(eccentricity(state.directions[0], yaw(2.0)).to_degrees() < 0.01, "{state:?}");
    }
}
