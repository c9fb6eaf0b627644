//! Sound: loudness and mel feature, after "Audio-Visual Foveated Rendering" (paper A below), Eq. 1-6.
//!
//! A [`FeatureExtractor`] takes the samples as they come and answers every [`INTERVAL_S`] with [`AudioFeatures`] of
//! the last seconds. Inside, a hop of 100 ms leaves behind one energy (K-weighted, [`Loudness`]) and one energy for
//! each mel band ([`mel`], from the power spectra that [`spectrum`] adds up); both features are computed again from the
//! energies of the hops within the window, so that no sum runs over a session and no error accumulates. [`Continuity`]
//! and [`AudioFeatures::relied_on`] limit the part of the features that a plan may use.
//!
//! # Channels
//! Interleaved, in the order of WAVE_FORMAT_EXTENSIBLE; weights of BS.1770-4, Table 4, for loudness and spectrum alike:
//!
//! | channels | order | weights |
//! |---|---|---|
//! | 1 | mono | 1, counted once |
//! | 2, 3 | L R, L R C | 1 |
//! | 4, 5 | L R Ls Rs, L R C Ls Rs | 1.41 for Ls and Rs |
//! | 6 | L R C LFE Ls Rs | 0 for LFE, 1.41 for Ls and Rs |
//! | 7 | L R C LFE, back, side L R | 0 for LFE, 1.41 for the sides |
//! | 8 | L R C LFE, back L R, side L R | 0 for LFE, 1.41 for the sides |

mod channels;
mod extractor;
mod features;
mod loudness;
mod mel;
mod spectrum;
mod trust;

pub use extractor::{FeatureExtractor, FormatError, INTERVAL_S, MAX_CHANNELS, SAMPLE_RATES_HZ, check_format};
pub use features::AudioFeatures;
pub use loudness::Loudness;
pub use mel::{BANDS, FilterBank, GREATEST_KILOMEL, LEAST_KILOMEL, gamma_fq, hz_of_mel, mel_of_hz};
pub use trust::Continuity;

use crate::range::within;

/// Summary of the window T_a (`audio.mode`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The more careful choice: the lower loudness, and the higher frequency, of the last 400 ms (momentary, EBU Tech 3341)
    /// and of all of T_a (with 3 s: short-term, EBU Tech 3341). Both follow at once when sound stops or rises in
    /// pitch, and take T_a when it starts or falls.
    #[default]
    Default,
    /// Paper A: the gated loudness of BS.1770-4 of the clip T_a (400 ms blocks that overlap by 75 %, absolute gate of
    /// -70 LKFS, relative gate of -10 LU), and the frequency of the clip. Keeps its loudness for almost T_a after
    /// sound stops, because the gates leave silence out.
    Paper,
}

/// The options of the audio features, one for each key under `audio.` of the configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AudioSettings {
    /// `audio.mode`.
    pub mode: Mode,
    /// `audio.window_s`: T_a of paper A's Algorithm 1, seconds, 0.4..=120, rounded to 100 ms. The paper gives no
    /// length; BS.1770-4 needs 400 ms, short-term loudness has 3 s.
    pub window_s: f32,
    /// `audio.least_lufs`: ITU_min of Eq. 1, LUFS, -70..=0. BS.1770-4 has none but its gate at -70, which would leave
    /// the scale of the paper's scores; -35 is where its study begins.
    pub least_lufs: f32,
    /// `audio.greatest_lufs`: ITU_max of Eq. 1, LUFS, -70..=0, at least `least_lufs`. -10 is where the study ends.
    pub greatest_lufs: f32,
}

impl Default for AudioSettings {
    fn default() -> Self {
        Self { mode: Mode::Default, window_s: 3.0, least_lufs: -35.0, greatest_lufs: -10.0 }
    }
}

impl AudioSettings {
    /// These settings with each value limited to its documented range; NaN is the default.
    #[must_use]
    pub fn limited(self) -> Self {
        let default = Self::default();
        let least_lufs = within(self.least_lufs, [-70.0, 0.0], default.least_lufs);
        Self {
            mode: self.mode,
            window_s: within(self.window_s, [0.4, 120.0], default.window_s),
            least_lufs,
            greatest_lufs: within(self.greatest_lufs, [-70.0, 0.0], default.greatest_lufs).max(least_lufs),
        }
    }
}

/// gamma_ld, loudness units: `loudness_lufs` limited to ITU_min..=ITU_max, above ITU_min (paper A Eq. 1). 0 for
/// negative infinity and NaN. Settings are [`limited`](AudioSettings::limited) first.
pub fn gamma_ld(loudness_lufs: f32, settings: &AudioSettings) -> f32 {
    let AudioSettings { least_lufs, greatest_lufs, .. } = settings.limited();
    // `max` takes the other side of a NaN.
    loudness_lufs.max(least_lufs).min(greatest_lufs) - least_lufs
}

#[cfg(test)]
mod tests;
