use super::*;
use proptest::prelude::*;

const FRAME_NS: i64 = 11_111_111;
const MINUTE_NS: i64 = 60_000_000_000;

/// A simulated viewer, at 90 Hz: fixations of 150 to 450 ms, normally distributed around a little below the middle (6.5 degrees
/// sideways, 5 vertically), saccades of 40 ms between them, a blink of 150 ms about every four seconds, noise of 1 degree.
struct Viewer {
    state: u64,
    until_ns: i64,
    eyes_deg: [f32; 2],
}

impl Viewer {
    fn new(seed: u64) -> Self {
        Self {
            state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678,
            until_ns: 0,
            eyes_deg: [0.0; 2],
        }
    }

    /// Uniform within 0..1 (SplitMix64).
    fn uniform(&mut self) -> f32 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    /// About normal, of standard deviation 1.
    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.uniform()).sum::<f32>() - 6.0
    }

    /// The gaze at a time; `None` outside of fixations.
    fn look(&mut self, now_ns: i64) -> Option<[f32; 2]> {
        if now_ns >= self.until_ns {
            self.until_ns = now_ns + 190_000_000 + (self.uniform() * 300e6) as i64;
            if self.uniform() < 0.08 {
                self.until_ns += 150_000_000;
            }
            self.eyes_deg = [6.5 * self.normal(), 5.0 * self.normal() - 2.0];
        }
        let length_ns = self.until_ns - now_ns;
        let is_fixation = length_ns <= 450_000_000;
        is_fixation.then(|| self.eyes_deg.map(|angle| angle + self.normal()))
    }
}

/// The first report of a viewer whose headset slips by so much after a time, nanoseconds since the begin, within a number of minutes.
fn first_report(seed: u64, minutes: i64, slip: impl Fn(i64) -> [f32; 2]) -> Option<(i64, f32)> {
    let (mut viewer, mut drift) = (Viewer::new(seed), GazeDrift::default());
    (0..minutes * MINUTE_NS / FRAME_NS).map(|frame| frame * FRAME_NS).find_map(|now_ns| {
        let [left, up] = slip(now_ns);
        drift.push(viewer.look(now_ns).map(|[eyes_left, eyes_up]| [eyes_left + left, eyes_up + up]), now_ns);
        drift.drift_deg().map(|deg| (now_ns, deg))
    })
}

/// Time of the slip in these tests.
const SLIP_NS: i64 = 10 * MINUTE_NS + 7_000_000_000;

#[test]
fn ordinary_viewing_of_half_an_hour_gives_no_report() {
    for seed in 0..20 {
        assert_eq!(first_report(seed, 30, |_| [0.0; 2]), None, "{seed}");
    }
}

#[test]
fn a_slip_of_three_degrees_is_reported_within_two_minutes() {
    for seed in 0..20 {
        let (sin, cos) = (seed as f32).sin_cos();
        let slipped = |now_ns| if now_ns < SLIP_NS { [0.0; 2] } else { [3.0 * cos, 3.0 * sin] };
        let (at_ns, deg) = first_report(seed, 13, slipped).unwrap();
        assert!(
            (SLIP_NS..SLIP_NS + 2 * MINUTE_NS).contains(&at_ns),
            "{seed}: {} s",
            (at_ns - SLIP_NS) / 1_000_000_000
        );
        assert!((2.0..4.5).contains(&deg), "{seed}: {deg}");
    }
}

#[test]
fn a_slow_slip_is_reported_too() {
    let slow = |now_ns: i64| [0.0, -4.0 * (now_ns as f32 / (20 * MINUTE_NS) as f32).min(1.0)];
    for seed in 0..4 {
        assert!(first_report(seed, 30, slow).is_some(), "{seed}");
    }
}

#[test]
fn a_slip_before_the_mean_of_the_begin_is_known_is_no_drift() {
    assert_eq!(first_report(3, 20, |_| [8.0, 0.0]), None);
    let mut drift = GazeDrift::default();
    (0..60 * MINUTE_NS / FRAME_NS).for_each(|frame| drift.push(None, frame * FRAME_NS));
    assert_eq!(drift.drift_deg(), None, "eyes that fixate nothing");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn any_input_gives_no_drift_or_a_finite_one(
        samples in proptest::collection::vec(
            (proptest::option::of(proptest::array::uniform2(proptest::num::f32::ANY)), any::<i64>()), 0..6000),
    ) {
        let mut drift = GazeDrift::default();
        for (fixated, now_ns) in samples {
            drift.push(fixated, now_ns);
            prop_assert!(drift.drift_deg().is_none_or(|deg| deg.is_finite() && deg >= 2.0));
        }
    }
}
