use super::*;
use std::f32::consts::TAU;

fn rms_of_band(frames: usize, series: impl Fn(f32) -> f32) -> f32 {
    let mut filter = BandPass::new(frames, 90.0).unwrap();
    assert!(filter.load((0..frames).map(|frame| series(frame as f32 / 90.0))));
    let power: f32 = filter.pass().map(|value| value * value).sum();
    (power / frames as f32).sqrt()
}

#[test]
fn sines_within_the_band_pass_and_others_do_not() {
    // The RMS of a sine is its amplitude over the root of two; bins are 2 Hz apart.
    let share = |hz: f32| rms_of_band(45, |s| 0.3 * (TAU * hz * s + 0.4).sin()) / 0.3 * 2f32.sqrt();
    for hz in [10.0, 13.0, 18.0, 22.5, 28.0] {
        assert!((share(hz) - 1.0).abs() < 0.01, "{hz} Hz: {}", share(hz));
    }
    for hz in [2.0, 3.0, 4.0, 34.0, 37.0, 44.0] {
        assert!(share(hz) < 0.06, "{hz} Hz: {}", share(hz));
    }
}

#[test]
fn constant_and_drifting_luminance_is_no_flicker() {
    assert!(rms_of_band(30, |_| 0.7) < 1e-6);
    // A drift by 1 over the clip.
    assert!(rms_of_band(45, |s| 0.7 - 2.0 * s) < 0.01);
}

#[test]
fn less_than_two_cycles_cannot_be_judged() {
    assert!(BandPass::new(22, 90.0).is_none() && BandPass::new(0, 90.0).is_none());
    assert!(BandPass::new(23, 90.0).is_some());
}
