//! Sound features: the models' input.

use super::GREATEST_KILOMEL;

/// The features of paper A's perception model that are heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AudioFeatures {
    /// Loudness, LUFS (= LKFS); negative infinity when silent, else at least -70. A full-scale sine of 997 Hz in one
    /// channel has -3.01 (BS.1770-4, Annex 1).
    pub loudness_lufs: f32,
    /// gamma_ld of Eq. 1, loudness units: [`gamma_ld`](super::gamma_ld()) of the loudness, 0..=25 with the default
    /// settings.
    pub gamma_ld: f32,
    /// gamma_fq of Eq. 3, kilo-mel, [`LEAST_KILOMEL`](super::LEAST_KILOMEL)..=[`GREATEST_KILOMEL`]; the greatest when
    /// silent, which gives the least budget.
    pub gamma_fq_kilomel: f32,
    /// Nothing is heard: no block is above the absolute gate of BS.1770-4, -70 LKFS.
    pub silent: bool,
}

impl AudioFeatures {
    /// Digital silence, also before the first sample.
    pub const SILENT: Self = Self {
        loudness_lufs: f32::NEG_INFINITY,
        gamma_ld: 0.0,
        gamma_fq_kilomel: GREATEST_KILOMEL,
        silent: true,
    };
}
