//! How much of a picture fixed foveation shades, and which radii shade a given share (paper A's FR').

use super::FixedFoveation;
use crate::geometry::{ImagePlane, PixelRect, eccentricity, tile_eccentricity};
use crate::rate::ShadingRate;
use glam::{Vec2, Vec3};
use thiserror::Error;

/// A share of the pixels that no scaling of the radii shades.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("no radii shade {wanted} of the image; possible: {least} to {greatest}")]
pub struct MeanRateError {
    /// The requested value.
    pub wanted: f32,
    /// The mean rate with radii of 0.
    pub least: f32,
    /// The mean rate with the widest radii.
    pub greatest: f32,
}

/// Eccentricities of the tiles of an image of `extent` pixels, degrees, row by row: those of each tile's point nearest to
/// the gaze, as the rate of a tile is chosen, or, for tiles of 1 x 1, of each pixel's centre.
///
/// `gaze` is in view space; one without a meaning gives 0 everywhere. A `tile` side of 0 counts as 1. For averages
/// over the picture a tile that its edge cuts counts as a whole one.
pub fn eccentricities_deg(plane: &ImagePlane, extent: [u32; 2], tile: [u32; 2], gaze: Vec3) -> Vec<f32> {
    let tile = tile.map(|side| side.max(1));
    let starts = |axis: usize| (0..extent[axis]).step_by(tile[axis] as usize);
    let at = |x: u32, y: u32| {
        let min = Vec2::new(x as f32, y as f32);
        if tile == [1, 1] {
            return eccentricity(plane.direction(min + 0.5), gaze);
        }
        let end = [x.saturating_add(tile[0]).min(extent[0]), y.saturating_add(tile[1]).min(extent[1])];
        let rect = PixelRect { min, max: Vec2::new(end[0] as f32, end[1] as f32) };
        tile_eccentricity(plane, rect, gaze).min
    };
    starts(1).flat_map(|y| starts(0).map(move |x| at(x, y).to_degrees())).collect()
}

impl FixedFoveation {
    /// Mean of [`Self::rate_at`] over a picture, given as [`eccentricities_deg`], 1/16..=1. 1 for no eccentricities.
    pub fn mean_rate(&self, eccentricities_deg: &[f32]) -> f32 {
        mean(eccentricities_deg, |eccentricity| self.rate_at(eccentricity))
    }

    /// Mean fraction of [`Self::shading_rate_of`] over a picture, on a device with these rates.
    pub fn mean_shading_rate(&self, eccentricities_deg: &[f32], rates: &[ShadingRate]) -> f32 {
        mean(eccentricities_deg, |eccentricity| self.shading_rate_of(eccentricity, rates).fraction())
    }

    /// FR': both radii scaled alike so that `mean`, which must not fall as they grow ([`Self::mean_rate`] or
    /// [`Self::mean_shading_rate`]), is `wanted`: paper A's fixed foveation at the cost of the audio-visual one.
    ///
    /// Where `mean` moves in steps, the radii are the widest found whose mean is at most `wanted`. Radii reach up
    /// to 180 degrees. One that is not above 0, or NaN, is not scaled.
    ///
    /// # Errors
    /// Where `wanted` is NaN or outside of what radii of 0 and the widest ones shade.
    pub fn with_mean_rate(&self, wanted: f32, mean: impl Fn(&Self) -> f32) -> Result<Self, MeanRateError> {
        let scaled = |scale: f32| Self {
            foveal_deg: scale_radius(self.foveal_deg, scale),
            transitional_deg: scale_radius(self.transitional_deg, scale),
            ..*self
        };
        // The scale at which both are at their widest; without any radius above 0 there is nothing to scale.
        let smallest = [self.foveal_deg, self.transitional_deg]
            .into_iter()
            .filter(|&radius| radius > 0.0)
            .fold(f32::INFINITY, f32::min);
        let (mut low, mut high) = (0.0, (WIDEST_DEG / smallest).min(f32::MAX));
        let (least, greatest) = (mean(&scaled(low)), mean(&scaled(high)));
        if !(least..=greatest).contains(&wanted) {
            return Err(MeanRateError { wanted, least, greatest });
        }
        if wanted == greatest {
            return Ok(scaled(high));
        }
        // Until the two scales are neighbours, or nearly so.
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if mean(&scaled(middle)) <= wanted { low = middle } else { high = middle }
        }
        Ok(scaled(low))
    }
}

/// No direction is farther from the gaze than this.
const WIDEST_DEG: f32 = 180.0;

/// Halvings after which the radii are known to 180 / 2^30 degrees.
const BISECTIONS: u32 = 30;

fn scale_radius(radius_deg: f32, scale: f32) -> f32 {
    if radius_deg > 0.0 { (radius_deg * scale).min(WIDEST_DEG) } else { radius_deg }
}

fn mean(eccentricities_deg: &[f32], rate: impl Fn(f32) -> f32) -> f32 {
    if eccentricities_deg.is_empty() {
        return 1.0;
    }
    let sum: f64 = eccentricities_deg.iter().map(|&eccentricity| f64::from(rate(eccentricity))).sum();
    (sum / eccentricities_deg.len() as f64) as f32
}
