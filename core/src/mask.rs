//! Mask of skipped pixels on devices without shading rates: the plan's rates as blocks that are shaded or left out.
//!
//! A picture is divided into blocks of [`BLOCK`] x [`BLOCK`] pixels, counted from its corner: a rasteriser in software
//! shades eight pixels at a time, and a GPU two by two, so that single pixels save nothing. In a tile whose rate shades
//! a fraction f of the pixels, a fraction f of the blocks is shaded, with the [`pattern`] of that fraction. The other
//! blocks are filled afterwards by [`crate::kernels::fill`] from the nearest shaded blocks around, which a
//! [`SkipList`] names for each skipped block.
//!
//! Where a whole tile is to be left out, because it is shown from an earlier frame ([`STALE`]), all of its blocks are skipped,
//! and not filled.
//!
//! Else a block is skipped only where it lies wholly inside of one view, and has a shaded block of that view within
//! [`REACH`]: blocks outside of all views are shaded, and nothing is ever interpolated across two views.

mod depth;
mod early_return;
mod list;
mod pattern;
mod sources;

pub use depth::{
    DepthFormat, Direction, NoNearValue, TemplateDepths, TemplateWords, near_value, write_template,
};
pub use early_return::{EarlyReturnParams, RETURNS};
pub use list::{BLOCKS_PER_GROUP, HEADER_WORDS, SkipList, SkippedBlock};
pub use pattern::Pattern;
pub use sources::{REACH, SOURCES, Source};

use crate::image::Plane;
use crate::kernels::fill::{FillFormat, fill_image};
use crate::plan::EyePlan;
use crate::rate::ShadingRate;
use crate::reuse::STALE;
use glam::UVec2;
use sources::{PatternSources, PatternsAround, ShadedBlocks, SourceFinder};

/// Side of a block, pixels. The shader has the same constant.
pub const BLOCK: u32 = 4;

/// Longest side of a picture, pixels; beyond it nothing is skipped. Positions of blocks have 12 bits in a [`SkipList`].
pub const MAX_SIDE: u32 = BLOCK << 12;

/// Most array layers of a picture that can have skipped blocks.
pub const MAX_LAYERS: u32 = 1 << 8;

/// Rates of tiles.
#[derive(Clone, Copy, Debug)]
pub struct TileRates<'a> {
    /// Size of a tile, pixels. Tiles are counted from the picture's corner.
    pub texel: [u32; 2],
    /// Column and row of the first tile that there is a rate of.
    pub first: [u32; 2],
    /// Number of columns.
    pub columns: u32,
    /// [`ShadingRate::texel`] of each tile, with [`STALE`] where it is left out, row by row; beyond them, and where a byte is not a rate,
    /// every pixel is shaded.
    pub rates: &'a [u8],
}

impl TileRates<'_> {
    /// The rate of a tile of the picture, which may be left out.
    fn rate(&self, tile: UVec2) -> ShadingRate {
        ShadingRate::from_texel(self.byte(tile) & !STALE).unwrap_or(ShadingRate::R1X1)
    }

    /// Whether a tile of the picture is left out.
    fn is_stale(&self, tile: UVec2) -> bool {
        let byte = self.byte(tile);
        byte & STALE != 0 && ShadingRate::from_texel(byte & !STALE).is_some()
    }

    fn byte(&self, tile: UVec2) -> u8 {
        let first = UVec2::from(self.first);
        let at = tile - first.min(tile);
        let inside = tile.cmpge(first).all() && at.x < self.columns;
        let index = at.y as usize * self.columns as usize + at.x as usize;
        let byte = if inside { self.rates.get(index) } else { None };
        byte.copied().unwrap_or(ShadingRate::R1X1.texel())
    }
}

/// A rectangle of one array layer that shows a view, with the rates of its tiles.
#[derive(Clone, Copy, Debug)]
pub struct MaskView<'a> {
    /// The array layer.
    pub layer: u32,
    /// First pixel of the rectangle.
    pub offset: [u32; 2],
    /// Size of the rectangle, pixels.
    pub extent: [u32; 2],
    /// The rates.
    pub tiles: TileRates<'a>,
}

