//! The share of chroma that is kept, by each possible definition of paper C's "31-37 %".
//!
//! Paper C gives one range and no definition. The mean share of chroma that is *kept* over a disc, averaged over both
//! channels, spans 31.28 % to 37.22 % over its bounds; the saving of the whole signal along a line spans 31.5 % to
//! 36.5 %. Both are reported, and so are the plain ones.

use glam::{Vec2, Vec3};
use parafovea_core::chroma::{Curves, Gains};
use parafovea_core::geometry::{ImagePlane, eccentricity};

/// Steps of an integral: (1 - E^2)^.7 is then right to 1e-6.
const STEPS: u32 = 4096;

/// Samples along each side of an area.
const SIDE: u32 = 256;

/// Mean gain of the chroma channels over a range of normalised eccentricity, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// The mean along a line from E = 0 to 1.
    pub line: Gains,
    /// The mean over a disc of radius 1 with E = 0 in its middle (the integral of 2 E f(E)): it is for the paper's
    /// curves that this, averaged over both channels, is 31-37 %.
    pub disc: Gains,
}

impl Report {
    /// Of gains as a function of normalised eccentricity.
    pub fn of(gains: impl Fn(f32) -> Gains) -> Self {
        let points = || (0..STEPS).map(|step| (step as f32 + 0.5) / STEPS as f32);
        Self {
            line: weighted_mean(points().map(|e| (1.0, gains(e)))),
            disc: weighted_mean(points().map(|e| (e, gains(e)))),
        }
    }

    /// 1 - the mean along a line, of both channels: 0..=1.
    pub fn line_reduction(&self) -> f32 {
        1.0 - self.line.mean()
    }

    /// 1 - the mean over a disc, of both channels: 0..=1.
    pub fn disc_reduction(&self) -> f32 {
        1.0 - self.disc.mean()
    }

    /// Saving of the whole signal along a line, 1 - (Y + Cb + Cr) / 3 with all of Y kept: 0..=2/3.
    pub fn line_signal_saving(&self) -> f32 {
        2.0 / 3.0 * self.line_reduction()
    }
}

/// Mean gains over a rectangle of `sides`, with E the distance from its middle over `normaliser`, all in one
/// unit. With a normaliser of 0 or NaN, E is NaN or infinite.
pub fn rectangle_mean(sides: [f32; 2], normaliser: f32, gains: impl Fn(f32) -> Gains) -> Gains {
    let sides = Vec2::from(sides);
    weighted_mean(unit_square().map(|at| (1.0, gains(((at - 0.5) * sides).length() / normaliser))))
}

/// Mean gains over the pixels of a view of `extent` pixels, looked at along `gaze` (of any length; one
/// without a meaning sees everything in full colour).
pub fn view_mean(plane: &ImagePlane, extent: [u32; 2], gaze: Vec3, curves: &Curves) -> Gains {
    let extent = Vec2::new(extent[0] as f32, extent[1] as f32);
    let angle = |at: Vec2| eccentricity(gaze, plane.direction(at * extent));
    weighted_mean(unit_square().map(|at| (1.0, curves.gains(angle(at)))))
}

/// Points that cover 0..1 in both directions evenly.
fn unit_square() -> impl Iterator<Item = Vec2> {
    let middle = |index: u32| (index as f32 + 0.5) / SIDE as f32;
    (0..SIDE).flat_map(move |y| (0..SIDE).map(move |x| Vec2::new(middle(x), middle(y))))
}

/// Mean of gains by weight, summed in double precision.
fn weighted_mean(samples: impl Iterator<Item = (f32, Gains)>) -> Gains {
    let (mut total, mut cb, mut cr) = (0.0f64, 0.0f64, 0.0f64);
    for (weight, gains) in samples {
        let weight = f64::from(weight);
        total += weight;
        cb += weight * f64::from(gains.cb);
        cr += weight * f64::from(gains.cr);
    }
    Gains { cb: (cb / total) as f32, cr: (cr / total) as f32 }
}

#[cfg(test)]
mod tests;
