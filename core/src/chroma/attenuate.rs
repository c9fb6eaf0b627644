//! Scaling the chroma of one colour.

use super::Gains;
use glam::Vec3;

/// Which values of green the result may have: red and blue only ever move towards Y, green can overshoot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gamut {
    /// Least value.
    pub floor: f32,
    /// Greatest value.
    pub ceiling: f32,
}

impl Gamut {
    /// Stands for infinity, small enough that what is computed from it stays finite.
    const FAR: f32 = 1e30;
    /// Images that store 0..=1.
    pub const UNIT: Self = Self { floor: 0.0, ceiling: 1.0 };
    /// Images that store any light.
    pub const POSITIVE: Self = Self { floor: 0.0, ceiling: Self::FAR };
    /// No guard.
    pub const UNBOUNDED: Self = Self { floor: -Self::FAR, ceiling: Self::FAR };
}

/// Least amount of green that a gain of Cb is divided by, so that grey does not divide by 0.
const MIN_SHIFT: f32 = 1e-6;

/// `rgb` (linear light) with its chroma scaled by `gains`. Y is kept.
///
/// Cb and Cr are B - Y and R - Y over a constant each, so scaling them scales these two differences; green
/// follows from Y staying the same. `weights` are (Kr, Kg, Kb), see [`crate::color::Matrix::weights`].
///
/// With equal gains the result lies between the colour and grey, hence in gamut. The gain of Cb is the
/// greater one, and is lowered, at most to that of Cr, as far as green would leave `gamut`.
///
/// A colour of which a component is NaN or infinite stays as it is.
pub fn attenuate(rgb: Vec3, gains: Gains, weights: Vec3, gamut: Gamut) -> Vec3 {
    let y = weights.dot(rgb);
    if !y.is_finite() {
        return rgb;
    }
    let (red, blue) = (rgb.x - y, rgb.z - y);
    let (red_share, blue_share) = (weights.x / weights.y, weights.z / weights.y);

    let without_blue = y - red_share * gains.cr * red;
    let room = if blue > 0.0 { without_blue - gamut.floor } else { gamut.ceiling - without_blue };
    let limit = room / (blue_share * blue.abs()).max(MIN_SHIFT);
    let cb = gains.cb.min(limit.max(gains.cr));

    // As differences from the input, so that gains of 1 give back the very same value.
    let lost_red = (1.0 - gains.cr) * red;
    let lost_blue = (1.0 - cb) * blue;
    Vec3::new(rgb.x - lost_red, rgb.y + red_share * lost_red + blue_share * lost_blue, rgb.z - lost_blue)
}
