use super::*;
use proptest::prelude::*;

const MS: i64 = 1_000_000;
const FRAME_NS: i64 = 11_111_111;

/// The gaze of a simulated viewer, degrees, each millisecond: fixations of 150 to 450 ms, saccades of the main sequence between them.
struct Viewer {
    state: u64,
    path: Vec<[f32; 2]>,
}

impl Viewer {
    /// `reach_deg`: saccades lead to within so many degrees of the middle; 0: there is one fixation.
    fn new(seed: u64, seconds: usize, reach_deg: f32) -> Self {
        let mut viewer = Self { state: seed ^ 0x1234_5678, path: Vec::new() };
        let mut at = [0.0; 2];
        while viewer.path.len() < seconds * 1000 {
            let rest = 150 + (viewer.uniform() * 300.0) as usize;
            viewer.path.extend(std::iter::repeat_n(at, rest));
            let to = [0, 1].map(|_| reach_deg * (2.0 * viewer.uniform() - 1.0));
            let steps = 21.0 + 2.2 * (to[0] - at[0]).hypot(to[1] - at[1]);
            viewer.path.extend((0..steps as usize).map(|step| {
                let share = 0.5 - 0.5 * (std::f32::consts::PI * step as f32 / steps).cos();
                [0, 1].map(|axis| at[axis] + share * (to[axis] - at[axis]))
            }));
            at = to;
        }
        viewer
    }

    /// Uniform within 0..1 (SplitMix64).
    fn uniform(&mut self) -> f32 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    fn noise(&mut self, deg: f32) -> [f32; 2] {
        [0, 1].map(|_| deg * ((0..12).map(|_| self.uniform()).sum::<f32>() - 6.0))
    }

    /// Samples at a rate, each so much later than the gaze that it is of.
    fn samples(&mut self, rate_hz: i64, delay_ms: usize, noise_deg: f32) -> Vec<TimedGaze> {
        let period_ns = 1_000_000_000 / rate_hz;
        let count = self.path.len() as i64 * MS / period_ns;
        let sample = |at: i64| {
            let gaze = self.path[((at * period_ns / MS) as usize).saturating_sub(delay_ms)];
            let noise = self.noise(noise_deg);
            ([gaze[0] + noise[0], gaze[1] + noise[1]], at * period_ns)
        };
        (0..count).map(sample).collect()
    }
}

/// The estimate at the end of frames that take the newest samples of both sources; `is_seen`: whether the eyes are tracked, by the time of the frame.
fn estimate(dated: &[TimedGaze], late: &[TimedGaze], is_seen: impl Fn(i64) -> bool) -> Option<f32> {
    let mut delay = GazeDelay::default();
    let end = dated.last().unwrap().1.min(late.last().unwrap().1);
    let newest = |samples: &[TimedGaze], now_ns| {
        let after = samples.partition_point(|(_, time_ns)| *time_ns <= now_ns);
        after.checked_sub(1).map(|at| samples[at]).filter(|_| is_seen(now_ns))
    };
    for now_ns in (0..end / FRAME_NS).map(|frame| frame * FRAME_NS) {
        delay.push(newest(dated, now_ns), newest(late, now_ns));
    }
    delay.delay_ms()
}

#[test]
fn a_known_delay_is_found_at_every_rate() {
    for (seed, rate_hz, delay_ms) in
        [(1, 20, 40), (2, 20, 80), (3, 60, 25), (4, 60, 120), (5, 120, 70), (6, 240, 300)]
    {
        let mut viewer = Viewer::new(seed, 30, 15.0);
        let (dated, late) = (viewer.samples(120, 0, 0.3), viewer.samples(rate_hz, delay_ms, 0.5));
        let found = estimate(&dated, &late, |_| true);
        let error = found.map(|found| (found - delay_ms as f32).abs());
        // Half a period of 60 Hz.
        assert!(error.is_some_and(|error| error < 8.0), "{rate_hz} Hz, {delay_ms} ms: {found:?}");
    }
}

#[test]
fn blinks_leave_the_delay_as_it_is() {
    let mut viewer = Viewer::new(7, 60, 15.0);
    let (dated, late) = (viewer.samples(120, 0, 0.3), viewer.samples(60, 60, 0.5));
    let found = estimate(&dated, &late, |now_ns| now_ns / MS % 4000 > 300);
    assert!(found.is_some_and(|found| (found - 60.0).abs() < 8.0), "{found:?}");
}

#[test]
fn a_gaze_that_rests_tells_no_delay() {
    for noise_deg in [0.0, 0.3, 2.0] {
        let mut viewer = Viewer::new(8, 300, 0.0);
        let (dated, late) = (viewer.samples(120, 0, noise_deg), viewer.samples(60, 60, noise_deg));
        assert_eq!(estimate(&dated, &late, |_| true), None, "{noise_deg}");
    }
}

#[test]
fn eyes_of_two_people_and_moves_that_repeat_have_no_delay() {
    let (mut viewer, mut other) = (Viewer::new(9, 120, 15.0), Viewer::new(10, 120, 15.0));
    assert_eq!(estimate(&viewer.samples(120, 0, 0.3), &other.samples(60, 60, 0.3), |_| true), None);
    let mut swinging = Viewer::new(11, 1, 0.0);
    swinging.path = (0..120_000).map(|ms| [20.0 * (ms as f32 * 0.031).sin(), 0.0]).collect();
    assert_eq!(estimate(&swinging.samples(120, 0, 0.1), &swinging.samples(120, 60, 0.1), |_| true), None);
}

#[test]
fn a_newer_measurement_replaces_the_one_before_and_a_rest_does_not() {
    let mut viewer = Viewer::new(12, 30, 15.0);
    let mut delay = GazeDelay::default();
    let mut play = |delay_ms, begin_ns| {
        let (dated, late) = (viewer.samples(90, 0, 0.3), viewer.samples(90, delay_ms, 0.3));
        for (dated, late) in dated.into_iter().zip(late) {
            let after = |(angles, time_ns)| Some((angles, time_ns + begin_ns));
            delay.push(after(dated), after(late));
        }
        delay.delay_ms().unwrap()
    };
    assert!((play(40, 0) - 40.0).abs() < 8.0);
    assert!((play(100, 31_000 * MS) - 100.0).abs() < 8.0);
    for frame in 0..20_000 {
        let at = Some(([0.0; 2], (70_000 + 11 * frame) * MS));
        delay.push(at, at);
    }
    assert!(delay.delay_ms().is_some_and(|known| (known - 100.0).abs() < 8.0));
    // The clock began again: a new session.
    delay.push(Some(([0.0; 2], 0)), Some(([0.0; 2], 0)));
    assert_eq!(delay.delay_ms(), None);
}

proptest! {
    #[test]
    fn no_sample_is_an_error(samples in prop::collection::vec((any::<f32>(), any::<i64>(), any::<bool>()), 0..60)) {
        let mut delay = GazeDelay::default();
        for (angle, time_ns, is_dated) in samples {
            let sample = Some(([angle, 1.0], time_ns));
            if is_dated { delay.push(sample, None) } else { delay.push(None, sample) }
        }
        prop_assert_eq!(delay.delay_ms(), None);
    }
}
