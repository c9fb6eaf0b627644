//! A set of tiles.

use super::{STALE, bits};
use glam::Vec2;
use std::ops::Range;

/// The tiles of an eye buffer that are stale in a frame; all others are fresh.
///
/// A set of tiles is scaled to pictures of other sizes, as the rates are.
#[derive(Debug, Default)]
pub struct StaleTiles {
    extent: [u32; 2],
    texel: [u32; 2],
    tiles: [u32; 2],
    /// Whether each tile is stale, row by row, 32 in a word from its lowest bit on.
    words: Vec<u32>,
    /// Whether each tile is fresh, each row from a word on, 64 in a word from its lowest bit on; 0 beyond the last column.
    fresh: Vec<u64>,
}

impl PartialEq for StaleTiles {
    fn eq(&self, other: &Self) -> bool {
        let shape = |tiles: &Self| (tiles.extent, tiles.texel, tiles.tiles);
        shape(self) == shape(other) && self.words == other.words
    }
}

impl Eq for StaleTiles {}

impl Clone for StaleTiles {
    fn clone(&self) -> Self {
        let Self { extent, texel, tiles, ref words, ref fresh } = *self;
        Self { extent, texel, tiles, words: words.clone(), fresh: fresh.clone() }
    }

    /// Keeps the memory that there is.
    fn clone_from(&mut self, source: &Self) {
        (self.extent, self.texel, self.tiles) = (source.extent, source.texel, source.tiles);
        self.words.clone_from(&source.words);
        self.fresh.clone_from(&source.fresh);
    }
}

impl StaleTiles {
    /// Takes the tiles of `map` that have the bit [`STALE`]: a picture of `extent` pixels in tiles of `texel` pixels from its
    /// upper left corner on, row by row. Memory is only asked for beyond the largest set so far.
    ///
    /// Where the numbers contradict each other everything is fresh.
    pub fn set(&mut self, extent: [u32; 2], texel: [u32; 2], map: &[u8]) {
        let word = |tiles: &[u8]| bits::pack(tiles, STALE.trailing_zeros() as usize) as u32;
        if self.shape(extent, texel, |tiles| tiles == map.len() as u64) {
            self.words.extend(map.chunks(u32::BITS as usize).map(word));
            self.set_fresh();
        }
    }

    /// As [`Self::set`], from [`Self::words`] of such a set.
    pub fn set_words(&mut self, extent: [u32; 2], texel: [u32; 2], words: &[u32]) {
        if self.shape(extent, texel, |tiles| tiles.div_ceil(u32::BITS.into()) == words.len() as u64) {
            self.words.extend_from_slice(words);
            self.set_fresh();
        }
    }

    /// Works out [`Self::fresh`] from [`Self::words`].
    fn set_fresh(&mut self) {
        let [columns, rows] = self.tiles.map(|count| count as usize);
        self.fresh.clear();
        for row in 0..rows {
            for column in (0..columns).step_by(bits::WORD) {
                let index = row * columns + column;
                let word = |next: usize| u64::from(self.words.get(index / 32 + next).copied().unwrap_or(0));
                // Three words hold any 64 bits in a row.
                let stale = (u128::from(word(0) | word(1) << 32) | u128::from(word(2)) << 64) >> (index % 32);
                self.fresh.push(!(stale as u64) & bits::first((columns - column) as u32));
            }
        }
    }

    /// Becomes fresh, with the tiles of that picture if there are as many as there may be; returns whether that is so.
    fn shape(&mut self, extent: [u32; 2], texel: [u32; 2], may_be: impl FnOnce(u64) -> bool) -> bool {
        self.clear();
        if texel.contains(&0) || extent.contains(&0) {
            return false;
        }
        let tiles = [extent[0].div_ceil(texel[0]), extent[1].div_ceil(texel[1])];
        let fits = may_be(u64::from(tiles[0]) * u64::from(tiles[1]));
        if fits {
            (self.extent, self.texel, self.tiles) = (extent, texel, tiles);
        }
        fits
    }

    /// Everything is fresh.
    pub fn clear(&mut self) {
        (self.extent, self.texel, self.tiles) = ([0; 2], [0; 2], [0; 2]);
        self.words.clear();
        self.fresh.clear();
    }

