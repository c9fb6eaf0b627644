//! The contrast sensitivity that paper A was fitted with: Tursun et al., "Luminance-contrast-aware foveated rendering",
//! ACM Transactions on Graphics 38(4), 2019, with the constants of its Matlab code (AwareFoveation, MIT licence).
//!
//! Fitted to a study, not physical: the values are about 1000 times as large as in [`super::castle`], do not fall
//! steadily with frequency, and mean something only together with paper A's constants.

use super::{SensitivityFall, Stimulus, VisualField};
use crate::perception::BANDS;
use crate::range::within;
use std::f32::consts::{LOG2_10, LOG2_E};

/// Sensitivity by [`Fit::QUARTER`], the fit that matches paper A's quarter-resolution frame; >= 0.
///
/// Out of domain or NaN: as in [`Stimulus::clamped`], but without a least frequency.
pub fn sensitivity(frequency_cpd: f32, eccentricity_deg: f32, adaptation_cd_m2: f32) -> f32 {
    Fit::QUARTER.sensitivity(frequency_cpd, eccentricity_deg, adaptation_cd_m2)
}

/// Factor on the physical contrast of each band, finest first, for these fits: their pyramid
/// filtered with sqrt(2) times the binomial filter in each direction, as pyrtools does, which doubles coefficients from
/// level to level. No other sensitivity function may be given contrast multiplied like this.
pub const BAND_GAIN: [f32; BANDS] = [1.0, 2.0, 4.0, 8.0];

/// The fitted constants for one resolution of the analysed picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// log10 of the sensitivity at the gaze at 4, 8, 16 and 32 cycles per degree (x1 to x4). Below 4 it is that at 4.
    pub log10_foveal: [f32; 4],
    /// `fec`: fall with eccentricity, per cycle.
    pub fall: f32,
}

/// log10 of the sensitivity at 64 cycles per degree, the last knot: nothing is seen there.
const LOG10_UNSEEN: f32 = -32.0;

impl Fit {
    /// `sfc` = 4: pictures of a quarter of the resolution. Not constrained by data above 8 cycles per degree.
    pub const QUARTER: Self =
        Self { log10_foveal: [5.289_64, 6.225_67, 3.404_10, 4.010_61], fall: 0.039_814_1 };
    /// `sfc` = 1: pictures of the whole resolution.
    pub const FULL: Self = Self { log10_foveal: [6.298_48, 5.548_57, 7.484_74, 7.945_27], fall: 0.038_217_8 };

    /// S0(f) * exp(-fall * eccentricity * f) * (1 + 0.7 / L)^-0.2, >= 0.
    ///
    /// Out of domain or NaN: as in [`Stimulus::clamped`], but without a least frequency.
    pub fn sensitivity(&self, frequency_cpd: f32, eccentricity_deg: f32, adaptation_cd_m2: f32) -> f32 {
        let eccentricity = within(eccentricity_deg, Stimulus::ECCENTRICITY_DEG, 0.0);
        self.at(frequency_cpd, adaptation_cd_m2).at(eccentricity, VisualField::Worst)
    }

    /// [`Self::sensitivity`] as a function of eccentricity, the same towards both sides.
    pub fn at(&self, frequency_cpd: f32, adaptation_cd_m2: f32) -> SensitivityFall {
        let usual = Stimulus::default();
        let frequency = within(frequency_cpd, [0.0, Stimulus::FREQUENCY_CPD[1]], usual.frequency_cpd);
        let luminance = within(adaptation_cd_m2, Stimulus::LUMINANCE_CD_M2, usual.luminance_cd_m2);
        let log2_per_deg = self.fall * frequency * LOG2_E;
        SensitivityFall {
            log2_foveal: self.log10_foveal(frequency) * LOG2_10 - 0.2 * (1.0 + 0.7 / luminance).log2(),
            log2_per_deg_temporal: log2_per_deg,
            log2_per_deg_nasal: log2_per_deg,
        }
    }

    /// PCHIP (Fritsch and Carlson 1980, as Matlab's `pchip`) through the knots over the logarithm of frequency, where
    /// those from 4 cycles per degree on are an octave apart and everything below is level.
    fn log10_foveal(&self, frequency_cpd: f32) -> f32 {
        let octave = frequency_cpd.max(4.0).log2() - 2.0;
        let [a, b, c, d] = self.log10_foveal;
        let knots = [a, b, c, d, LOG10_UNSEEN];
        let rise = [b - a, c - b, d - c, LOG10_UNSEEN - d];
        let slopes = [
            0.0, // level before the first knot
            harmonic_mean(rise[0], rise[1]),
            harmonic_mean(rise[1], rise[2]),
            harmonic_mean(rise[2], rise[3]),
            end_slope(rise[2], rise[3]),
        ];
        let i = (octave as usize).min(3);
        hermite(octave - i as f32, [knots[i], knots[i + 1]], [slopes[i], slopes[i + 1]])
    }
}

/// Slope at a knot between two equal steps; 0 at a peak or trough.
fn harmonic_mean(before: f32, after: f32) -> f32 {
    if before * after > 0.0 { 2.0 * before * after / (before + after) } else { 0.0 }
}

/// One-sided three-point slope at the last knot, limited so that the curve stays monotone.
fn end_slope(before: f32, last: f32) -> f32 {
    let slope = 1.5 * last - 0.5 * before;
    if slope * last <= 0.0 {
        0.0
    } else if before * last <= 0.0 && slope.abs() > 3.0 * last.abs() {
        3.0 * last
    } else {
        slope
    }
}

/// The cubic over 0..=1 with these values and slopes at its ends.
fn hermite(t: f32, value: [f32; 2], slope: [f32; 2]) -> f32 {
    let rise = value[1] - value[0];
    let quadratic = 3.0 * rise - 2.0 * slope[0] - slope[1];
    let cubic = slope[0] + slope[1] - 2.0 * rise;
    value[0] + t * (slope[0] + t * (quadratic + t * cubic))
}

#[cfg(test)]
mod tests;
