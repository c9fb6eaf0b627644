use super::super::fixation::DISPERSION_DEG;
use super::*;
use proptest::prelude::*;

const MS: i64 = 1_000_000;

/// A measurement of frames at 90 Hz, with the answer for a number of milliseconds since its begin.
fn measured(look: impl Fn(i64) -> Option<[f32; 2]>) -> Recentring {
    let mut recentring = Recentring::default();
    let mut now_ns = 77_000 * MS;
    let begun_ns = now_ns;
    while !recentring.is_over() {
        let at = look((now_ns - begun_ns) / MS);
        recentring.push(at.map(|angles| (angles, now_ns - 30 * MS)), now_ns);
        now_ns += 11_111_111;
    }
    assert_eq!((now_ns - begun_ns) / MS / 100, 45, "a measurement lasts 4.5 s");
    recentring
}

/// Noise of a tracker, within -1..1 and mostly near 0, from the time.
fn noise(ms: i64, axis: u64) -> f32 {
    let hash = |salt: u64| {
        let mixed = (ms as u64 + salt * 1_000_003 + axis * 7919).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f32 / (1 << 24) as f32
    };
    (hash(1) + hash(2) + hash(3)) / 1.5 - 1.0
}

proptest! {
    #[test]
    fn a_constant_offset_is_found_within_noise_blinks_and_saccades(
        left in -7f32..7.0,
        up in -7f32..7.0,
        noise_deg in 0f32..0.8,
        blink in 0i64..4500,
        saccade in 0i64..4500,
        away in -20f32..20.0,
    ) {
        let recentring = measured(|ms| {
            if (blink..blink + 150).contains(&ms) {
                return None;
            }
            // The lids close and open.
            let lids = if (blink - 80..blink + 230).contains(&ms) { -6.0 } else { 0.0 };
            let jump = if (saccade..saccade + 200).contains(&ms) { away } else { 0.0 };
            Some([left + jump + noise_deg * noise(ms, 0), up + lids + noise_deg * noise(ms, 1)])
        });
        let found = recentring.offset().unwrap();
        prop_assert!(distance(found.offset_deg, [-left, -up]) < 0.15 + 0.2 * noise_deg, "{found:?}");
        prop_assert!(found.spread_deg <= noise_deg * 0.9 + 1e-3, "{found:?}");
    }

    #[test]
    fn any_samples_give_a_plausible_offset_or_a_reason(
        samples in proptest::collection::vec(
            (
                proptest::option::of((
                    proptest::array::uniform2(prop_oneof![proptest::num::f32::ANY, -1f32..1.0]),
                    prop_oneof![any::<i64>(), 0..5000 * MS],
                )),
                prop_oneof![any::<i64>(), 0..5000 * MS],
            ),
            0..200,
        ),
    ) {
        let mut recentring = Recentring::default();
        samples.into_iter().for_each(|(look, now_ns)| recentring.push(look, now_ns));
        if let Ok(GazeOffset { offset_deg, spread_deg }) = recentring.offset() {
            prop_assert!(distance(offset_deg, [0.0; 2]) <= MAX_OFFSET_DEG);
            prop_assert!((0.0..=DISPERSION_DEG).contains(&spread_deg));
        }
    }
}

#[test]
fn the_way_to_the_dot_does_not_count() {
    let recentring = measured(|ms| Some(if ms < 1400 { [15.0, 3.0] } else { [2.0, -1.0] }));
    assert_eq!(recentring.offset().unwrap().offset_deg, [-2.0, 1.0]);
}

#[test]
fn moving_eyes_and_two_points_are_refused() {
    let following = measured(|ms| Some([ms as f32 * 0.005, 0.0]));
    assert_eq!(following.offset(), Err(RecentreFailure::Unsteady));
    let two = measured(|ms| Some(if ms < 3000 { [1.0, 0.0] } else { [4.0, 0.0] }));
    assert_eq!(two.offset(), Err(RecentreFailure::Unsteady));
    let jumping = measured(|ms| Some([if ms / 300 % 2 == 0 { 0.0 } else { 3.0 }, 0.0]));
    assert_eq!(jumping.offset(), Err(RecentreFailure::Unsteady));
}

#[test]
fn eyes_that_are_hardly_seen_are_refused() {
    assert_eq!(measured(|_| None).offset(), Err(RecentreFailure::NoGaze));
    let glimpses = measured(|ms| (ms % 500 < 100).then_some([1.0, 0.0]));
    assert_eq!(glimpses.offset(), Err(RecentreFailure::NoGaze));
    assert_eq!(measured(|_| Some([f32::NAN, 0.0])).offset(), Err(RecentreFailure::NoGaze));
}

#[test]
fn an_implausible_offset_is_refused() {
    let far = measured(|_| Some([8.0, 8.0])).offset();
    assert!(matches!(far, Err(RecentreFailure::TooFar(far)) if (far - 11.3).abs() < 0.1), "{far:?}");
    assert!(measured(|_| Some([9.9, 0.0])).offset().is_ok());
}

#[test]
fn a_sample_in_several_frames_counts_once() {
    let mut recentring = Recentring::default();
    // 10 Hz: too few for a fixation, however many frames show them.
    for frame in 0..405 {
        let now_ns = frame * 11_111_111;
        recentring.push(Some(([1.0, 1.0], now_ns / (100 * MS) * 100 * MS)), now_ns);
    }
    assert_eq!(recentring.offset(), Err(RecentreFailure::Unsteady));
}
