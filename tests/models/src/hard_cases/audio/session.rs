//! Cases over time: sound that stops, and a long session.

use super::Case;
use parafovea_core::audio::{AudioFeatures, AudioSettings, FeatureExtractor, Mode};
use std::f64::consts::TAU;

pub(super) fn cases() -> Vec<Case> {
    vec![stops(Mode::Default, 600), stops(Mode::Paper, 3100), ten_hours()]
}

/// Time after the end of a full-scale tone until the features equal silence's.
fn stops(mode: Mode, limit_ms: usize) -> Case {
    let settings = AudioSettings { mode, ..AudioSettings::default() };
    let mut extractor = FeatureExtractor::new(48_000, 2, &settings).expect("a known format");
    let tone: Vec<f32> = (0..4 * 48_000 + 2500)
        .map(|n| (TAU * 1000.0 * f64::from(n) / 48_000.0).sin() as f32)
        .flat_map(|sample| [sample; 2])
        .collect();
    let mut loud = AudioFeatures::SILENT;
    extractor.push(&tone, |features| loud = features);
    // The tone ends within a hop: in pieces of 1 ms.
    let ms = (1..5000).find(|_| {
        let mut silent = false;
        extractor.push(&[0.0; 96], |features| silent = features == AudioFeatures::SILENT);
        silent
    });
    Case {
        model: "loudness",
        case: format!("sound that stops after 0 dBFS, {mode:?}"),
        expected: format!("silent within {limit_ms} ms"),
        got: ms.map_or("never silent".to_owned(), |ms| format!("silent after {ms} ms")),
        error: None,
        passed: loud.gamma_ld == 25.0 && ms.is_some_and(|ms| ms <= limit_ms),
    }
}

/// A quiet tone after ten hours of noise that is full-scale and inaudible by turns, against a fresh extractor.
fn ten_hours() -> Case {
    const RATE_HZ: u32 = 8_000;
    // In samples: a common multiple of the hops and the steps of the frames.
    const TURN: usize = 6400;
    let mut state = 1u32;
    let loud: Vec<f32> = (0..TURN)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state as i32 as f32 / i32::MAX as f32
        })
        .collect();
    let inaudible: Vec<f32> = loud.iter().map(|sample| sample * 1e-7).collect();
    let end: Vec<f32> = (0..5 * RATE_HZ)
        .map(|n| 0.01 * (TAU * 1500.0 * f64::from(n) / f64::from(RATE_HZ)).sin() as f32)
        .collect();
    let after = |turns: usize| {
        let settings = AudioSettings { mode: Mode::Paper, ..AudioSettings::default() };
        let mut extractor = FeatureExtractor::new(RATE_HZ, 1, &settings).expect("a known format");
        let mut last = AudioFeatures::SILENT;
        for turn in 0..turns {
            extractor.push(if turn % 2 == 0 { &loud } else { &inaudible }, |features| last = features);
        }
        extractor.push(&end, |features| last = features);
        last
    };
    let (fresh, aged) = (after(0), after(10 * 3600 * RATE_HZ as usize / TURN));
    let error = f64::from((aged.loudness_lufs - fresh.loudness_lufs).abs())
        .max(f64::from((aged.gamma_fq_kilomel - fresh.gamma_fq_kilomel).abs()));
    Case {
        model: "loudness",
        case: "running sums after ten hours, LUFS and kilo-mel".to_owned(),
        expected: format!("{:.3}, {:.4}", fresh.loudness_lufs, fresh.gamma_fq_kilomel),
        got: format!("{:.3}, {:.4}", aged.loudness_lufs, aged.gamma_fq_kilomel),
        error: Some(error),
        passed: error <= super::TOLERANCE,
    }
}
