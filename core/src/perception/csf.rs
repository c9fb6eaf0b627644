//! Contrast sensitivity: the inverse of the least visible contrast, for a stimulus and its place in the visual field.
//!
//! [`castle`] is the default: physical units, with temporal frequency, area and colour. [`tursun`] is the set that
//! paper A was fitted with. In both the logarithm of sensitivity is linear in eccentricity, which
//! [`SensitivityFall`] uses: the part without the gaze is computed once, then a tile costs one `exp2`.

pub mod castle;
mod exp2;
pub mod tursun;

use crate::range::within;
use exp2::exp2;

/// A stimulus and its place in the visual field.
///
/// Every function that takes it clamps it to the domain of its model, see [`Self::clamped`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stimulus {
    /// Spatial frequency, cycles per degree.
    pub frequency_cpd: f32,
    /// Temporal frequency, Hz; 0 is a still picture.
    pub temporal_hz: f32,
    /// Angle from the gaze, degrees.
    pub eccentricity_deg: f32,
    /// Luminance that the eye is adapted to, cd/m^2.
    pub luminance_cd_m2: f32,
    /// Area that the stimulus covers, square degrees.
    pub area_deg2: f32,
}

impl Stimulus {
    /// The frequencies that castleCSF is defined for, cycles per degree (`rho_min`, `rho_max`).
    pub const FREQUENCY_CPD: [f32; 2] = [1.0 / 16.0, 64.0];
    /// From still to where f32 holds no response any more, Hz.
    pub const TEMPORAL_HZ: [f32; 2] = [0.0, 1000.0];
    /// The eccentricities that castleCSF is defined for, degrees (`ecc_max`).
    pub const ECCENTRICITY_DEG: [f32; 2] = [0.0, 120.0];
    /// The luminances that castleCSF is defined for, cd/m^2 (`Y_min`, `Y_max`).
    pub const LUMINANCE_CD_M2: [f32; 2] = [1e-3, 1e4];
    /// From about one cone to all directions, square degrees.
    pub const AREA_DEG2: [f32; 2] = [1e-4, 41_253.0];

    /// The stimulus within the constants of this type. NaN becomes the member of [`Self::default`], which is seen
    /// well, so that nothing is saved on it.
    pub fn clamped(&self) -> Self {
        let usual = Self::default();
        Self {
            frequency_cpd: within(self.frequency_cpd, Self::FREQUENCY_CPD, usual.frequency_cpd),
            temporal_hz: within(self.temporal_hz, Self::TEMPORAL_HZ, usual.temporal_hz),
            eccentricity_deg: within(self.eccentricity_deg, Self::ECCENTRICITY_DEG, usual.eccentricity_deg),
            luminance_cd_m2: within(self.luminance_cd_m2, Self::LUMINANCE_CD_M2, usual.luminance_cd_m2),
            area_deg2: within(self.area_deg2, Self::AREA_DEG2, usual.area_deg2),
        }
    }
}

impl Default for Stimulus {
    /// Still, at the gaze, 4 cycles per degree over one square degree at 100 cd/m^2: near the peak of sensitivity.
    fn default() -> Self {
        Self {
            frequency_cpd: 4.0,
            temporal_hz: 0.0,
            eccentricity_deg: 0.0,
            luminance_cd_m2: 100.0,
            area_deg2: 1.0,
        }
    }
}

/// Side of the gaze, as one eye sees it. Sensitivity falls differently towards both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VisualField {
    /// Towards the temple (`vis_field` 0 of castleCSF).
    Temporal,
    /// Towards the nose (`vis_field` 180, castleCSF's default).
    Nasal,
    /// The greater of both sensitivities: the cautious choice, safe on either side.
    #[default]
    Worst,
}

/// Sensitivity of one stimulus as a function of eccentricity alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensitivityFall {
    /// log2 of the sensitivity at the gaze; finite.
    pub log2_foveal: f32,
    /// Loss with each degree towards the temple, octaves, >= 0.
    pub log2_per_deg_temporal: f32,
    /// Loss with each degree towards the nose, octaves, >= 0.
    pub log2_per_deg_nasal: f32,
}

impl SensitivityFall {
    /// Loss with each degree, octaves, >= 0.
    #[inline]
    pub fn log2_per_deg(&self, field: VisualField) -> f32 {
        match field {
            VisualField::Temporal => self.log2_per_deg_temporal,
            VisualField::Nasal => self.log2_per_deg_nasal,
            VisualField::Worst => self.log2_per_deg_temporal.min(self.log2_per_deg_nasal),
        }
    }

    /// Sensitivity at an eccentricity in degrees, clamped to [`Stimulus::ECCENTRICITY_DEG`]; NaN counts as 0. At
    /// least 2^-126.
    #[inline]
    pub fn at(&self, eccentricity_deg: f32, field: VisualField) -> f32 {
        let [least, greatest] = Stimulus::ECCENTRICITY_DEG;
        // In this order NaN becomes the least value; `clamp` would keep it.
        let eccentricity_deg = eccentricity_deg.max(least).min(greatest);
        exp2(self.log2_foveal - self.log2_per_deg(field) * eccentricity_deg)
    }
}
