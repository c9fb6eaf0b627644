//! Hard cases of `gaze`.

use super::Case;
use crate::reference::gaze as reference;
use glam::Vec3;
use parafovea_core::gaze::{GazeSample, GazeSettings, GazeState, GazeTracker, foveal_inflation_deg};

const MS: i64 = 1_000_000;
/// Thirty days of XrTime.
const MONTH: i64 = 30 * 86_400_000 * MS;

pub(super) fn cases() -> Vec<Case> {
    [times(), losses(), directions(), inflation()].concat()
}

fn case(case: impl Into<String>, expected: impl ToString, got: impl ToString) -> Case {
    let (expected, got) = (expected.to_string(), got.to_string());
    let passed = expected == got;
    Case { model: "gaze", case: case.into(), expected, got, error: None, passed }
}

fn yaw(yaw_rad: f32) -> Vec3 {
    Vec3::new(yaw_rad.sin(), 0.0, -yaw_rad.cos())
}

fn sample(direction: Vec3, time_ns: i64) -> GazeSample {
    GazeSample { directions: [direction; 2], time_ns, uncertainty_ns: 0, valid: true }
}

/// A tracker after a second of fixation at the centre of the view, a sample each 10 ms, the last of them at `end`.
fn fixating(end: i64) -> GazeTracker {
    let mut tracker = GazeTracker::new(GazeSettings::default());
    for i in (0..100).rev() {
        tracker.push(&sample(Vec3::NEG_Z, end.saturating_sub(i * 10 * MS)));
    }
    tracker
}

/// Phase, trust and whether all is finite.
fn told(state: GazeState) -> String {
    let finite = state.directions.iter().all(|direction| direction.is_normalized())
        && (0.0..=1000.0).contains(&state.velocity_deg_s);
    let broken = if finite { "" } else { ", not finite" };
    format!("{:?}, trust {:.2}{broken}", state.phase, state.trust)
}

fn times() -> Vec<Case> {
    let pushed = |end: i64, later: &[i64]| {
        let mut tracker = fixating(end);
        for &time in later {
            tracker.push(&sample(yaw(0.001), time));
        }
        tracker
    };
    let mut cases = vec![
        case("time of 30 days", "Fixation, trust 1.00", told(fixating(MONTH).state(MONTH))),
        case("time at the end of i64", "Fixation, trust 1.00", told(fixating(i64::MAX).state(i64::MAX))),
        case(
            "time at the start of i64, after its end",
            "Lost, trust 0.00",
            told(fixating(i64::MAX).state(i64::MIN)),
        ),
        case("30 days without a sample", "Lost, trust 0.00", told(fixating(0).state(MONTH))),
        case("equal stamps", "Fixation, trust 1.00", told(pushed(0, &[0, 0, 0]).state(0))),
        case("stamps 1 ns apart", "Fixation, trust 1.00", told(pushed(0, &[1, 2, 3]).state(3))),
        case("a sample 5 ms late, dropped", "Fixation, trust 1.00", told(pushed(0, &[-5 * MS]).state(0))),
        case("reversed stamps", "Fixation, trust 1.00", told(pushed(0, &[-MS, -2 * MS, -3 * MS]).state(0))),
        case(
            "clock that starts anew, 30 days earlier",
            "PostSaccade, trust 0.00",
            told(pushed(MONTH, &[0]).state(0)),
        ),
        case("sample from 30 days ahead, seen now", "Lost, trust 0.00", told(pushed(0, &[MONTH]).state(0))),
        case(
            "asked for 20 ms before the newest sample",
            "Fixation, trust 1.00",
            told(fixating(0).state(-20 * MS)),
        ),
    ];
    for (name, start) in [("0", 0), ("30 days", MONTH)] {
        // 0.005 rad in 10 ms, 28.6 degrees a second; nine samples distinguish it from noise.
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let ends: [_; 9] = std::array::from_fn(|index| yaw(0.965 + 0.005 * index as f32));
        for (i, direction) in ends.into_iter().enumerate() {
            tracker.push(&sample(direction, start + i as i64 * 10 * MS));
        }
        let exact = reference::velocity_deg_s(ends[0].as_dvec3(), ends[8].as_dvec3(), 80 * MS);
        let got = tracker.state(start + 80 * MS).velocity_deg_s;
        let error = (f64::from(got) - exact).abs();
        cases.push(Case {
            error: Some(error),
            passed: error < 0.02,
            ..case(
                format!("velocity from time {name} on"),
                format!("{exact:.3} deg/s"),
                format!("{got:.3} deg/s"),
            )
        });
    }
    cases
}

