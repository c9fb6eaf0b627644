//! Scaling the chroma of one colour.

use super::Gains;
use glam::Vec3;

/// Range of green in the result: red and blue only ever move towards Y, green can overshoot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gamut {
    /// Least value.
    pub floor: f32,
    /// Greatest value.
    pub ceiling: f32,
}

impl Gamut {
    /// Stands for infinity, small enough that results stay finite.
    const FAR: f32 = 1e30;
    /// Images that store 0..=1.
    pub const UNIT: Self = Self { floor: 0.0, ceiling: 1.0 };
    /// Images that store any light.
    pub const POSITIVE: Self = Self { floor: 0.0, ceiling: Self::FAR };
    /// No guard.
    pub const UNBOUNDED: Self = Self { floor: -Self::FAR, ceiling: Self::FAR };
}

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
    // As differences from the input, so that gains of 1 give back the very same value.
    let lost_red = (1.0 - gains.cr) * (rgb.x - y);
    let green = rgb.y + weights.x / weights.y * lost_red;
    // By how much green rises where blue loses the least and the most.
    let blue = weights.z / weights.y * (rgb.z - y);
    let (least, most) = ((1.0 - gains.cb) * blue, (1.0 - gains.cr) * blue);
    let lost_blue =
        least.max(gamut.floor - green).min(gamut.ceiling - green).max(least.min(most)).min(least.max(most));
    Vec3::new(rgb.x - lost_red, green + lost_blue, rgb.z - lost_blue * (weights.y / weights.z))
}
