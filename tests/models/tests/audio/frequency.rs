//! The mel feature of known signals, against the mel scale.

use super::tone::tones;
use super::{last, paper};
use parafovea_core::audio::{AudioFeatures, AudioSettings, GREATEST_KILOMEL, LEAST_KILOMEL, mel_of_hz};
use std::f64::consts::TAU;

#[test]
fn a_tone_has_its_mel() {
    for (rate_hz, channels) in [(8_000, 1), (16_000, 2), (44_100, 2), (48_000, 1), (192_000, 2)] {
        for hz in [1200.0, 2000.0, 3000.0] {
            let samples = tones(rate_hz, hz, &[(1.0, &vec![-20.0; channels])]);
            let kilomel = last(rate_hz, channels as u32, &paper(3.0), &samples).gamma_fq_kilomel;
            let expected = mel_of_hz(hz) as f32 / 1000.0;
            assert!((kilomel - expected).abs() < 0.005, "{hz} Hz at {rate_hz} Hz: {kilomel} kilo-mel");
        }
    }
}

#[test]
fn low_and_high_tones_are_at_the_ends() {
    for (hz, expected) in [(50.0, LEAST_KILOMEL), (900.0, LEAST_KILOMEL), (8000.0, GREATEST_KILOMEL)] {
        let samples = tones(48_000, hz, &[(1.0, &[-20.0])]);
        assert_eq!(last(48_000, 1, &paper(3.0), &samples).gamma_fq_kilomel, expected, "{hz} Hz");
    }
}

/// Channels do not cancel, as they would in a sum.
#[test]
fn opposite_phases_are_heard() {
    let stereo: Vec<f32> =
        tones(48_000, 2000.0, &[(1.0, &[-20.0])]).into_iter().flat_map(|left| [left, -left]).collect();
    let kilomel = last(48_000, 2, &paper(3.0), &stereo).gamma_fq_kilomel;
    assert!((kilomel - mel_of_hz(2000.0) as f32 / 1000.0).abs() < 0.005, "{kilomel}");
}

/// Equal power in each ratio of frequencies from 20 Hz to 20 kHz: the mean of the mel over log f, 1.1749 kilo-mel.
#[test]
fn pink_noise() {
    const TONES: u32 = 400;
    let rate_hz = 48_000;
    let mut samples = vec![0.0; rate_hz as usize];
    let (mut expected, share) = (0.0, 1.0 / f64::from(TONES));
    for tone in 0..TONES {
        let hz = 20.0 * 1000f64.powf((f64::from(tone) + 0.5) * share);
        expected += mel_of_hz(hz) * share / 1000.0;
        // The golden ratio spreads the phases.
        let phase = 0.618_033_988_749_895 * f64::from(tone);
        for (n, sample) in samples.iter_mut().enumerate() {
            *sample += (0.01 * (TAU * (hz * n as f64 / f64::from(rate_hz) + phase)).sin()) as f32;
        }
    }
    assert!((expected - 1.1749).abs() < 1e-3, "{expected}");
    let kilomel = last(rate_hz, 1, &paper(3.0), &samples).gamma_fq_kilomel;
    // A second holds only twenty periods of the lowest: one draw differs that much.
    assert!((f64::from(kilomel) - expected).abs() < 0.07, "{kilomel} instead of {expected}");
}

#[test]
fn silence_and_a_constant_are_silent() {
    for level in [0.0, 1e-30, 0.5, -1.0] {
        // 3 s after it began, which is a step that can be heard.
        for settings in [AudioSettings::default(), paper(1.0)] {
            assert_eq!(
                last(48_000, 1, &settings, &vec![level; 4 * 48_000]),
                AudioFeatures::SILENT,
                "{level}"
            );
        }
    }
}

/// A constant shifts no pitch: it is not heard.
#[test]
fn a_constant_below_a_tone_changes_nothing() {
    let tone = tones(48_000, 2000.0, &[(2.0, &[-40.0])]);
    let shifted: Vec<f32> = tone.iter().map(|sample| sample + 0.5).collect();
    let clip = paper(1.0);
    let (alone, shifted) = (last(48_000, 1, &clip, &tone), last(48_000, 1, &clip, &shifted));
    assert!((alone.gamma_fq_kilomel - shifted.gamma_fq_kilomel).abs() < 1e-3, "{shifted:?}");
    assert!((alone.loudness_lufs - shifted.loudness_lufs).abs() < 1e-3, "{shifted:?}");
}
