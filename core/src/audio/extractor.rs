//! From samples, in portions of any size, to features.

use super::loudness::{ABSOLUTE_GATE_LUFS, BLOCK_HOPS, Loudness};
use super::mel::{BANDS, FilterBank};
use super::spectrum::Spectrum;
use super::{AudioFeatures, AudioSettings, Mode, channels, gamma_fq, gamma_ld};
use std::collections::VecDeque;
use std::ops::RangeInclusive;
use thiserror::Error;

/// T_s of paper A's Algorithm 1: interval of features, seconds; rounded down to whole frames.
pub const INTERVAL_S: f32 = 0.1;

/// Sample rates that are understood, hertz.
pub const SAMPLE_RATES_HZ: RangeInclusive<u32> = 8_000..=192_000;

/// Greatest number of channels that are understood.
pub const MAX_CHANNELS: u32 = 8;

/// Greatest sample, of full scale 1: 24 dB above it. Beyond, a sample is limited.
const GREATEST_SAMPLE: f32 = 16.0;

/// Least sample, -300 dB: samples closer to 0 count as 0. It is inaudible, and its square would be denormal.
const LEAST_SAMPLE: f32 = 1e-15;

/// Reason why there are no features of a stream.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum FormatError {
    /// Not within [`SAMPLE_RATES_HZ`].
    #[error("a sample rate of {0} Hz is not within 8000..=192000 Hz")]
    SampleRate(u32),
    /// Not within 1..=[`MAX_CHANNELS`].
    #[error("{0} channels are not within 1..=8")]
    Channels(u32),
    /// The loudness meter refused a format within both ranges.
    #[error("the loudness meter refused the format: {0}")]
    Meter(#[from] ebur128::Error),
}

/// Whether a stream has features, by its frames a second and its interleaved channels.
///
/// # Errors
/// Where the sample rate is not within [`SAMPLE_RATES_HZ`] or the channels not within 1..=[`MAX_CHANNELS`].
pub fn check_format(sample_rate_hz: u32, channels: u32) -> Result<(), FormatError> {
    if !SAMPLE_RATES_HZ.contains(&sample_rate_hz) {
        return Err(FormatError::SampleRate(sample_rate_hz));
    }
    channels::positions(channels).map(drop).ok_or(FormatError::Channels(channels))
}

/// Extracts features from a stream of samples (paper A, Algorithm 1 lines 12-15).
///
/// The features are the same, bit for bit, however the samples are divided into portions: work is done a hop of
/// 100 ms at a time. Pushing does not allocate.
pub struct FeatureExtractor {
    settings: AudioSettings,
    /// The hop that is not complete yet, interleaved.
    hop: Vec<f32>,
    hop_samples: usize,
    loudness: Loudness,
    spectrum: Spectrum,
    filters: FilterBank,
    /// Band energies of the last hops of the window, oldest first.
    bands: VecDeque<[f64; BANDS]>,
    window_hops: usize,
}

impl FeatureExtractor {
    /// An extractor before the first sample of a stream of `channels` interleaved channels, in the order that the
    /// [module](super#channels) states. Settings are [`limited`](AudioSettings::limited) first.
    ///
    /// # Errors
    /// Where the sample rate is not within [`SAMPLE_RATES_HZ`] or the channels not within 1..=[`MAX_CHANNELS`].
    pub fn new(sample_rate_hz: u32, channels: u32, settings: &AudioSettings) -> Result<Self, FormatError> {
        check_format(sample_rate_hz, channels)?;
        let positions = channels::positions(channels).ok_or(FormatError::Channels(channels))?;
        let settings = settings.limited();
        let window_hops = (settings.window_s / INTERVAL_S).round() as usize;
        let hop_frames = Loudness::hop_frames(sample_rate_hz);
        let hop_samples = hop_frames * positions.len();
        Ok(Self {
            settings,
            hop: Vec::with_capacity(hop_samples),
            hop_samples,
            loudness: Loudness::new(sample_rate_hz, positions, window_hops)?,
            spectrum: Spectrum::new(sample_rate_hz, positions, hop_frames),
            filters: FilterBank::new(sample_rate_hz, Spectrum::length(sample_rate_hz)),
            bands: VecDeque::with_capacity(window_hops),
            window_hops,
        })
    }

    /// Takes the next `samples`, of full scale 1, in portions of any size (a frame may be divided), and hands a set of
    /// features to `emit` for each [`INTERVAL_S`] that they complete.
    ///
    /// A NaN or infinite sample counts as 0; one beyond 16 (24 dB above full scale) is limited to that; one below
    /// 1e-15 (-300 dB), and so every denormal one, counts as 0.
    pub fn push(&mut self, mut samples: &[f32], mut emit: impl FnMut(AudioFeatures)) {
        while !samples.is_empty() {
            let missing = self.hop_samples - self.hop.len();
            let (now, later) = samples.split_at(missing.min(samples.len()));
            self.hop.extend(now.iter().map(|&sample| limited(sample)));
            samples = later;
            if self.hop.len() == self.hop_samples {
                self.finish_hop();
                emit(self.features());
            }
        }
    }

    /// The loudness up to the last features.
    pub fn loudness(&self) -> &Loudness {
        &self.loudness
    }

    fn finish_hop(&mut self) {
        self.loudness.push_hop(&self.hop);
        let power = self.spectrum.push_hop(&self.hop, self.filters.heard_bins());
        if self.bands.len() == self.window_hops {
            self.bands.pop_front();
        }
        self.bands.push_back(self.filters.energies(power));
        self.hop.clear();
    }

    fn features(&self) -> AudioFeatures {
        let loudness = match self.settings.mode {
            Mode::Default => self.loudness.momentary().min(self.loudness.short_term()),
            Mode::Paper => self.loudness.gated(),
        };
        // The gated loudness is the mean of blocks above the gate; only ungated values can be below.
        if loudness < ABSOLUTE_GATE_LUFS {
            return AudioFeatures::SILENT;
        }
        let clip = self.mean_mel(self.window_hops);
        let mean_mel = match self.settings.mode {
            Mode::Default => clip.zip(self.mean_mel(BLOCK_HOPS)).map(|(clip, last)| clip.max(last)),
            Mode::Paper => clip,
        };
        let loudness_lufs = loudness as f32;
        AudioFeatures {
            loudness_lufs,
            gamma_ld: gamma_ld(loudness_lufs, &self.settings),
            gamma_fq_kilomel: gamma_fq(mean_mel),
            silent: false,
        }
    }

    /// Weighted mean of the band centres over the last `hops`, mel; `None` without energy.
    fn mean_mel(&self, hops: usize) -> Option<f64> {
        let mut energies = [0.0; BANDS];
        for hop in self.bands.iter().rev().take(hops) {
            for (sum, energy) in energies.iter_mut().zip(hop) {
                *sum += energy;
            }
        }
        self.filters.mean_mel(&energies)
    }
}

/// A sample within the limits: see [`FeatureExtractor::push`].
fn limited(sample: f32) -> f32 {
    let magnitude = sample.abs();
    if magnitude >= LEAST_SAMPLE && magnitude.is_finite() {
        sample.clamp(-GREATEST_SAMPLE, GREATEST_SAMPLE)
    } else {
        0.0
    }
}
