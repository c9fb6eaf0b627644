//! The plan of one eye.

use super::rates::{FULL, RateSet, UsedRates, clean, unary_of};
use parafovea_core::reuse::StaleTiles;

/// Rates of one eye buffer, see [`crate::link::EyeMapRecord`].
#[derive(Clone, Debug, Default)]
pub struct EyeMap {
    extent: [u32; 2],
    texel: [u32; 2],
    tiles: [u32; 2],
    texels: Vec<u8>,
    unary: Vec<u8>,
    used: UsedRates,
    stale: StaleTiles,
}

impl EyeMap {
    /// Takes a plan: the size of its picture and of a tile in pixels, columns and rows of tiles, and their texels, with the
    /// bit [`parafovea_core::reuse::STALE`] for stale tiles. Texels that
    /// are not a rate count as 1x1. Memory is only asked for beyond the largest plan so far.
    ///
    /// Where the numbers contradict each other the map becomes empty: everything is 1x1.
    pub fn set(&mut self, extent: [u32; 2], texel: [u32; 2], tiles: [u32; 2], texels: &[u8]) {
        let covers = |axis: usize| {
            texel[axis] > 0 && extent[axis] > 0 && tiles[axis] == extent[axis].div_ceil(texel[axis])
        };
        self.clear();
        if !covers(0) || !covers(1) || tiles[0] as usize * tiles[1] as usize != texels.len() {
            return;
        }
        (self.extent, self.texel, self.tiles) = (extent, texel, tiles);
        self.texels.extend(texels.iter().copied().map(clean));
        self.unary.extend(self.texels.iter().copied().map(unary_of));
        self.used = UsedRates::of(&self.texels);
        self.stale.set(extent, texel, &self.texels);
    }

    /// Everything is 1x1.
    pub fn clear(&mut self) {
        (self.extent, self.texel, self.tiles) = ([0; 2], [0; 2], [0; 2]);
        self.texels.clear();
        self.unary.clear();
        self.used = UsedRates::default();
        self.stale.clear();
    }

    /// Size of the picture, pixels; 0 where there is no plan.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// Size of a tile, pixels.
    pub fn texel(&self) -> [u32; 2] {
        self.texel
    }

    /// Columns and rows of tiles.
    pub fn tiles(&self) -> [u32; 2] {
        self.tiles
    }

    /// Texels of the tiles, row by row, with [`parafovea_core::reuse::STALE`].
    pub fn texels(&self) -> &[u8] {
        &self.texels
    }

    /// The tiles that are stale.
    pub fn stale(&self) -> &StaleTiles {
        &self.stale
    }

    /// Whether a tile that is not stale is coarser than 1x1.
    pub fn coarsens(&self) -> bool {
        self.used.coarsens()
    }

    pub(super) fn used(&self) -> RateSet {
        self.used.rates()
    }

    /// Texels of a row of tiles; `None` beyond the plan.
    pub(super) fn row(&self, row: usize) -> Option<&[u8]> {
        let columns = self.tiles[0] as usize;
        self.texels.get(row * columns..(row + 1) * columns).filter(|row| !row.is_empty())
    }

    /// Unary rates of a row, with [`parafovea_core::reuse::STALE`]; 1x1 beyond the plan.
    pub(super) fn unary_row(&self, row: usize) -> &[u8] {
        let columns = self.tiles[0] as usize;
        self.unary.get(row * columns..(row + 1) * columns).filter(|row| !row.is_empty()).unwrap_or(&[FULL])
    }
}
