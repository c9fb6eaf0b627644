//! Reference of the kernel `analyze`: the contrast of each tile of a picture, by octave of spatial frequency.
//!
//! Stage by stage, as the GPU does it: [`luminance_plane`](crate::perception::luminance::luminance_plane), then the levels
//! of the [`Pyramid`], each from the one before, then [`tiles`], and [`restore()`] for tiles that were not shaded at 1x1. It
//! does not depend on the gaze.
//!
//! All levels are half floats ([`half()`]), as nearly all time on a GPU goes into moving them.

mod half;
mod restore;

pub use half::{DARKEST_CD_M2, half, half_plane};
pub use restore::{SETTLED, Shown, restore, restored};

use crate::color::Matrix;
use crate::image::Plane;
use crate::layout::uniform;
use crate::perception::luminance::{as_luminance, usable_white};
use crate::perception::pyramid::{LEVELS, Pyramid, expand_row, upsampled_row};
use crate::perception::{BANDS, ContrastMap};
use crate::plan::TEXEL_SIDES;
use std::ops::Range;

/// Aggregation of the contrasts within a tile to one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Aggregation {
    /// The greatest. Right with thresholds ([`crate::perception::csf::castle`]): a tile is coarse enough when nothing in it
    /// is seen to change, and one thin line on a plain wall is seen however little of the tile it covers.
    #[default]
    Peak,
    /// The mean, as in paper A Eq. 10, whose constants were fitted to it. A line of one pixel has a fifth of its contrast in it, a dot less than a hundredth.
    Mean,
}

/// Settings of [`analyze`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContrastSettings {
    /// Size of a tile, pixels; sides outside of [`TEXEL_SIDES`] count as its nearest end.
    pub texel: [u32; 2],
    /// Pixels of the first tile that lie before the view, as tiles are counted from the corner of the view's image; counted modulo the
    /// tile's size.
    pub overhang: [u32; 2],
    /// Aggregation of the pixels of a tile.
    pub aggregation: Aggregation,
    /// Light that the headset's panel and optics add to black, and epsilon of the contrast dL / (L_a + epsilon), cd/m^2,
    /// 1e-4..=1e4. It keeps differences between nearly black pixels from counting. NaN counts as 0.1.
    pub dark_cd_m2: f32,
}

impl Default for ContrastSettings {
    /// Tiles as coarse-shading hardware has them, their peak, and 0.1 cd/m^2: 1/1000 of a usual white.
    fn default() -> Self {
        Self { texel: [16; 2], overhang: [0; 2], aggregation: Aggregation::Peak, dark_cd_m2: 0.1 }
    }
}

impl ContrastSettings {
    fn usable(&self) -> Self {
        let dark = if self.dark_cd_m2.is_nan() { Self::default().dark_cd_m2 } else { self.dark_cd_m2 };
        let texel = self.texel.map(|side| side.clamp(*TEXEL_SIDES.start(), *TEXEL_SIDES.end()));
        let overhang = [0, 1].map(|axis: usize| self.overhang[axis] % texel[axis]);
        Self { texel, overhang, dark_cd_m2: dark.clamp(1e-4, 1e4), ..*self }
    }

    /// Columns and rows of tiles of a picture of `extent` pixels, a started one counting whole; none without pixels.
    pub fn tiles(&self, extent: [u32; 2]) -> [u32; 2] {
        let usable = self.usable();
        [0, 1].map(|axis: usize| match extent[axis] {
            0 => 0,
            side => (side + usable.overhang[axis]).div_ceil(usable.texel[axis]),
        })
    }

    /// The pixels of column (`axis` 0) or row (1) `index` of tiles, of a picture of `side` pixels. Never empty.
    fn covered(&self, axis: usize, index: u32, side: u32) -> Range<u32> {
        let line = |index: u32| (index * self.texel[axis]).saturating_sub(self.overhang[axis]).min(side);
        line(index)..line(index + 1)
    }
}

uniform! {
    /// Parameters of one picture, the shader's uniform of the same name.
    pub struct AnalyzeParams {
        /// First pixel of the picture in its image.
        pub rect_offset: [u32; 2],
        /// Size of the picture, pixels.
        pub extent: [u32; 2],
        /// [`ContrastSettings::texel`].
        pub texel: [u32; 2],
        /// [`ContrastSettings::overhang`].
        pub overhang: [u32; 2],
        /// [`Matrix::weights`].
        pub weights: [f32; 3],
        /// Luminance of white, cd/m^2.
        pub white_cd_m2: f32,
        /// [`ContrastSettings::tiles`].
        pub tiles: [u32; 2],
        /// [`ContrastSettings::dark_cd_m2`].
        pub dark_cd_m2: f32,
        /// 0: [`Aggregation::Peak`], 1: [`Aggregation::Mean`].
        pub aggregation: u32,
    }
}

impl AnalyzeParams {
    /// Parameters of the picture of `extent` pixels at `rect_offset` in its image, whose white (1, 1, 1) is `white_cd_m2`.
    /// Values out of range count as in [`ContrastSettings`] and [`luminance`](crate::perception::luminance::luminance).
    pub fn new(
        rect_offset: [u32; 2],
        extent: [u32; 2],
        settings: &ContrastSettings,
        white_cd_m2: f32,
        matrix: Matrix,
    ) -> Self {
        let ContrastSettings { texel, overhang, aggregation, dark_cd_m2 } = settings.usable();
        Self {
            rect_offset,
            extent,
            texel,
            overhang,
            weights: matrix.weights().into(),
            white_cd_m2: usable_white(white_cd_m2),
            tiles: settings.tiles(extent),
            dark_cd_m2,
            aggregation: aggregation as u32,
        }
    }
}

