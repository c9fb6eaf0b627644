//! Reference of the kernel `analyze`: the contrast of each tile of a picture, by octave of spatial frequency.
//!
//! Stage by stage, as the GPU does it: [`luminance_plane`](super::luminance::luminance_plane), then the levels of the
//! [`Pyramid`], each from the one before, then [`tiles`]. It does not depend on the gaze.

use super::pyramid::{Pyramid, expand_row, upsampled_row};
use super::{BANDS, ContrastMap, luminance::as_luminance};
use crate::image::Plane;

/// How one number is made of the contrasts within a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Aggregation {
    /// The greatest. Right with thresholds ([`super::csf::castle`]): a tile is coarse enough when nothing in it is
    /// seen to change, and one thin line on a plain wall is seen however little of the tile it covers.
    #[default]
    Peak,
    /// The mean, as in paper A Eq. 10, whose constants were fitted to it. A line of one pixel has a fifth of its contrast in it, a dot less than a hundredth.
    Mean,
}

/// What [`analyze`] can be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContrastSettings {
    /// Side of a tile, pixels: a power of two within 8..=64, to which anything else is lowered or raised.
    pub tile_size: u32,
    /// What stands for a tile.
    pub aggregation: Aggregation,
    /// Light that the headset's panel and optics add to black, and epsilon of the contrast dL / (L_a + epsilon), cd/m^2,
    /// 1e-4..=1e4. It keeps differences between nearly black pixels from counting. What is no number is 0.1.
    pub dark_cd_m2: f32,
}

impl Default for ContrastSettings {
    /// Tiles as coarse-shading hardware has them, their peak, and 0.1 cd/m^2: 1/1000 of a usual white.
    fn default() -> Self {
        Self { tile_size: 16, aggregation: Aggregation::Peak, dark_cd_m2: 0.1 }
    }
}

impl ContrastSettings {
    fn usable(&self) -> Self {
        let dark = if self.dark_cd_m2.is_nan() { Self::default().dark_cd_m2 } else { self.dark_cd_m2 };
        Self {
            tile_size: 1 << self.tile_size.clamp(8, 64).ilog2(),
            dark_cd_m2: dark.clamp(1e-4, 1e4),
            ..*self
        }
    }
}

/// What [`analyze`] works in, kept so that the next picture of the same size needs no memory.
#[derive(Clone, Debug, Default)]
pub struct Buffers {
    /// The second stage.
    pub pyramid: Pyramid,
    rows: Rows,
}

#[derive(Clone, Debug, Default)]
struct Rows {
    fine: Vec<f32>,
    predicted: Vec<f32>,
    around: Vec<f32>,
    columns: Vec<f32>,
    light: Vec<f32>,
    scratch: Vec<f32>,
}

/// The contrast of each tile of `luminance`, which is in cd/m^2 ([`super::luminance::luminance_plane`]), into `out`,
/// which takes the size in tiles, rounded up; none for a picture without pixels.
///
/// What is negative or NaN in `luminance` counts as 0, what exceeds 10,000 as that, infinity too: no such pixel gets
/// into the pyramid or the map, and around it the map is as around a black or white one.
pub fn analyze(luminance: &Plane, settings: &ContrastSettings, buffers: &mut Buffers, out: &mut ContrastMap) {
    buffers.pyramid.build(luminance);
    tiles(luminance, settings, buffers, out);
}

/// The last stage: from `luminance` and the pyramid that `buffers` hold of it.
///
/// Band i is level i less what level i + 1, expanded, predicts; its contrast is the amount of that over the luminance
/// around it (level i + 2, interpolated) and `dark_cd_m2`.
pub fn tiles(luminance: &Plane, settings: &ContrastSettings, buffers: &mut Buffers, out: &mut ContrastMap) {
    let settings = settings.usable();
    let tile = settings.tile_size;
    out.tiles.resize(luminance.width().div_ceil(tile), luminance.height().div_ceil(tile));
    if luminance.texels().is_empty() {
        return;
    }
    let Buffers { pyramid, rows } = buffers;
    for row in 0..out.tiles.height() {
        adaptation(luminance, row, tile, rows, out);
        for band in 0..BANDS {
            band_contrast(luminance, pyramid, band, row, &settings, rows, out);
        }
    }
}

/// Mean luminance of the tiles of one row.
fn adaptation(luminance: &Plane, row: u32, tile: u32, rows: &mut Rows, out: &mut ContrastMap) {
    let columns = &mut rows.light;
    columns.clear();
    columns.resize(luminance.width() as usize, 0.0);
    let lines = row * tile..((row + 1) * tile).min(luminance.height());
    for y in lines.clone() {
        for (sum, value) in columns.iter_mut().zip(luminance.row(y)) {
            *sum += as_luminance(*value);
        }
    }
    for (tile, columns) in out.tiles.row_mut(row).iter_mut().zip(columns.chunks(tile as usize)) {
        let pixels = columns.len() * lines.len();
        tile.adaptation_cd_m2 = columns.iter().sum::<f32>() / pixels as f32;
    }
}

/// One band of the tiles of one row.
fn band_contrast(
    luminance: &Plane,
    pyramid: &Pyramid,
    band: usize,
    row: u32,
    settings: &ContrastSettings,
    rows: &mut Rows,
    out: &mut ContrastMap,
) {
    let level = if band == 0 { luminance } else { pyramid.level(band) };
    let width = level.width() as usize;
    for buffer in [&mut rows.fine, &mut rows.predicted, &mut rows.around, &mut rows.columns] {
        buffer.resize(width, 0.0);
    }
    rows.columns.fill(0.0);
    let side = settings.tile_size >> band;
    let lines = row * side..((row + 1) * side).min(level.height());
    for y in lines.clone() {
        for (fine, value) in rows.fine.iter_mut().zip(level.row(y)) {
            *fine = as_luminance(*value);
        }
        expand_row(pyramid.level(band + 1), y, &mut rows.predicted, &mut rows.scratch);
        upsampled_row(pyramid.level(band + 2), y, &mut rows.around, &mut rows.scratch);
        let texels = rows.fine.iter().zip(&rows.predicted).zip(&rows.around);
        let contrasts = texels
            .map(|((fine, predicted), around)| (fine - predicted).abs() / (around + settings.dark_cd_m2));
        match settings.aggregation {
            Aggregation::Peak => {
                for (peak, contrast) in rows.columns.iter_mut().zip(contrasts) {
                    *peak = if contrast > *peak { contrast } else { *peak };
                }
            }
            Aggregation::Mean => {
                for (sum, contrast) in rows.columns.iter_mut().zip(contrasts) {
                    *sum += contrast;
                }
            }
        }
    }
    for (tile, columns) in out.tiles.row_mut(row).iter_mut().zip(rows.columns.chunks(side as usize)) {
        tile.bands[band] = match settings.aggregation {
            Aggregation::Peak => columns.iter().copied().fold(0.0, f32::max),
            Aggregation::Mean => columns.iter().sum::<f32>() / (columns.len() * lines.len()) as f32,
        };
    }
}

#[cfg(test)]
mod tests;