impl<'a> MaskView<'a> {
    /// The view of a plan, in array layer `layer`.
    pub fn of(plan: &'a EyePlan, layer: u32) -> Self {
        let EyePlan { offset, extent, texel, rates, .. } = plan;
        let first = UVec2::from(*offset) / UVec2::from(*texel).max(UVec2::ONE);
        let tiles =
            TileRates { texel: *texel, first: first.into(), columns: rates.width(), rates: rates.texels() };
        Self { layer, offset: *offset, extent: *extent, tiles }
    }

    /// The rate of a block: as fine as all the tiles that it touches.
    fn rate(&self, block: UVec2) -> ShadingRate {
        self.tiles_of(block).map(|tile| self.tiles.rate(tile)).fold(ShadingRate::R4X4, ShadingRate::finer)
    }

    /// Whether a block is left out: where all the tiles that it touches are.
    fn is_stale(&self, block: UVec2) -> bool {
        self.tiles_of(block).all(|tile| self.tiles.is_stale(tile))
    }

    /// The tiles that a block touches: the tiles of its corners.
    fn tiles_of(&self, block: UVec2) -> impl Iterator<Item = UVec2> {
        let texel = UVec2::from(self.tiles.texel).max(UVec2::ONE);
        let last = BLOCK - 1;
        let corners = [UVec2::ZERO, UVec2::new(last, 0), UVec2::new(0, last), UVec2::splat(last)];
        let count = if texel % BLOCK == UVec2::ZERO { 1 } else { corners.len() };
        corners.into_iter().take(count).map(move |corner| (block * BLOCK + corner) / texel)
    }

    /// The column of blocks from which on a rate may be another than in column `x`.
    fn tile_end(&self, x: u32) -> u32 {
        let [texel, _] = self.tiles.texel;
        if texel > 0 && texel.is_multiple_of(BLOCK) {
            (x * BLOCK / texel + 1) * (texel / BLOCK)
        } else {
            x + 1
        }
    }

    /// Whether two views have pixels of one layer in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let range = |view: &Self, axis: usize| {
            (view.offset[axis], view.offset[axis].saturating_add(view.extent[axis]))
        };
        let on = |axis: usize| {
            let ((a, a_end), (b, b_end)) = (range(self, axis), range(other, axis));
            a < b_end && b < a_end
        };
        self.layer == other.layer && on(0) && on(1)
    }

    /// The blocks that lie wholly inside: the first one, and the one after the last.
    pub(crate) fn blocks(&self, extent: [u32; 2]) -> (UVec2, UVec2) {
        let offset = UVec2::from(self.offset);
        let end = offset.saturating_add(UVec2::from(self.extent)).min(extent.into());
        let first = UVec2::new(offset.x.div_ceil(BLOCK), offset.y.div_ceil(BLOCK));
        (first, (end / BLOCK).max(first))
    }
}

/// Skipped blocks of a picture, with the sources that they are filled from. Kept, so that a frame allocates nothing.
#[derive(Clone, Debug)]
pub struct Mask {
    extent: [u32; 2],
    layers: Vec<Plane<bool>>,
    list: SkipList,
    /// Number of blocks that are skipped and not filled.
    left_out: usize,
    patterns: PatternSources,
    /// Of [`SourceFinder`].
    around: PatternsAround,
    /// Of the view whose sources are looked for.
    shaded: ShadedBlocks,
}

impl Mask {
    /// A mask for pictures of `extent` pixels with `layers` array layers, with all memory that it will ever need;
    /// nothing is skipped yet. Layers beyond [`MAX_LAYERS`] never have skipped blocks.
    pub fn new(extent: [u32; 2], layers: u32) -> Self {
        let blocks = extent.map(|side| side.div_ceil(BLOCK));
        let plane = || Plane::filled(blocks[0], blocks[1], false);
        let layers: Vec<_> = (0..layers.min(MAX_LAYERS)).map(|_| plane()).collect();
        let skippable: usize = layers.iter().map(|plane| plane.texels().len()).sum();
        let list = SkipList::with_capacity(skippable);
        let around = PatternsAround::with_capacity(blocks[0] as usize);
        let (patterns, shaded) = (PatternSources::new(), ShadedBlocks::new(blocks));
        Self { extent, layers, list, left_out: 0, patterns, around, shaded }
    }

