//! The two features of sound, from a loudness and a frequency (paper A, Eq. 1 and 2).

/// `ITU_min` and `ITU_max` of Eq. 1, LUFS. The paper does not state them; with BS.1770's gate of -70 the model leaves its
/// scale of five points, and these are the loudness that its study covered (supplement, section 1.3).
pub const LOUDNESS_LUFS: [f32; 2] = [-35.0, -10.0];

/// Range of gamma_ld, loudness units: what Eq. 1 makes of [`LOUDNESS_LUFS`].
pub const GAMMA_LD: [f32; 2] = [0.0, LOUDNESS_LUFS[1] - LOUDNESS_LUFS[0]];

/// Range of gamma_fq, kilo-mel: 1 to 6 kHz, which the study covered (supplement, section 1.3). Not limited, 1/gamma_fq would
/// make 50 Hz worth more than the whole scale of scores.
pub const GAMMA_FQ_KILOMEL: [f32; 2] = [1.0, 2.5457];

/// gamma_ld of Eq. 1: loudness in LUFS, limited to [`LOUDNESS_LUFS`] and counted from its lower end, 0..=25. Silence
/// (-infinity) and NaN give 0.
pub fn gamma_ld(loudness_lufs: f32) -> f32 {
    let [least, greatest] = LOUDNESS_LUFS;
    if loudness_lufs.is_nan() { 0.0 } else { loudness_lufs.clamp(least, greatest) - least }
}

/// A pure tone's gamma_fq: Eq. 2 of a frequency in Hz, in kilo-mel, the unit with which the paper's coefficients and
/// results agree. 0 Hz gives 0; negative counts as 0, and NaN stays NaN. Not limited, see [`clamp_gamma_fq`].
pub fn gamma_fq_kilomel(frequency_hz: f32) -> f32 {
    let frequency_hz = if frequency_hz < 0.0 { 0.0 } else { frequency_hz };
    // ln_1p: below 1 Hz, 1 + f / 700 has lost most digits of f.
    2.595 * std::f32::consts::LOG10_E * (frequency_hz / 700.0).ln_1p()
}

/// gamma_fq limited to [`GAMMA_FQ_KILOMEL`]. NaN stays NaN.
pub fn clamp_gamma_fq(gamma_fq_kilomel: f32) -> f32 {
    gamma_fq_kilomel.clamp(GAMMA_FQ_KILOMEL[0], GAMMA_FQ_KILOMEL[1])
}