/// Size of level `level` of the pyramid of a picture of `extent` pixels; level 0 is the picture.
pub fn level_size(extent: [u32; 2], level: usize) -> [u32; 2] {
    extent.map(|side| side.div_ceil(1 << level))
}

/// Columns and rows of blocks of two by two texels that level `level` is kept in. Where its size is odd, the last texels repeat.
pub fn level_blocks(extent: [u32; 2], level: usize) -> [u32; 2] {
    level_size(extent, level).map(|side| side.div_ceil(2))
}

/// Position of level `level` in the image of all levels, blocks: below the picture itself, side by side.
pub fn level_place(extent: [u32; 2], level: usize) -> [u32; 2] {
    if level == 0 {
        return [0; 2];
    }
    let column = (1..level).map(|finer| level_blocks(extent, finer)[0]).sum();
    [column, level_blocks(extent, 0)[1]]
}

/// Size of the image of all levels, blocks.
pub fn levels_extent(extent: [u32; 2]) -> [u32; 2] {
    let [width, height] = level_blocks(extent, 0);
    [width.max(level_place(extent, LEVELS + 1)[0]), height + level_blocks(extent, 1)[1]]
}

/// Memory of [`analyze`], kept so that the next picture of the same size needs no memory.
#[derive(Clone, Debug, Default)]
pub struct Buffers {
    /// The first stage.
    pub luminance: Plane,
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

/// The contrast of each tile of `luminance`, which is in cd/m^2
/// ([`luminance_plane`](crate::perception::luminance::luminance_plane)), into `out`, which takes the size in tiles,
/// [`ContrastSettings::tiles`].
///
/// Negative numbers and NaN in `luminance` count as black, numbers above 10,000 and infinity as 10,000: no such pixel gets
/// into the pyramid or the map, and around it the map is as around a black or white one. Black is [`DARKEST_CD_M2`].
///
/// Against the same without rounding to half floats, a band of a tile is off by at most 0.002 of 1 + its contrast.
pub fn analyze(luminance: &Plane, settings: &ContrastSettings, buffers: &mut Buffers, out: &mut ContrastMap) {
    let mut kept = std::mem::take(&mut buffers.luminance);
    half_plane(luminance, &mut kept);
    buffers.pyramid.build_rounded(&kept, half);
    tiles(&kept, settings, buffers, out);
    buffers.luminance = kept;
}

/// The third stage: from `luminance` and the pyramid that `buffers` hold of it, as they are.
///
/// Band i is level i minus level i + 1, expanded; its contrast is the amount of that over the luminance around it (level
/// i + 2, interpolated) and `dark_cd_m2`. A texel of a level belongs to every tile that it covers pixels of: only where
/// tiles do not begin on a multiple of 8 pixels may that be more than one.
pub fn tiles(luminance: &Plane, settings: &ContrastSettings, buffers: &mut Buffers, out: &mut ContrastMap) {
    let settings = settings.usable();
    let [columns, lines] = settings.tiles([luminance.width(), luminance.height()]);
    out.tiles.resize(columns, lines);
    if luminance.texels().is_empty() {
        return;
    }
    let Buffers { pyramid, rows, .. } = buffers;
    for row in 0..out.tiles.height() {
        adaptation(luminance, row, &settings, rows, out);
        for band in 0..BANDS {
            band_contrast(luminance, pyramid, band, row, &settings, rows, out);
        }
    }
}

/// Mean luminance of the tiles of one row.
fn adaptation(
    luminance: &Plane,
    row: u32,
    settings: &ContrastSettings,
    rows: &mut Rows,
    out: &mut ContrastMap,
) {
    let columns = &mut rows.light;
    columns.clear();
    columns.resize(luminance.width() as usize, 0.0);
    let lines = settings.covered(1, row, luminance.height());
    for y in lines.clone() {
        for (sum, value) in columns.iter_mut().zip(luminance.row(y)) {
            *sum += as_luminance(*value);
        }
    }
    for (column, tile) in (0..).zip(out.tiles.row_mut(row)) {
        let covered = settings.covered(0, column, luminance.width());
        let columns = &columns[covered.start as usize..covered.end as usize];
        tile.adaptation_cd_m2 = columns.iter().sum::<f32>() / (columns.len() * lines.len()) as f32;
    }
}

/// The texels of a level that cover a range of pixels.
fn texels(pixels: Range<u32>, level: usize) -> Range<usize> {
    (pixels.start >> level) as usize..((pixels.end - 1) >> level) as usize + 1
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
    let lines = texels(settings.covered(1, row, luminance.height()), band);
    for y in lines.clone().map(|y| y as u32) {
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
    for (column, tile) in (0..).zip(out.tiles.row_mut(row)) {
        let columns = &rows.columns[texels(settings.covered(0, column, luminance.width()), band)];
        tile.bands[band] = match settings.aggregation {
            Aggregation::Peak => columns.iter().copied().fold(0.0, f32::max),
            Aggregation::Mean => columns.iter().sum::<f32>() / (columns.len() * lines.len()) as f32,
        };
    }
}

#[cfg(test)]
mod tests;
