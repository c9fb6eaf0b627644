//! The share of an image that fixed foveation shades.

use super::FixedFoveation;
use crate::geometry::{ImagePlane, PixelRect, eccentricity, tile_eccentricity};
use crate::rate::ShadingRate;
use glam::{Vec2, Vec3};

/// Eccentricities of the tiles of an image of `extent` pixels, degrees, row by row: of the tile's point nearest to the
/// gaze, by which its rate is chosen, or, for tiles of 1 x 1, of the pixel's centre.
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
}

fn mean(eccentricities_deg: &[f32], rate: impl Fn(f32) -> f32) -> f32 {
    if eccentricities_deg.is_empty() {
        return 1.0;
    }
    let sum: f64 = eccentricities_deg.iter().map(|&eccentricity| f64::from(rate(eccentricity))).sum();
    (sum / eccentricities_deg.len() as f64) as f32
}
