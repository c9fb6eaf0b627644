//! Cost of `audio`.

use criterion::{Criterion, Throughput};
use parafovea_core::audio::{AudioSettings, FeatureExtractor, Mode};
use std::hint::black_box;

/// Features of 100 ms, by format; the paper's mode also has gates.
pub fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("audio features of 100 ms");
    group.throughput(Throughput::Elements(1));
    for (name, rate_hz, channels, mode) in [
        ("stereo 48 kHz", 48_000, 2, Mode::Default),
        ("stereo 48 kHz, paper", 48_000, 2, Mode::Paper),
        ("mono 8 kHz", 8_000, 1, Mode::Default),
        ("7.1 192 kHz", 192_000, 8, Mode::Default),
    ] {
        let settings = AudioSettings { mode, ..AudioSettings::default() };
        let mut extractor = FeatureExtractor::new(rate_hz, channels, &settings).expect("a known format");
        let samples = noise((rate_hz / 10 * channels) as usize);
        // The windows are full, as they are in a session.
        for _ in 0..40 {
            extractor.push(&samples, |_| {});
        }
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut last = None;
                extractor.push(black_box(&samples), |features| last = Some(features));
                last
            });
        });
    }
    group.finish();
}

/// White noise of -20 dB, the same each time.
fn noise(length: usize) -> Vec<f32> {
    let mut state = 1u32;
    (0..length)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state as i32 as f32 / i32::MAX as f32 * 0.1
        })
        .collect()
}
