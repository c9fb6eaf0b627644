use super::*;
use proptest::prelude::*;

const MS: i64 = 1_000_000;
const FRAME_NS: i64 = 11_111_111;

/// A calibration of frames at 90 Hz; the answer for the dot that is shown, and a number of milliseconds since the begin. The eyes follow
/// a dot after 250 ms.
fn measured(look: impl Fn([f32; 2], i64) -> Option<[f32; 2]>) -> Calibration {
    let mut calibration = Calibration::default();
    let begun_ns = 77_000 * MS;
    let mut now_ns = begun_ns;
    let (mut eyes, mut dot, mut since_ns) = ([0.0; 2], 0, begun_ns);
    while let Some(shown) = calibration.dot() {
        if shown != dot {
            (dot, since_ns) = (shown, now_ns);
        }
        if now_ns - since_ns >= 250 * MS {
            eyes = DOTS_DEG[dot];
        }
        let at = look(eyes, (now_ns - begun_ns) / MS);
        calibration.push(at.map(|angles| (angles, now_ns - 30 * MS)), now_ns);
        now_ns += FRAME_NS;
        assert!(now_ns - begun_ns < 40_000 * MS, "it ends");
    }
    calibration
}

fn without_correction(angles: [f32; 2]) -> [f32; 2] {
    angles
}

/// A tracker with a wrong scale, turned and off.
fn distorted([left, up]: [f32; 2], scale: f32, turn_deg: f32, offset_deg: [f32; 2]) -> [f32; 2] {
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    [scale * (cos * left - sin * up) + offset_deg[0], scale * (sin * left + cos * up) + offset_deg[1]]
}

/// Noise of a tracker, within -1..1 and mostly near 0, from the time.
fn noise(ms: i64, axis: u64, seed: u64) -> f32 {
    let hash = |salt: u64| {
        let mixed =
            (ms as u64 + salt * 1_000_003 + axis * 7919 + seed * 104_729).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f32 / (1 << 24) as f32
    };
    (hash(1) + hash(2) + hash(3)) / 1.5 - 1.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn a_distortion_is_removed_within_noise_and_blinks(
        scale in 0.85f32..1.15,
        turn_deg in -4f32..4.0,
        offset in proptest::array::uniform2(-3f32..3.0),
        curvature in -0.01f32..0.01,
        noise_deg in 0f32..0.5,
        blinks_at in proptest::collection::vec(0i64..14_000, 0..4),
        seed in any::<u32>(),
    ) {
        prop_assume!(offset[0].hypot(offset[1]) > 1.0);
        let tracker = |[left, up]: [f32; 2]| {
            let [seen_left, seen_up] = distorted([left, up], scale, turn_deg, offset);
            [seen_left + curvature * left * left, seen_up + curvature * up * left]
        };
        let calibration = measured(|eyes, ms| {
            if blinks_at.iter().any(|at| (*at..at + 150).contains(&ms)) {
                return None;
            }
            let [left, up] = tracker(eyes);
            let noise = |axis| noise_deg * noise(ms, axis, seed.into());
            Some([left + noise(0), up + noise(1)])
        });
        let fit = calibration.fit(without_correction).unwrap();
        prop_assert!(fit.error_deg < fit.error_before_deg);
        // Between the dots, too.
        for eyes in [[6.0, 4.0], [-7.0, 3.0], [5.0, -8.0], [-11.0, -8.0], [0.0, 0.0]] {
            let off = distance(fit.polynomial.corrected(tracker(eyes)), eyes);
            prop_assert!(off < 0.5 + noise_deg, "{off} {fit:?}");
        }
    }

    #[test]
    fn any_samples_end_in_a_plausible_correction_or_a_reason(
        samples in proptest::collection::vec(
            (
                proptest::option::of((
                    proptest::array::uniform2(prop_oneof![proptest::num::f32::ANY, -1f32..1.0]),
                    prop_oneof![any::<i64>(), 0..60_000 * MS],
                )),
                prop_oneof![any::<i64>(), 0..60_000 * MS],
            ),
            0..200,
        ),
    ) {
        let mut calibration = Calibration::default();
        samples.into_iter().for_each(|(look, now_ns)| calibration.push(look, now_ns));
        prop_assert!(calibration.fit(without_correction).is_err(), "so few samples");
    }
}

