//! Chroma attenuation with eccentricity, after "Perceptually Calibrated Foveated Chroma Attenuation for
//! Gaze-Contingent VR Displays" (paper C below). Works on linear light, where it keeps luminance exactly.
//!
//! [`Curves`] give the gain of each chroma channel at an eccentricity, [`Polynomials`] approximate them for use per pixel,
//! [`attenuate()`] applies the gains to a colour, and [`ChromaTemporalFilter`] lets the gains of a place fall slowly once the gaze has
//! left it.
//!
//! It saves bits of an encoder and power of a display, never GPU time.

mod attenuate;
mod curves;
mod floor;
mod polynomials;
mod temporal_filter;

pub use crate::color::Matrix;
pub use attenuate::{Gamut, attenuate};
pub use curves::{Curves, Gains, cb_gain, cr_gain};
pub use floor::{FLOOR_FREQUENCY_CPD, floor};
pub use polynomials::Polynomials;
pub use temporal_filter::{ChromaTemporalFilter, Focus};

/// Form of the model (`chroma.mode`). "off" is the absence of settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// With a plateau of full colour around the gaze, a soft rim, a floor that keeps large saturated fields visible,
    /// a limit on the change per second, and a guard that keeps colours in gamut.
    #[default]
    Default,
    /// The published curves alone: no plateau, no rim fade, no floor, no limit, no guard.
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
    /// `chroma.max_eccentricity_deg`: eccentricity at which the curves end, degrees, 20..=110. The paper does not state
    /// its divisor of eccentricity.
    pub max_eccentricity_deg: f32,
    /// `chroma.rim_fade`: least part of the way from the plateau to that angle over which colour may fall from full
    /// to none, 0.25..=1.
    pub rim_fade: f32,
    /// `chroma.max_change_per_s`: greatest fall of a gain in a second, 0.1..=100 (of 1, the full gain). Rising is not limited.
    pub max_change_per_s: f32,
    /// `chroma.matrix`. The paper does not name one.
    pub matrix: Matrix,
}

impl Default for ChromaSettings {
    /// The bounds that attenuate least; a plateau of the fovea's 5.2 degrees plus 1.1 of tracker error; a rim that
    /// leaves the curves of these bounds as they are; colour that takes two seconds to go, hence several fixations
    /// (of about 0.3 s each), so that no place has lost visible colour when the next glance returns to it.
    fn default() -> Self {
        Self {
            mode: Mode::Default,
            cb_bound: 0.70,
            cr_bound: 0.55,
            plateau_deg: 6.3,
            max_eccentricity_deg: 55.0,
            rim_fade: 0.5,
            max_change_per_s: 0.5,
            matrix: Matrix::Bt709,
        }
    }
}

#[cfg(test)]
mod tests;
