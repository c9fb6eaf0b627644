//! The two curves of paper C, and how eccentricity in radians is mapped onto them.

use super::{ChromaSettings, Mode};
use std::f32::consts::FRAC_PI_2;

/// Gain of Cb at normalised eccentricity `e`: (1 - e^2)^z, paper C Eq. 1; 1 at 0, 0 from 1 on.
pub fn cb_gain(e: f32, z: f32) -> f32 {
    let e = unit(e);
    // The product keeps its digits near 1, where 1 - e^2 cancels.
    ((1.0 - e) * (1.0 + e)).powf(z)
}

/// Gain of Cr at normalised eccentricity `e`: (1 + cos(pi e^z)) / 2, paper C Eq. 2; 1 at 0, 0 from 1 on.
pub fn cr_gain(e: f32, z: f32) -> f32 {
    // cos^2 of the half angle: 1 + cos loses all digits near 1.
    let half = (FRAC_PI_2 * unit(e).powf(z)).cos();
    half * half
}

/// Fade over the last `1 / scale` of the range, a smooth step from 1 down to 0 at `e` = 1.
///
/// Eq. 1 falls vertically at 1 (its exponent is below 1), which shows as a rim. Both channels fade alike, which
/// keeps Cb's gain at or above Cr's.
pub fn rim_gain(e: f32, scale: f32) -> f32 {
    let t = unit((1.0 - e) * scale);
    t * t * (3.0 - 2.0 * t)
}

/// `x` limited to 0..=1; NaN is 0.
fn unit(x: f32) -> f32 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

/// What is kept of each chroma channel, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Of blue-yellow.
    pub cb: f32,
    /// Of red-green.
    pub cr: f32,
}

/// The curves over eccentricity, as the GPU evaluates them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curves {
    /// Eccentricity up to which both gains are 1, radians.
    pub plateau: f32,
    /// 1 / (eccentricity at which they are 0 - plateau), per radian.
    pub range_scale: f32,
    /// Z of Eq. 1.
    pub cb_bound: f32,
    /// Z of Eq. 2.
    pub cr_bound: f32,
    /// 1 / (width of the rim fade as a part of the range).
    pub rim_scale: f32,
}

/// Narrowest range between plateau and the end of colour, radians (1 degree).
const MIN_RANGE: f32 = std::f32::consts::PI / 180.0;

/// Width of a rim fade that fades nothing: the last bit or so before 1.
const NO_RIM: f32 = 1e-6;

impl Curves {
    /// The curves that `settings` ask for, with each value limited to its documented range.
    pub fn new(settings: &ChromaSettings) -> Self {
        let default = ChromaSettings::default();
        let limit = |value: f32, low: f32, high: f32, default: f32| {
            if value.is_nan() { default } else { value.clamp(low, high) }
        };
        let (plateau, rim) = match settings.mode {
            Mode::Paper => (0.0, 0.0),
            Mode::Default => (
                limit(settings.plateau_deg, 1.1, 30.0, default.plateau_deg).to_radians(),
                limit(settings.rim_fade, 0.0, 0.5, default.rim_fade),
            ),
        };
        let end = limit(settings.max_eccentricity_deg, 20.0, 110.0, default.max_eccentricity_deg);
        Self {
            plateau,
            range_scale: 1.0 / (end.to_radians() - plateau).max(MIN_RANGE),
            cb_bound: limit(settings.cb_bound, 0.70, 0.85, default.cb_bound),
            cr_bound: limit(settings.cr_bound, 0.35, 0.55, default.cr_bound),
            rim_scale: 1.0 / rim.max(NO_RIM),
        }
    }

    /// Gains at an eccentricity in radians.
    pub fn gains(&self, eccentricity: f32) -> Gains {
        let e = unit((eccentricity - self.plateau) * self.range_scale);
        let rim = rim_gain(e, self.rim_scale);
        Gains { cb: cb_gain(e, self.cb_bound) * rim, cr: cr_gain(e, self.cr_bound) * rim }
    }
}
