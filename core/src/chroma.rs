//! Chroma attenuation with eccentricity, after "Perceptually Calibrated Foveated Chroma Attenuation for
//! Gaze-Contingent VR Displays" (paper C below). Works on linear light, where it keeps luminance exactly.

mod attenuate;
mod curves;

pub use crate::color::Matrix;
pub use attenuate::{Gamut, attenuate};
pub use curves::{Curves, Gains, cb_gain, cr_gain, rim_gain};

/// Which form of the model runs (`chroma.mode`; "off" is having no settings).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// With a plateau of full colour around the gaze, a soft rim, and a guard that keeps colours in gamut.
    #[default]
    Default,
    /// The published curves alone: no plateau, no rim fade, no guard.
    Paper,
}

/// The options of chroma attenuation, one for each key under `chroma.` of the configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChromaSettings {
    /// `chroma.mode`.
    pub mode: Mode,
    /// `chroma.cb_bound`: Z of the blue-yellow curve (paper C Eq. 1), 0.70..=0.85. Larger attenuates more.
    pub cb_bound: f32,
    /// `chroma.cr_bound`: Z of the red-green curve (paper C Eq. 2), 0.35..=0.55. Larger attenuates less.
    pub cr_bound: f32,
    /// `chroma.plateau_deg`: eccentricity up to which nothing changes, degrees, 1.1..=30.
    pub plateau_deg: f32,
    /// `chroma.max_eccentricity_deg`: eccentricity at which no colour is left, degrees, 20..=110. The paper
    /// does not say what it divides eccentricity by.
    pub max_eccentricity_deg: f32,
    /// `chroma.rim_fade`: last part of the range over which the steep end of Eq. 1 is softened, 0..=0.5.
    pub rim_fade: f32,
    /// `chroma.matrix`. The paper does not name one.
    pub matrix: Matrix,
}

impl Default for ChromaSettings {
    /// The bounds that attenuate least; a plateau of the fovea's 5.2 degrees plus 1.1 of tracker error.
    fn default() -> Self {
        Self {
            mode: Mode::Default,
            cb_bound: 0.70,
            cr_bound: 0.55,
            plateau_deg: 6.3,
            max_eccentricity_deg: 55.0,
            rim_fade: 0.05,
            matrix: Matrix::Bt709,
        }
    }
}

#[cfg(test)]
mod tests;
