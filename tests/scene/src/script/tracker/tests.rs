use super::super::Script;
use super::*;
use crate::scene::SceneName;

fn gaze() -> TrueGaze {
    Script::new(SceneName::Library).gaze
}

fn errors_deg(tracker: &Tracker, gaze: &TrueGaze, at: impl Fn(f64) -> f64) -> Vec<f32> {
    tracker
        .samples(gaze)
        .iter()
        .map(|sample| sample.direction().angle_between(gaze.at(at(sample.t)).direction).to_degrees())
        .collect()
}

#[test]
fn an_ideal_tracker_tells_the_truth() {
    let gaze = gaze();
    let worst = errors_deg(&Tracker::IDEAL, &gaze, |t| t).into_iter().fold(0.0, f32::max);
    assert!(worst < 0.06, "{worst} degrees");
    assert!(Tracker::IDEAL.samples(&gaze).iter().all(|sample| sample.tracked));
}

/// A tracker with a delay alone reports an earlier truth, which in saccades is far from the present one.
#[test]
fn delay_shifts() {
    let gaze = gaze();
    let late = Tracker { delay_ms: 100.0, ..Tracker::IDEAL };
    let then = errors_deg(&late, &gaze, |t| t - 0.1).into_iter().fold(0.0, f32::max);
    let now = errors_deg(&late, &gaze, |t| t).into_iter().fold(0.0, f32::max);
    assert!(then < 0.06 && now > 5.0, "{then} degrees from the past, {now} from the present");
}

#[test]
fn bias_and_noise_are_as_large_as_stated() {
    let gaze = gaze();
    let biased = Tracker { bias_deg: 1.5, ..Tracker::IDEAL };
    for error in errors_deg(&biased, &gaze, |t| t) {
        assert!((error - 1.5).abs() < 0.06, "{error}");
    }
    let noisy = Tracker { noise_deg: 0.5, ..Tracker::IDEAL };
    let errors = errors_deg(&noisy, &gaze, |t| t);
    let mean_square = errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32;
    // Two directions of variance 0.25 each.
    assert!((mean_square - 0.5).abs() < 0.04, "mean square {mean_square}");
    assert_eq!(noisy.samples(&gaze), noisy.samples(&gaze));
    assert_ne!(noisy.samples(&gaze), Tracker { seed: 9, ..noisy }.samples(&gaze));
}

/// Blinks are reported as lost, as late as everything else; the rest is tracked.
#[test]
fn blinks_are_untracked() {
    let gaze = gaze();
    for tracker in [Tracker::GOOD, Tracker::POOR] {
        let samples = tracker.samples(&gaze);
        let lost = samples.iter().filter(|sample| !sample.tracked).count();
        let shut: f64 = gaze.blinks().iter().map(|blink| blink.end - blink.start).sum();
        let expected = shut * tracker.rate_hz;
        let most = gaze.blinks().len() as f64;
        assert!((lost as f64 - expected).abs() <= most, "{lost} lost, {expected} expected");
        for sample in samples {
            assert_eq!(sample.tracked, !gaze.is_blink(sample.t - tracker.delay_ms * 1e-3));
        }
    }
}

/// Played by linear interpolation, a report stays until the next one.
#[test]
fn keyframes_hold_each_report() {
    let gaze = gaze();
    let (samples, keys) = (Tracker::POOR.samples(&gaze), Tracker::POOR.keyframes(&gaze));
    assert_eq!(samples.len(), 361);
    assert!(keys.windows(2).all(|pair| pair[0].t <= pair[1].t));
    // Frames at 90 Hz in whole nanoseconds, every third of them at the time of a report.
    for frame in 0..1000u64 {
        let t = (frame * 1_000_000_000 / 90) as f64 * 1e-9;
        // As the mock runtime looks them up: the last keyframe that is not later, and the one after it.
        let next = keys.partition_point(|key| key.t <= t);
        let (from, to) = (keys[next - 1], keys[next]);
        let report = samples[(frame / 3) as usize];
        assert_eq!(
            (from.yaw_deg, from.pitch_deg, from.tracked),
            (report.yaw_deg, report.pitch_deg, report.tracked)
        );
        assert_eq!((from.yaw_deg, from.pitch_deg), (to.yaw_deg, to.pitch_deg), "at {t}");
    }
}

#[test]
fn names() {
    assert_eq!(Tracker::named("good"), Some(Tracker::GOOD));
    assert_eq!(Tracker::named("perfect"), None);
}