#[test]
fn the_simplest_order_that_explains_the_dots_is_chosen() {
    let order_of = |tracker: fn([f32; 2]) -> [f32; 2]| {
        let noisy = measured(|eyes, ms| {
            let [left, up] = tracker(eyes);
            Some([left + 0.2 * noise(ms, 0, 1), up + 0.2 * noise(ms, 1, 1)])
        });
        noisy.fit(without_correction).unwrap().order
    };
    assert_eq!(order_of(|[left, up]| [left + 2.0, up]), PolynomialOrder::Offset);
    assert_eq!(order_of(|eyes| distorted(eyes, 1.1, 2.0, [3.0, 0.0])), PolynomialOrder::Affine);
    assert_eq!(
        order_of(|[left, up]| [left + 1.0 + 0.02 * left * left, up + 0.01 * left * up]),
        PolynomialOrder::SecondOrder
    );
}

#[test]
fn residuals_of_the_dots_are_those_of_the_corrected_gaze() {
    // One dot is missed by a degree, which no polynomial explains.
    let calibration = measured(|eyes, _| {
        let missed = if eyes == DOTS_DEG[3] { 1.0 } else { 0.0 };
        Some([eyes[0] + 2.0, eyes[1] + missed])
    });
    let fit = calibration.fit(without_correction).unwrap();
    let worst =
        (0..9).max_by(|one, other| fit.dots[*one].accuracy_deg.total_cmp(&fit.dots[*other].accuracy_deg));
    assert_eq!(worst, Some(3), "{fit:?}");
    assert!(fit.dots.iter().all(|dot| dot.precision_deg < 1e-3));
    assert!((fit.error_before_deg - 2.03).abs() < 0.02, "{fit:?}");
}

#[test]
fn a_calibration_lasts_as_long_as_its_dots_and_a_blink_lengthens_one() {
    let end_ms = |blink: std::ops::Range<i64>| {
        let last = std::cell::Cell::new(0);
        let calibration = measured(|eyes, ms| {
            last.set(ms);
            (!blink.contains(&ms)).then_some([eyes[0] + 1.0, eyes[1]])
        });
        assert!(calibration.fit(without_correction).is_ok());
        last.get()
    };
    let quiet = end_ms(0..0);
    assert!((14_300..14_600).contains(&quiet), "{quiet}");
    assert!((end_ms(1800..1950) - quiet - 800).abs() < 30, "a blink in the middle of a measurement");
}

#[test]
fn missing_unsteady_and_distant_dots_are_named() {
    let failure = |look: &dyn Fn([f32; 2], i64) -> Option<[f32; 2]>| {
        measured(look).fit(without_correction).unwrap_err().to_string()
    };
    let unseen = failure(&|eyes, _| (eyes[1] < 5.0).then_some(eyes));
    assert!(
        unseen.ends_with("long enough at the dots at the top, the top right and the top left"),
        "{unseen}"
    );
    assert!(failure(&|_, _| None).contains("long enough at the dots at the middle, the top,"));
    let unsteady =
        failure(&|[left, up], ms| Some([left + if up < -5.0 { ms as f32 * 0.01 % 8.0 } else { 0.0 }, up]));
    assert!(
        unsteady.ends_with("at the dots at the bottom right, the bottom and the bottom left"),
        "{unsteady}"
    );
    let far = failure(&|eyes, _| Some(if eyes == DOTS_DEG[7] { [0.0, 0.0] } else { eyes }));
    assert_eq!(far, "the gaze was more than 10 degrees from the dot at the left");
    let missed =
        failure(&|eyes, _| Some(if eyes == DOTS_DEG[7] { [4.0, 3.0] } else { [eyes[0] + 1.0, eyes[1]] }));
    assert!(missed.starts_with("the gaze at the dot at the left does not fit the other dots"), "{missed}");
    let fixed = failure(&|_, _| Some([0.0, 0.0]));
    assert!(
        fixed.starts_with("the gaze was more than 10 degrees from the dots at the top right,"),
        "{fixed}"
    );
    assert_eq!(Calibration::default().fit(without_correction), Err(CalibrationFailure::Unfinished));
}

#[test]
fn a_fit_that_is_no_better_than_the_present_correction_is_refused() {
    let calibration = measured(|eyes, ms| Some([eyes[0] + 2.0 + noise(ms, 0, 5), eyes[1] + noise(ms, 1, 5)]));
    assert!(calibration.fit(without_correction).is_ok());
    let refused = calibration.fit(|[left, up]| [left - 2.0, up]).unwrap_err();
    assert!(matches!(refused, CalibrationFailure::NotBetter(..)), "{refused:?}");
}
