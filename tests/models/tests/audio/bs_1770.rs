//! Levels of sines, channel weights and gates after BS.1770-4, and against the integrated loudness of `ebur128`.

use super::tone::{SILENCE, tones};
use super::{last, paper};
use ebur128::{EbuR128, Mode};
use parafovea_core::audio::AudioSettings;

const TOLERANCE_LU: f32 = 0.05;

#[test]
fn a_full_scale_sine_has_its_level() {
    for (hz, expected) in [
        (997.0, -3.010),
        (100.0, -4.835),
        (1000.0, -3.004),
        (2000.0, -0.630),
        (5000.0, 0.312),
        (10_000.0, 0.341),
    ] {
        let samples = tones(48_000, hz, &[(4.0, &[0.0])]);
        for settings in [AudioSettings::default(), paper(3.0)] {
            let lufs = last(48_000, 1, &settings, &samples).loudness_lufs;
            assert!((lufs - expected).abs() <= TOLERANCE_LU, "{hz} Hz, {settings:?}: {lufs} LKFS");
        }
    }
}

/// BS.1770-4 tabulates its filters for 48 kHz and asks for the same response at other rates. The bilinear transform
/// bends the shelf where half the rate is close to it.
#[test]
fn the_level_hardly_depends_on_the_sample_rate() {
    for (rate_hz, tolerance_lu) in [
        (8_000, 0.21),
        (11_025, 0.11),
        (16_000, 0.05),
        (22_050, 0.03),
        (32_000, 0.01),
        (44_100, 0.01),
        (88_200, 0.01),
        (96_000, 0.01),
        (176_400, 0.01),
        (192_000, 0.01),
    ] {
        for (hz, expected, tolerance_lu) in [(100.0, -4.835, 0.01), (997.0, -3.010, tolerance_lu)] {
            let samples = tones(rate_hz, hz, &[(4.0, &[0.0])]);
            let lufs = last(rate_hz, 1, &paper(3.0), &samples).loudness_lufs;
            assert!((lufs - expected).abs() <= tolerance_lu, "{hz} Hz at {rate_hz} Hz: {lufs} LKFS");
        }
    }
}

/// Each channel alone: 0 LU, 1.5 LU for a weight of 1.41, silence for LFE.
#[test]
fn channels_have_their_weights() {
    let surround = 10.0 * 1.41f32.log10();
    let layouts: [&[f32]; 8] = [
        &[0.0],
        &[0.0, 0.0],
        &[0.0, 0.0, 0.0],
        &[0.0, 0.0, surround, surround],
        &[0.0, 0.0, 0.0, surround, surround],
        &[0.0, 0.0, 0.0, f32::NEG_INFINITY, surround, surround],
        &[0.0, 0.0, 0.0, f32::NEG_INFINITY, 0.0, surround, surround],
        &[0.0, 0.0, 0.0, f32::NEG_INFINITY, 0.0, 0.0, surround, surround],
    ];
    for layout in layouts {
        for (channel, gain) in layout.iter().enumerate() {
            let mut levels = vec![SILENCE; layout.len()];
            levels[channel] = 0.0;
            let samples = tones(48_000, 997.0, &[(1.0, &levels)]);
            let features = last(48_000, layout.len() as u32, &paper(1.0), &samples);
            assert_eq!(features.silent, gain.is_infinite(), "channel {channel} of {}", layout.len());
            if !features.silent {
                let lufs = features.loudness_lufs;
                let expected = -3.010 + gain;
                let of = layout.len();
                assert!((lufs - expected).abs() <= TOLERANCE_LU, "channel {channel} of {of}: {lufs}");
                assert!((features.gamma_fq_kilomel - 1.0).abs() < 0.01, "heard at its pitch");
            }
        }
    }
}

/// On a signal no longer than the window, gated loudness is the integrated loudness of the crate.
#[test]
fn gated_loudness_is_the_integrated_loudness_of_the_clip() {
    let speech: &[_] = &[(0.9, [-20.0]), (0.6, [-60.0]), (0.3, [-33.0]), (0.7, [-26.0]), (0.5, [-90.0])];
    let long: &[_] = &[(7.3, [-26.0]), (11.0, [-45.0]), (0.25, [-10.0]), (9.05, [-33.1]), (2.4, [-80.0])];
    let quiet: &[_] = &[(1.0, [-75.0]), (1.0, [-60.0]), (1.0, [-67.5])];
    for (rate_hz, parts) in [(48_000, speech), (48_000, long), (48_000, quiet), (48_000, &speech[..1])] {
        let parts: Vec<(f64, &[f64])> =
            parts.iter().map(|(seconds, level)| (*seconds, level.as_slice())).collect();
        let samples = tones(rate_hz, 440.0, &parts);
        let mut meter = EbuR128::new(1, rate_hz, Mode::I).unwrap();
        meter.add_frames_f32(&samples).unwrap();
        let integrated = meter.loudness_global().unwrap() as f32;
        let gated = last(rate_hz, 1, &paper(60.0), &samples).loudness_lufs;
        assert!(gated == integrated || (gated - integrated).abs() < 1e-4, "{gated} not {integrated}");
    }
}
