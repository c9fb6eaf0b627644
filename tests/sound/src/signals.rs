//! Sounds of known loudness: the same in every run.

use parafovea_core::audio::{AudioFeatures, AudioSettings, FeatureExtractor, Mode};
use std::f64::consts::TAU;

/// Channels of every sound here: left and right, alike but for their noise.
pub const CHANNELS: u32 = 2;

/// Kinds of sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A sine of 2 kHz.
    Tone,
    /// Noise whose power falls by 3 dB an octave.
    Pink,
    /// Noise with about the mean spectrum of a shout, flat to 2 kHz and less and less above, that comes and goes five times a
    /// second as syllables do. (That of a calm voice is below 1 kilo-mel, where the feature is limited.)
    Speech,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Tone, Self::Pink, Self::Speech];
}

/// Interleaved samples of `seconds`, which have together a gated loudness of `lufs`.
///
/// # Panics
/// Below 0.4 seconds, which have no loudness.
pub fn sound(kind: Kind, lufs: f32, sample_rate_hz: u32, seconds: f64) -> Vec<f32> {
    let frames = (seconds * f64::from(sample_rate_hz)).round() as usize;
    let mut channels = [0, 1].map(|seed| mono(kind, sample_rate_hz, frames, seed));
    let [left, right] = &mut channels;
    let mut samples: Vec<f32> = left.iter().zip(&*right).flat_map(|(left, right)| [*left, *right]).collect();
    // Once more after the first time, because of the gates.
    for _ in 0..2 {
        let gain = 10f32.powf((lufs - gated_lufs(&samples, sample_rate_hz)) / 20.0);
        samples.iter_mut().for_each(|sample| *sample *= gain);
    }
    samples
}

/// The features of interleaved samples, every 100 ms.
///
/// # Panics
/// For a sample rate that is not understood.
pub fn features(samples: &[f32], sample_rate_hz: u32, settings: &AudioSettings) -> Vec<AudioFeatures> {
    let mut all = Vec::new();
    let extractor = FeatureExtractor::new(sample_rate_hz, CHANNELS, settings);
    extractor.expect("a sample rate that is understood").push(samples, |features| all.push(features));
    all
}

fn gated_lufs(samples: &[f32], sample_rate_hz: u32) -> f32 {
    let settings = AudioSettings { mode: Mode::Paper, window_s: 120.0, ..AudioSettings::default() };
    features(samples, sample_rate_hz, &settings).last().expect("at least 0.4 s").loudness_lufs
}

fn mono(kind: Kind, sample_rate_hz: u32, frames: usize, seed: u64) -> Vec<f32> {
    let rate = f64::from(sample_rate_hz);
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15 ^ (seed << 32 | 1));
    let mut filter = Filter::default();
    let sample = |n: usize| {
        let time = n as f64 / rate;
        match kind {
            Kind::Tone => (TAU * 2000.0 * time).sin(),
            Kind::Pink => filter.pink(noise.next()),
            Kind::Speech => {
                let syllable = 0.5 - 0.5 * (TAU * 5.0 * time).cos();
                filter.speech(noise.next(), rate) * syllable
            }
        }
    };
    (0..frames).map(sample).map(|sample| 0.1 * sample as f32).collect()
}

/// White noise (xorshift64*).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[derive(Default)]
struct Filter([f64; 3]);

impl Filter {
    /// Three poles whose sum falls by about 3 dB an octave (Paul Kellet's economy filter for pink noise).
    fn pink(&mut self, white: f64) -> f64 {
        let [a, b, c] = &mut self.0;
        *a = 0.99765 * *a + white * 0.099_046;
        *b = 0.96300 * *b + white * 0.296_516_4;
        *c = 0.57000 * *c + white * 1.052_691_3;
        *a + *b + *c + white * 0.1848
    }

    /// The mean of one and of two poles at 2 kHz.
    fn speech(&mut self, white: f64, rate: f64) -> f64 {
        let share = 1.0 - (-TAU * 2000.0 / rate).exp();
        let [a, b, _] = &mut self.0;
        *a += share * (white - *a);
        *b += share * (*a - *b);
        0.5 * (*a + *b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sound_is_as_loud_as_asked_for() {
        for kind in Kind::ALL {
            for lufs in [-35.0, -10.0] {
                let samples = sound(kind, lufs, 48_000, 3.5);
                let loudness = gated_lufs(&samples, 48_000);
                assert!((loudness - lufs).abs() < 0.05, "{kind:?}: {loudness} instead of {lufs}");
                assert_eq!(samples.len(), 2 * 168_000);
            }
        }
    }
}
