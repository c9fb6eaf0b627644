//! The two curves of paper C, how eccentricity in radians is mapped onto them, and the bounds of our default mode.

use super::{ChromaSettings, Mode, floor};
use crate::range::within;
use std::f32::consts::{FRAC_PI_2, LN_2};

/// Gain of Cb at normalised eccentricity `e`: (1 - e^2)^z, paper C Eq. 1; 1 at 0, 0 from 1 on. NaN counts as 0.
pub fn cb_gain(e: f32, z: f32) -> f32 {
    let e = unit(e);
    // The product keeps its digits near 1, where 1 - e^2 cancels.
    ((1.0 - e) * (1.0 + e)).powf(z)
}

/// Gain of Cr at normalised eccentricity `e`: (1 + cos(pi e^z)) / 2, paper C Eq. 2; 1 at 0, 0 from 1 on. NaN counts
/// as 0.
pub fn cr_gain(e: f32, z: f32) -> f32 {
    // cos^2 of the half angle: 1 + cos loses all digits near 1.
    let half = (FRAC_PI_2 * unit(e).powf(z)).cos();
    half * half
}

/// `x` limited to 0..=1; NaN is 0.
fn unit(x: f32) -> f32 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

/// Gain of each chroma channel, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Of blue-yellow.
    pub cb: f32,
    /// Of red-green.
    pub cr: f32,
}

impl Gains {
    /// Nothing is changed.
    pub const FULL: Self = Self { cb: 1.0, cr: 1.0 };

    /// These gains for a `strength` of 1, [`Gains::FULL`] for 0, and in proportion between.
    pub fn at_strength(self, strength: f32) -> Self {
        let mixed = |gain: f32| 1.0 - strength * (1.0 - gain);
        Self { cb: mixed(self.cb), cr: mixed(self.cr) }
    }

    /// The mean of both channels.
    pub fn mean(self) -> f32 {
        (self.cb + self.cr) / 2.0
    }
}

/// The curves over eccentricity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curves {
    /// Eccentricity up to which both gains are 1, radians.
    pub plateau: f32,
    /// 1 / (eccentricity at which the curves end - plateau), per radian.
    pub range_scale: f32,
    /// Z of Eq. 1.
    pub cb_bound: f32,
    /// Z of Eq. 2.
    pub cr_bound: f32,
    /// 1 / (least part of the range over which the gain of Cr may fall from 1 to 0).
    pub rim_scale: f32,
    /// Fall-off of the floor of Cb, octaves per radian: see [`floor`](super::floor()).
    pub cb_fall_off: f32,
    /// Fall-off of the floor of Cr, octaves per radian.
    pub cr_fall_off: f32,
}

/// Narrowest range of the curves in paper mode, radians (1 degree).
const MIN_PAPER_RANGE: f32 = std::f32::consts::PI / 180.0;

/// Narrowest range in default mode, radians (15 degrees): within less, colour would end at an edge, which would have
/// to follow the gaze very slowly.
const MIN_RANGE: f32 = 15.0 * MIN_PAPER_RANGE;

/// A slope so steep that the gain is 0 within a millionth of a degree: no rim fade, no floor.
const AT_ONCE: f32 = 1e9;

impl Curves {
    /// The curves that `settings` ask for, with each value limited to its documented range; NaN is the default.
    pub fn new(settings: &ChromaSettings) -> Self {
        let default = ChromaSettings::default();
        let end =
            within(settings.max_eccentricity_deg, [20.0, 110.0], default.max_eccentricity_deg).to_radians();
        let cb_bound = within(settings.cb_bound, [0.70, 0.85], default.cb_bound);
        let cr_bound = within(settings.cr_bound, [0.35, 0.55], default.cr_bound);
        match settings.mode {
            Mode::Paper => Self {
                plateau: 0.0,
                range_scale: 1.0 / end.max(MIN_PAPER_RANGE),
                cb_bound,
                cr_bound,
                rim_scale: AT_ONCE,
                cb_fall_off: AT_ONCE,
                cr_fall_off: AT_ONCE,
            },
            Mode::Default => {
                let fall_off = floor::fall_off();
                let plateau = within(settings.plateau_deg, [1.1, 30.0], default.plateau_deg).to_radians();
                Self {
                    plateau,
                    range_scale: 1.0 / (end - plateau).max(MIN_RANGE),
                    cb_bound,
                    cr_bound,
                    rim_scale: 1.0 / within(settings.rim_fade, [0.25, 1.0], default.rim_fade),
                    cb_fall_off: fall_off.cb,
                    cr_fall_off: fall_off.cr,
                }
            }
        }
    }

    /// Gains at an eccentricity in radians; NaN and negative values count as 0. Cb's is at least Cr's, but for 1e-14
    /// where both have ended.
    ///
    /// Both are the greater of curve and [`floor`](super::floor()). For a bound below .5 Eq. 2 starts with an infinite
    /// slope; the rim fade replaces its beginning by a straight line. Eq. 1 would end with one, but meets its floor
    /// long before.
    pub fn gains(&self, eccentricity: f32) -> Gains {
        let e = unit((eccentricity - self.plateau) * self.range_scale);
        let floor = |fall_off: f32| floor::relative(fall_off, eccentricity);
        let rim = 1.0 - e * self.rim_scale;
        Gains {
            cb: cb_gain(e, self.cb_bound).max(floor(self.cb_fall_off)),
            cr: cr_gain(e, self.cr_bound).max(rim).max(floor(self.cr_fall_off)),
        }
    }

    /// Upper bound of the fall of either gain per radian of eccentricity, above 0.
    ///
    /// With u = pi E^Z / 2, Eq. 2 is cos^2 u and descends by 2 Z u sin u cos u / E. Where it is above the rim fade,
    /// sin^2 u < E rim_scale, which makes that less than 2 Z rim_scale; and for Z >= .5 it is at most 2 Z pi^2 / 4. The
    /// floor of Cr is steepest at 0. Cb is flatter: Eq. 1 meets its floor before it descends by 1 per range.
    pub fn steepest(&self) -> f32 {
        let double = 2.0 * self.cr_bound;
        let within_range =
            if double < 1.0 { self.rim_scale } else { double * self.rim_scale.min(FRAC_PI_2 * FRAC_PI_2) };
        (within_range * self.range_scale).max(LN_2 * self.cr_fall_off)
    }
}
