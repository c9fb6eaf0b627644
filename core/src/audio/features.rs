//! What the models take from sound.

/// Loudness and frequency of what is heard, measured over the last T_a (paper A, Algorithm 1 line 13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AudioFeatures {
    /// Loudness, LUFS (ITU-R BS.1770); -infinity in silence.
    pub loudness_lufs: f32,
    /// gamma_ld of Eq. 1, loudness units, 0..=25.
    pub gamma_ld: f32,
    /// gamma_fq of Eq. 3, kilo-mel, 1.000..=2.5457.
    pub gamma_fq_kilomel: f32,
    /// Whether nothing is heard, so that the features above mean nothing.
    pub silent: bool,
}