fn losses() -> Vec<Case> {
    let missing = |time_ns| GazeSample { valid: false, ..sample(Vec3::NEG_Z, time_ns) };
    let blinking = |ms: i64| {
        let mut tracker = fixating(0);
        tracker.push(&missing(40 * MS));
        told(tracker.state(ms * MS))
    };
    let mut never = GazeTracker::new(GazeSettings::default());
    never.push(&missing(0));
    never.push(&sample(Vec3::NAN, MS));
    let mut ended = fixating(0);
    ended.source_ended(0);
    vec![
        case("no sample ever", "Lost, trust 0.00", told(GazeTracker::new(GazeSettings::default()).state(0))),
        case("no valid sample ever", "Lost, trust 0.00", told(never.state(MS))),
        case("blink of 100 ms", "Blink, trust 1.00", blinking(100)),
        case("blink of 500 ms", "Blink, trust 1.00", blinking(500)),
        case("gone for 600 ms", "Lost, trust 0.50", blinking(600)),
        case("gone for 701 ms", "Lost, trust 0.00", blinking(701)),
        case("source ended 100 ms ago", "Lost, trust 0.50", told(ended.state(100 * MS))),
    ]
}

fn directions() -> Vec<Case> {
    let after = |directions: [Vec3; 2]| {
        let mut tracker = fixating(0);
        tracker.push(&GazeSample { directions, ..sample(Vec3::NEG_Z, 10 * MS) });
        told(tracker.state(60 * MS))
    };
    let held = [
        ("both directions zero", [Vec3::ZERO; 2]),
        ("both directions NaN", [Vec3::NAN; 2]),
        ("both directions infinite", [Vec3::INFINITY; 2]),
        ("one sample at 180 degrees", [Vec3::Z; 2]),
    ]
    .map(|(name, directions)| case(name, "Blink, trust 1.00", after(directions)));
    let used = [
        ("left eye NaN, right valid", [Vec3::NAN, Vec3::NEG_Z]),
        ("directions of length 1e-40", [Vec3::NEG_Z * 1e-40; 2]),
        ("directions of length 1e38", [Vec3::NEG_Z * 1e38; 2]),
    ]
    .map(|(name, directions)| case(name, "Fixation, trust 1.00", after(directions)));
    let state = GazeState { directions: [yaw(1e-6), Vec3::X], ..GazeState::LOST };
    let angles =
        [("direction at 1e-6 rad", Vec3::NEG_Z), ("direction behind both eyes", Vec3::new(-1.0, 0.0, 1.0))]
            .map(|(name, direction)| {
                let [left, right] =
                    state.directions.map(|gaze| reference::angle(gaze.as_dvec3(), direction.as_dvec3()));
                let exact = left.min(right);
                let got = state.eccentricity(direction);
                let error = (f64::from(got) - exact).abs();
                Case {
                    error: Some(error),
                    passed: error <= 3e-7 * exact,
                    ..case(name, format!("{exact:.3e} rad"), format!("{got:.3e} rad"))
                }
            });
    let nothing = case("direction NaN", "0 rad", format!("{} rad", state.eccentricity(Vec3::NAN)));
    held.into_iter().chain(used).chain(angles).chain([nothing]).collect()
}

fn inflation() -> Vec<Case> {
    [
        ("at rest", [5.2, 1.1, 0.0], 6.3),
        ("in a saccade of 700 deg/s", [5.2, 1.1, 42.0], 30.0),
        ("at an unknown speed (NaN)", [5.2, 1.1, f32::NAN], 30.0),
        ("with infinite latency", [5.2, 1.1, f32::INFINITY], 30.0),
        ("with negative speed and error", [5.2, -1.1, -0.54], 5.2),
        ("of a fovea of 180 degrees", [180.0, 1.1, 0.0], 180.0),
        ("of a NaN fovea", [f32::NAN, 1.1, 0.0], 180.0),
    ]
    .map(|(name, [base, error, motion], radius)| {
        let got = foveal_inflation_deg(base, error, motion);
        case(format!("inflation {name}"), format!("{radius:.3} deg"), format!("{got:.3} deg"))
    })
    .into()
}
