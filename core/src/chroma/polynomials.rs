//! The curves as polynomials, which the kernel `compose` evaluates for each pixel. All of it takes 0.87 of the time on lavapipe 22.3 that it
//! takes with the powers of the curves.

use super::{Curves, Gains};
use std::f64::consts::{FRAC_PI_2, PI};

/// [`Curves`] with both equations as polynomials of variables that make them smooth, within [`Self::WITHIN`] of them.
///
/// Eq. 1 ends with an infinite slope, and Eq. 2 begins with one where its bound is below .5. Of w = 1 - (1 - e^2)^(1/2) and of
/// v = e^(1/2) they are nearly straight there. Both polynomials are 0 at 0, so that the plateau has no edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomials {
    /// [`Curves::plateau`], radians.
    pub plateau: f32,
    /// [`Curves::range_scale`], per radian.
    pub range_scale: f32,
    /// [`Curves::rim_scale`].
    pub rim_scale: f32,
    /// Loss of Cb by Eq. 1: factors of w, w^2, w^3 and w^4.
    pub cb_loss: [f32; 4],
    /// Loss of Cr by Eq. 2: factors of v to v^5.
    pub cr_loss: [f32; 5],
    /// [`Curves::cb_fall_off`], octaves per radian.
    pub cb_fall_off: f32,
    /// [`Curves::cr_fall_off`], octaves per radian.
    pub cr_fall_off: f32,
}

impl Polynomials {
    /// Largest deviation of a gain from that of the curves, over all settings: of Cr for its least bound in paper mode. By default it
    /// is a tenth of that.
    pub const WITHIN: f32 = 0.0036;

    /// Of these curves.
    pub fn new(curves: &Curves) -> Self {
        let (cb_bound, cr_bound) = (f64::from(curves.cb_bound), f64::from(curves.cr_bound));
        Self {
            plateau: curves.plateau,
            range_scale: curves.range_scale,
            rim_scale: curves.rim_scale,
            cb_loss: through(|w| 1.0 - (1.0 - w).powf(2.0 * cb_bound)),
            cr_loss: through(|v| (FRAC_PI_2 * v.powf(2.0 * cr_bound)).sin().powi(2)),
            cb_fall_off: curves.cb_fall_off,
            cr_fall_off: curves.cr_fall_off,
        }
    }

    /// Gains at an eccentricity in radians, >= 0; see [`Curves::gains`].
    pub fn gains(&self, eccentricity: f32) -> Gains {
        let e = ((eccentricity - self.plateau) * self.range_scale).clamp(0.0, 1.0);
        let cb = value(&self.cb_loss, 1.0 - ((1.0 - e) * (1.0 + e)).sqrt());
        let cr = value(&self.cr_loss, e.sqrt());
        let below_floor = |fall_off: f32| 1.0 - (-fall_off * eccentricity).exp2();
        Gains {
            cb: 1.0 - cb.min(below_floor(self.cb_fall_off)),
            cr: 1.0 - cr.min(e * self.rim_scale).min(below_floor(self.cr_fall_off)),
        }
    }
}

/// The polynomial with these factors, the one of `x` first, without a constant.
fn value(factors: &[f32], x: f32) -> f32 {
    factors.iter().rev().fold(0.0, |sum, factor| x * (factor + sum))
}

/// Factors of the polynomial without a constant that meets `loss`, which is 0 at 0, at `COUNT` points of 0..=1: the Chebyshev extrema
/// there; the last is 1. Uses Newton's divided differences.
fn through<const COUNT: usize>(loss: impl Fn(f64) -> f64) -> [f32; COUNT] {
    let at: [f64; COUNT] =
        std::array::from_fn(|index| 0.5 - 0.5 * (PI * (index + 1) as f64 / COUNT as f64).cos());
    let mut differences = at.map(|x| loss(x) / x);
    for order in 1..COUNT {
        for index in (order..COUNT).rev() {
            differences[index] =
                (differences[index] - differences[index - 1]) / (at[index] - at[index - order]);
        }
    }
    let mut factors = [0.0; COUNT];
    for (point, difference) in at.iter().zip(differences).rev() {
        for index in (0..COUNT).rev() {
            let lower = if index == 0 { difference } else { factors[index - 1] };
            factors[index] = lower - point * factors[index];
        }
    }
    factors.map(|factor| factor as f32)
}
