//! The test signals of EBU Tech 3341 (version 4.0, Table 1), cases 1-6 and 9-14, made here; 7 and 8 are recordings, 15 on
//! are about true peak. All are sines of 1000 Hz at 48 kHz; M is momentary, S short-term, I integrated (gated).

use super::tone::{Part, SILENCE, tones};
use super::{paper, readings};
use parafovea_core::audio::{FeatureExtractor, Loudness};

const RATE_HZ: u32 = 48_000;

/// As Tech 3341 has it.
const TOLERANCE_LU: f64 = 0.1;

/// One level in both channels.
fn stereo(parts: &[(f64, f64)]) -> Vec<f32> {
    let levels: Vec<[f64; 2]> = parts.iter().map(|&(_, level)| [level; 2]).collect();
    let parts: Vec<Part<'_>> =
        parts.iter().zip(&levels).map(|(&(seconds, _), level)| (seconds, level.as_slice())).collect();
    tones(RATE_HZ, 1000.0, &parts)
}

/// Gated loudness of all of `samples`, in the paper's mode with a window that holds them.
fn integrated(channels: u32, samples: &[f32]) -> f64 {
    let mut extractor = FeatureExtractor::new(RATE_HZ, channels, &paper(120.0)).expect("a known format");
    let mut lufs = f64::NAN;
    extractor.push(samples, |features| lufs = f64::from(features.loudness_lufs));
    lufs
}

#[track_caller]
fn assert_lufs(measured: f64, expected: f64) {
    assert!((measured - expected).abs() <= TOLERANCE_LU, "{measured} LUFS instead of {expected}");
}

fn greatest(readings: &[f64]) -> f64 {
    readings.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn cases_1_and_2_a_steady_tone() {
    for level in [-23.0, -33.0] {
        let samples = stereo(&[(20.0, level)]);
        assert_lufs(integrated(2, &samples), level);
        for read in [Loudness::momentary, Loudness::short_term] {
            for reading in &readings(RATE_HZ, 2, &samples, read)[29..] {
                assert_lufs(*reading, level);
            }
        }
    }
}

#[test]
fn case_3_the_relative_gate() {
    let samples = stereo(&[(10.0, -36.0), (60.0, -23.0), (10.0, -36.0)]);
    assert_lufs(integrated(2, &samples), -23.0);
}

#[test]
fn case_4_both_gates() {
    let samples = stereo(&[(10.0, -72.0), (10.0, -36.0), (60.0, -23.0), (10.0, -36.0), (10.0, -72.0)]);
    assert_lufs(integrated(2, &samples), -23.0);
}

#[test]
fn case_5_levels_above_the_gates() {
    let samples = stereo(&[(20.0, -26.0), (20.1, -20.0), (20.0, -26.0)]);
    assert_lufs(integrated(2, &samples), -23.0);
}

#[test]
fn case_6_surround() {
    let five = [-28.0, -28.0, -24.0, -30.0, -30.0];
    assert_lufs(integrated(5, &tones(RATE_HZ, 1000.0, &[(20.0, &five)])), -23.0);
    let with_lfe = [-28.0, -28.0, -24.0, SILENCE, -30.0, -30.0];
    assert_lufs(integrated(6, &tones(RATE_HZ, 1000.0, &[(20.0, &with_lfe)])), -23.0);
}

#[test]
fn case_9_short_term_window() {
    let samples = stereo(&[(1.34, -20.0), (1.66, -30.0)].repeat(5));
    for reading in &readings(RATE_HZ, 2, &samples, Loudness::short_term)[29..] {
        assert_lufs(*reading, -23.0);
    }
}

#[test]
fn case_10_greatest_short_term_of_files() {
    for file in 0..20 {
        let samples = stereo(&[(0.15 * f64::from(file), SILENCE), (3.0, -23.0), (1.0, SILENCE)]);
        assert_lufs(greatest(&readings(RATE_HZ, 2, &samples, Loudness::short_term)), -23.0);
    }
}

#[test]
fn case_11_greatest_short_term_live() {
    let mut samples = Vec::new();
    for segment in 0..20 {
        let delay_s = 0.15 * f64::from(segment);
        let level = -38.0 + f64::from(segment);
        samples.extend(stereo(&[(delay_s, SILENCE), (3.0, level), (3.0 - delay_s, SILENCE)]));
    }
    let readings = readings(RATE_HZ, 2, &samples, Loudness::short_term);
    for (segment, readings) in readings.chunks_exact(60).enumerate() {
        assert_lufs(greatest(readings), -38.0 + segment as f64);
    }
}

#[test]
fn case_12_momentary_window() {
    let samples = stereo(&[(0.18, -20.0), (0.22, -30.0)].repeat(25));
    for reading in &readings(RATE_HZ, 2, &samples, Loudness::momentary)[9..] {
        assert_lufs(*reading, -23.0);
    }
}

/// Momentary loudness every 20 ms, as the two cases below require with their delays of 20 ms: the readings of five
/// meters, each started 20 ms after the one before. The readings of one alone, every 100 ms, are up to 0.6 LU lower.
fn dense_momentary(samples: &[f32]) -> Vec<f64> {
    let mut dense = Vec::new();
    for phase in 0..5 {
        let mut delayed = stereo(&[(0.02 * f64::from(phase), SILENCE)]);
        delayed.extend(samples);
        let of_meter = readings(RATE_HZ, 2, &delayed, Loudness::momentary);
        dense.extend(
            of_meter.into_iter().enumerate().map(|(hop, lufs)| (5 * (hop + 1) - phase as usize, lufs)),
        );
    }
    dense.sort_by_key(|&(at, _)| at);
    dense.into_iter().map(|(_, lufs)| lufs).collect()
}

#[test]
fn case_13_greatest_momentary_of_files() {
    for file in 0..20 {
        let samples = stereo(&[(0.02 * f64::from(file), SILENCE), (0.4, -23.0), (1.0, SILENCE)]);
        assert_lufs(greatest(&dense_momentary(&samples)), -23.0);
        let every_hop = greatest(&readings(RATE_HZ, 2, &samples, Loudness::momentary));
        assert!((-23.7..-22.9).contains(&every_hop), "{every_hop} LUFS");
    }
}

#[test]
fn case_14_greatest_momentary_live() {
    let mut samples = Vec::new();
    for segment in 0..20 {
        let delay_s = 0.02 * f64::from(segment);
        let level = -38.0 + f64::from(segment);
        samples.extend(stereo(&[(delay_s, SILENCE), (0.4, level), (0.4 - delay_s, SILENCE)]));
    }
    // A segment of 0.8 s has 40 readings; the readings of its tone's end belong to it.
    for (segment, readings) in dense_momentary(&samples).chunks_exact(40).enumerate() {
        assert_lufs(greatest(readings), -38.0 + segment as f64);
    }
}