    /// Whether nothing is stale.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|word| *word == 0)
    }

    /// Adds the stale tiles of `other`: each point of the image is stale afterwards that was so in either. With tiles of another size,
    /// those are added that meet a stale one.
    pub fn unite(&mut self, other: &Self) {
        if self.tiles == [0; 2] {
            return self.clone_from(other);
        }
        if other.is_empty() {
            return;
        }
        if (self.extent, self.texel) == (other.extent, other.texel) {
            let mut added = 0;
            for (word, more) in self.words.iter_mut().zip(&other.words) {
                added |= more & !*word;
                *word |= more;
            }
            if added == 0 {
                return;
            }
        } else {
            self.unite_proportionally(other);
        }
        self.set_fresh();
    }

    fn unite_proportionally(&mut self, other: &Self) {
        for row in 0..self.tiles[1] {
            for column in 0..self.tiles[0] {
                let [columns, rows] = [self.met(other, 0, column), self.met(other, 1, row)];
                if rows.into_iter().any(|row| columns.clone().any(|column| other.is_stale([column, row]))) {
                    let index = self.index([column, row]);
                    self.words[index / 32] |= 1 << (index % 32);
                }
            }
        }
    }

    /// The columns (axis 0) or rows (1) of `other` that one of this set meets.
    fn met(&self, other: &Self, axis: usize, tile: u32) -> Range<u32> {
        // In units of a pixel of either, divided by the other's extent.
        let scale = |edge: u32, by: u32| u64::from(edge) * u64::from(by);
        let first = u64::from(tile) * u64::from(self.texel[axis]);
        let end = (first + u64::from(self.texel[axis])).min(self.extent[axis].into());
        let tile_of_other = scale(other.texel[axis], self.extent[axis]).max(1);
        let by_other = |edge: u64| edge * u64::from(other.extent[axis]);
        (by_other(first) / tile_of_other) as u32..by_other(end).div_ceil(tile_of_other) as u32
    }

    /// Whether a tile, by column and row, is stale; false beyond the image.
    pub fn is_stale(&self, tile: [u32; 2]) -> bool {
        let is_inside = tile[0] < self.tiles[0] && tile[1] < self.tiles[1];
        is_inside && {
            let index = self.index(tile);
            self.words[index / 32] >> (index % 32) & 1 == 1
        }
    }

    /// The fresh tiles of a row, as bits; nothing of a row beyond the picture.
    #[inline]
    pub(super) fn fresh_row(&self, row: i32) -> &[u64] {
        let words = bits::words(self.tiles[0]);
        let row = usize::try_from(row).unwrap_or(usize::MAX);
        let begin = row.saturating_mul(words);
        self.fresh.get(begin..begin.saturating_add(words)).unwrap_or_default()
    }

    /// Whether any tile of a rectangle is fresh, and whether any is stale: of columns and rows from `first` to `last`, both within
    /// the picture. Without tiles everything is fresh.
    pub(super) fn kinds(&self, first: [u32; 2], last: [u32; 2]) -> (bool, bool) {
        if self.tiles == [0; 2] {
            return (true, false);
        }
        let mut found = (false, false);
        for row in first[1]..=last[1] {
            let line = self.fresh_row(row as i32);
            for column in (first[0]..=last[0]).step_by(bits::WORD) {
                let of_range = bits::first(last[0] + 1 - column);
                let fresh = bits::read(line, column as i32) & of_range;
                found.0 |= fresh != 0;
                found.1 |= fresh != of_range;
            }
        }
        found
    }

    fn index(&self, [column, row]: [u32; 2]) -> usize {
        row as usize * self.tiles[0] as usize + column as usize
    }

    /// The column and row of the tile that shows a point of a picture, given as shares of its width and height. Points
    /// beyond the picture are in the nearest tile.
    pub fn tile_at(&self, share: Vec2) -> [u32; 2] {
        [0, 1].map(|axis| {
            let tile = share[axis] * self.tiles_across()[axis];
            // 0 for negative values and NaN.
            (tile as u32).min(self.tiles[axis].saturating_sub(1))
        })
    }

    /// Width and height of the image, tiles, with a fraction where the border cuts off the last one.
    pub fn tiles_across(&self) -> Vec2 {
        let axis = |axis: usize| self.extent[axis] as f32 / self.texel[axis].max(1) as f32;
        Vec2::new(axis(0), axis(1))
    }

    /// Size of the picture that the tiles are of, pixels.
    pub fn extent(&self) -> [u32; 2] {
        self.extent
    }

    /// Size of a tile, pixels.
    pub fn texel(&self) -> [u32; 2] {
        self.texel
    }

    /// Columns and rows of tiles; none where nothing is known, and everything fresh.
    pub fn tiles(&self) -> [u32; 2] {
        self.tiles
    }

    /// Whether each tile is stale: bit `i % 32`, counted from the lowest, of word `i / 32` for tile `i`, row by row.
    pub fn words(&self) -> &[u32] {
        &self.words
    }
}
