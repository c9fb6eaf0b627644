//! Loudness and mel feature: BS.1770-4, EBU Tech 3341, and the numbers of paper A.

#[path = "audio/allocations.rs"]
mod allocations;
#[path = "audio/bs_1770.rs"]
mod bs_1770;
#[path = "audio/ebu_tech_3341.rs"]
mod ebu_tech_3341;
#[path = "audio/frequency.rs"]
mod frequency;
#[path = "audio/tone.rs"]
mod tone;

use parafovea_core::audio::{AudioFeatures, AudioSettings, FeatureExtractor, Loudness, Mode};

/// Paper A's mode over `window_s`.
fn paper(window_s: f32) -> AudioSettings {
    AudioSettings { mode: Mode::Paper, window_s, ..AudioSettings::default() }
}

/// The features after the last hop.
fn last(rate_hz: u32, channels: u32, settings: &AudioSettings, samples: &[f32]) -> AudioFeatures {
    let mut last = None;
    let mut extractor = FeatureExtractor::new(rate_hz, channels, settings).expect("a known format");
    extractor.push(samples, |features| last = Some(features));
    last.expect("at least 100 ms")
}

/// Values of `read` after each hop.
fn readings(rate_hz: u32, channels: u32, samples: &[f32], read: impl Fn(&Loudness) -> f64) -> Vec<f64> {
    let mut extractor =
        FeatureExtractor::new(rate_hz, channels, &AudioSettings::default()).expect("a known format");
    samples
        .chunks_exact((rate_hz / 10 * channels) as usize)
        .map(|hop| {
            extractor.push(hop, |_| {});
            read(extractor.loudness())
        })
        .collect()
}
