//! Noise of trackers, and the rates and times of their samples.

use super::*;

/// From the eye to the frame.
const LATENCY: i64 = 50 * MS;

/// Random numbers, the same in each run.
struct Random(u32);

impl Random {
    /// Evenly spread from 0 to 1.
    fn uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }

    /// Nearly normal around 0, of this standard deviation: four together have a variance of 1/3.
    fn normal(&mut self, deviation: f32) -> f32 {
        let sum = (0..4).map(|_| self.uniform() - 0.5).sum::<f32>();
        sum * deviation * 3f32.sqrt()
    }
}

/// Share of false saccades and pursuits of resting eyes, and the greatest error of the gaze, degrees: 2000 samples with noise of `noise_deg`, one
/// each `step_ms`, without the first 200.
fn at_rest(noise_deg: f32, step_ms: i64) -> (f32, f32) {
    let (mut tracker, mut random) = (GazeTracker::new(GazeSettings::default()), Random(1));
    let (mut alarms, mut worst_deg) = (0, 0.0f32);
    for number in 0..2000i64 {
        let time = 1000 * MS + number * step_ms * MS;
        tracker.push_at(&sample(random.normal(noise_deg), time), time + LATENCY);
        let state = tracker.state(time + LATENCY);
        if number > 200 {
            alarms += u32::from(matches!(state.phase, GazePhase::Saccade | GazePhase::Pursuit));
            worst_deg = worst_deg.max(eccentricity(state.directions[0], yaw(0.0)).to_degrees());
        }
    }
    (alarms as f32 / 1800.0, worst_deg)
}

#[test]
fn a_noisy_tracker_is_in_no_saccade_and_follows_nothing_at_rest() {
    // Its noise is measured within a second.
    let (alarms, worst_deg) = at_rest(0.6, 8);
    assert!(alarms < 0.01 && worst_deg < 1.2, "{alarms}, {worst_deg} degrees");
}

/// Each frame takes one sample: a game at half the rate of its display has few.
#[test]
fn noise_is_measured_at_low_rates_too() {
    for step_ms in [28, 33] {
        let (alarms, worst_deg) = at_rest(0.8, step_ms);
        assert!(alarms < 0.01 && worst_deg < 4.0, "{step_ms} ms: {alarms}, {worst_deg} degrees");
    }
}

#[test]
fn two_samples_at_almost_the_same_time_are_no_pursuit() {
    for count in [7, 18, 40] {
        let mut tracker = GazeTracker::new(GazeSettings::default());
        let mut time = 1000 * MS;
        for _ in 0..count {
            time += 8_333_333;
            tracker.push_at(&sample(0.0, time), time + LATENCY);
        }
        time += 600_000;
        tracker.push_at(&sample(0.6, time), time + LATENCY);
        let state = tracker.state(time + LATENCY);
        assert_ne!(state.phase, GazePhase::Pursuit, "after {count}");
        assert!(eccentricity(state.directions[0], yaw(0.0)).to_degrees() < 0.6, "after {count}: {state:?}");
    }
}

/// OSC packets carry no time: they count from their arrival, which network and threads delay.
#[test]
fn samples_that_arrive_unevenly_are_no_pursuit() {
    for (hz, delay_ms) in [(90.0, 5.0), (90.0, 8.0), (120.0, 5.0)] {
        let (mut tracker, mut random) = (GazeTracker::new(GazeSettings::default()), Random(7));
        let (mut pursuits, mut newest) = (0, 0);
        for number in 0..4000 {
            let delay_ms = -delay_ms * (1.0 - random.uniform()).max(1e-4).ln();
            let arrival = 1000 * MS + ((number as f32 * 1e3 / hz + delay_ms) as f64 * 1e6) as i64;
            let gaze = random.normal(0.3);
            if arrival - newest < MS / 2 {
                continue;
            }
            newest = arrival;
            tracker.push_at(&sample(gaze, arrival), arrival + LATENCY);
            let phase = tracker.state(arrival + LATENCY).phase;
            pursuits += u32::from(number > 200 && phase == GazePhase::Pursuit);
        }
        assert!(pursuits < 19, "{hz} Hz, {delay_ms} ms: {pursuits} of 3800");
    }
}

/// Without a hold, a gaze is lost when the eyes count as unseen, and not between two samples.
#[test]
fn a_steady_gaze_without_hold_is_not_lost_between_samples() {
    let mut tracker = GazeTracker::new(GazeSettings { hold_ms: 0.0, ..GazeSettings::default() });
    let (mut time, mut now) = (1000 * MS, 1000 * MS + LATENCY);
    for _ in 0..200 {
        now += 11_111_111;
        while time + 16_666_667 + LATENCY <= now {
            time += 16_666_667;
            tracker.push_at(&sample(3.0, time), time + LATENCY);
        }
        let state = tracker.state(now);
        if time > 2000 * MS {
            assert_eq!((state.phase, state.trust), (GazePhase::Fixation, 1.0));
        }
    }
    tracker.push_at(&sample(3.0, time - MS), now);
    assert_eq!(tracker.rejection(), Some(Rejection::OutOfOrder));
    assert_eq!(tracker.state(now).trust, 1.0);
    assert_eq!(tracker.state(now + 200 * MS).phase, GazePhase::Lost);
}