    /// Replaces the image's rates by the rates of `views`. Where views overlap, pixels are skipped only if all of them skip.
    pub fn resolve(&mut self, views: &[MaskView]) {
        self.list.clear();
        self.left_out = 0;
        for layer in &mut self.layers {
            layer.texels_mut().fill(false);
        }
        if self.extent.iter().any(|side| *side > MAX_SIDE) {
            return;
        }
        for (index, view) in views.iter().enumerate() {
            if !views[..index].iter().any(|earlier| earlier.overlaps(view)) {
                self.skip(view);
                self.find_sources(view);
            }
        }
        self.list.seal();
    }

    fn skip(&mut self, view: &MaskView) {
        let Some(skipped) = self.layers.get_mut(view.layer as usize) else { return };
        let (first, end) = view.blocks(self.extent);
        for y in first.y..end.y {
            let mut x = first.x;
            while x < end.x {
                let block = UVec2::new(x, y);
                let (pattern, is_stale) = (Pattern::of(view.rate(block)), view.is_stale(block));
                // As far as the tile goes.
                let run = x..view.tile_end(x).min(end.x);
                x = run.end;
                let row = &mut skipped.row_mut(y)[run.start as usize..run.end as usize];
                for (skip, x) in row.iter_mut().zip(run) {
                    *skip = is_stale || !pattern.shades(UVec2::new(x, y), first, end);
                }
            }
        }
    }

    fn find_sources(&mut self, view: &MaskView) {
        let Some(skipped) = self.layers.get_mut(view.layer as usize) else { return };
        let (first, end) = view.blocks(self.extent);
        self.shaded.fill(skipped, (first, end));
        let mut finder = SourceFinder::new(view, &self.patterns, (first, end), &mut self.around);
        for y in first.y..end.y {
            let row = skipped.row_mut(y);
            let mut x = first.x;
            while x < end.x {
                // As far as the sources of all blocks follow from one pattern.
                let (run, sources) = finder.run(UVec2::new(x, y));
                while x < run {
                    let tile = x..view.tile_end(x).min(run);
                    x = tile.end;
                    if view.is_stale(UVec2::new(tile.start, y)) {
                        self.left_out += tile.len();
                        continue;
                    }
                    for x in tile {
                        if !row[x as usize] {
                            continue;
                        }
                        let block = UVec2::new(x, y);
                        match sources.map_or_else(|| self.shaded.nearest(block), |of| Some(of.at(x))) {
                            Some(sources) => self.list.push(block, view.layer, sources),
                            None => {
                                row[x as usize] = false;
                                self.shaded.shade(block);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Size of the picture, pixels.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// For each block of an array layer, whether it is skipped; nothing for a layer that there is not.
    pub fn skipped(&self, layer: u32) -> Option<&Plane<bool>> {
        self.layers.get(layer as usize)
    }

    /// Whether a pixel is skipped; false outside of the picture.
    pub fn skips(&self, layer: u32, [x, y]: [u32; 2]) -> bool {
        let inside = x < self.extent[0] && y < self.extent[1];
        inside && self.skipped(layer).is_some_and(|plane| plane.at(x / BLOCK, y / BLOCK))
    }

    /// The skipped blocks that are filled, with their sources.
    pub fn list(&self) -> &SkipList {
        &self.list
    }

    /// Share of the pixels that is shaded, 0..=1; 1 for an empty picture.
    pub fn shaded(&self) -> f32 {
        let pixels = f64::from(self.extent[0]) * f64::from(self.extent[1]) * self.layers.len() as f64;
        let skipped = (self.list.len() + self.left_out) as f64 * f64::from(BLOCK * BLOCK);
        if pixels > 0.0 { (1.0 - skipped / pixels) as f32 } else { 1.0 }
    }
}

/// The application's picture with the mask, given the picture that it draws without the layer: shaded blocks
/// are as they were, and skipped ones are filled. That of the GPU is within one code value of this.
///
/// `pixels` are the rows of one array layer without gaps, [`FillFormat::texel_size`] bytes for each pixel.
pub fn predict(pixels: &mut [u8], format: FillFormat, mask: &Mask, layer: u32) {
    fill_image(pixels, mask.extent(), format, mask.list(), layer);
}

#[cfg(test)]
mod tests;
