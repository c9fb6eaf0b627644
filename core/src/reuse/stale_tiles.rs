//! A set of tiles.

use super::STALE;
use glam::Vec2;
use std::ops::Range;

/// The tiles of an eye's picture that are stale in a frame; all others are fresh.
///
/// A set of tiles is laid over pictures of other sizes proportionally, as the rates are.
#[derive(Debug, Default)]
pub struct StaleTiles {
    extent: [u32; 2],
    texel: [u32; 2],
    tiles: [u32; 2],
    /// Whether each tile is stale, row by row, 32 in a word from its lowest bit on.
    words: Vec<u32>,
    /// See [`Self::sum`]; empty before its call.
    sums: Vec<u16>,
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
        let Self { extent, texel, tiles, ref words, ref sums } = *self;
        Self { extent, texel, tiles, words: words.clone(), sums: sums.clone() }
    }

    /// Keeps the memory that there is.
    fn clone_from(&mut self, source: &Self) {
        (self.extent, self.texel, self.tiles) = (source.extent, source.texel, source.tiles);
        self.words.clone_from(&source.words);
        self.sums.clone_from(&source.sums);
    }
}

impl StaleTiles {
    /// Takes the tiles of `map` that have the bit [`STALE`]: a picture of `extent` pixels in tiles of `texel` pixels from its
    /// upper left corner on, row by row. Memory is only asked for beyond the largest set so far.
    ///
    /// Where the numbers contradict each other everything is fresh.
    pub fn set(&mut self, extent: [u32; 2], texel: [u32; 2], map: &[u8]) {
        let word =
            |tiles: &[u8]| tiles.iter().rev().fold(0, |word, tile| word << 1 | u32::from(tile & STALE != 0));
        if self.shape(extent, texel, |tiles| tiles == map.len() as u64) {
            self.words.extend(map.chunks(u32::BITS as usize).map(word));
        }
    }

    /// As [`Self::set`], from [`Self::words`] of such a set.
    pub fn set_words(&mut self, extent: [u32; 2], texel: [u32; 2], words: &[u32]) {
        if self.shape(extent, texel, |tiles| tiles.div_ceil(u32::BITS.into()) == words.len() as u64) {
            self.words.extend_from_slice(words);
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
        self.sums.clear();
    }

    /// Whether nothing is stale.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|word| *word == 0)
    }

    /// Adds what is stale in `other`: after that, each point of the picture is stale that was so in either. With tiles of
    /// another size, those are added that meet a stale one.
    pub fn unite(&mut self, other: &Self) {
        self.sums.clear();
        if self.tiles == [0; 2] {
            self.clone_from(other);
        } else if (self.extent, self.texel) == (other.extent, other.texel) {
            for (word, more) in self.words.iter_mut().zip(&other.words) {
                *word |= more;
            }
        } else {
            self.unite_proportionally(other);
        }
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

    /// Whether a tile, by column and row, is stale; what is beyond the picture is not.
    pub fn is_stale(&self, tile: [u32; 2]) -> bool {
        let is_inside = tile[0] < self.tiles[0] && tile[1] < self.tiles[1];
        is_inside && {
            let index = self.index(tile);
            self.words[index / 32] >> (index % 32) & 1 == 1
        }
    }

    /// Prepares for many questions about rectangles of tiles, which take four look-ups each then. Changes nothing else.
    pub fn sum(&mut self) {
        let Self { tiles: [columns, rows], words, sums, .. } = self;
        let line = *columns as usize + 1;
        sums.clear();
        sums.resize(line * (*rows as usize + 1), 0);
        let mut bits = Bits::at(words, 0);
        for row in 0..*rows as usize {
            let (above, below) = sums.split_at_mut(line * (row + 1));
            let mut sum = 0u16;
            for (below, above) in below[1..line].iter_mut().zip(&above[line * row + 1..]) {
                sum = sum.wrapping_add(bits.take().into());
                *below = above.wrapping_add(sum);
            }
        }
    }

    /// Whether any tile of a rectangle is fresh, and whether any is stale: of columns and rows from `first` to `last`, both within
    /// the picture. Without tiles everything is fresh.
    #[inline]
    pub(super) fn kinds(&self, first: [u32; 2], last: [u32; 2]) -> (bool, bool) {
        let ([left, top], [right, bottom]) = (first, last.map(|last| last + 1));
        if self.sums.is_empty() {
            return self.kinds_one_by_one(first, last);
        }
        let line = self.tiles[0] as usize + 1;
        // Modulo 2^16, which no rectangle of a plan's tiles has.
        let sum = |column: u32, row: u32| {
            self.sums.get(row as usize * line + column as usize).copied().unwrap_or(0)
        };
        let stale = sum(right, bottom)
            .wrapping_sub(sum(left, bottom))
            .wrapping_sub(sum(right, top))
            .wrapping_add(sum(left, top));
        let all = right.wrapping_sub(left).wrapping_mul(bottom.wrapping_sub(top)) as u16;
        (stale != all, stale != 0)
    }

    #[cold]
    fn kinds_one_by_one(&self, first: [u32; 2], last: [u32; 2]) -> (bool, bool) {
        let mut tiles = (first[1]..=last[1])
            .flat_map(|row| (first[0]..=last[0]).map(move |column| self.is_stale([column, row])));
        let begin = tiles.next().unwrap_or_default();
        let is_mixed = tiles.any(|is_stale| is_stale != begin);
        (!begin || is_mixed, begin || is_mixed)
    }

    /// Which tiles of a row are stale, 1 each, with a 0 before and after them; zeros for rows beyond the picture.
    pub(super) fn unpack_row(&self, row: u32, into: &mut Vec<u8>) {
        let columns = self.tiles[0] as usize;
        into.clear();
        into.push(0);
        if row < self.tiles[1] {
            let mut bits = Bits::at(&self.words, row as usize * columns);
            into.extend((0..columns).map(|_| bits.take()));
        }
        into.resize(columns + 2, 0);
    }

    fn index(&self, [column, row]: [u32; 2]) -> usize {
        row as usize * self.tiles[0] as usize + column as usize
    }

    /// The column and row of the tile that shows a point of a picture, given as shares of its width and height. What is
    /// beyond the picture is in the nearest tile.
    pub fn tile_at(&self, share: Vec2) -> [u32; 2] {
        [0, 1].map(|axis| {
            let tile = share[axis] * self.tiles_across()[axis];
            // Of what is negative or not a number, 0.
            (tile as u32).min(self.tiles[axis].saturating_sub(1))
        })
    }

    /// How many tiles go into the width and height of the picture, the last one cut off where they do not fit.
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

/// The bits of words one after the other, from the lowest of each on.
struct Bits<'a> {
    words: std::slice::Iter<'a, u32>,
    word: u32,
    left: u32,
}

impl<'a> Bits<'a> {
    /// From a bit on.
    fn at(words: &'a [u32], index: usize) -> Self {
        let mut words = words.get(index / 32..).unwrap_or_default().iter();
        let (word, skipped) = (words.next().copied().unwrap_or(0), index as u32 % 32);
        Self { words, word: word >> skipped, left: u32::BITS - skipped }
    }

    /// The next one; 0 after the last.
    #[inline]
    fn take(&mut self) -> u8 {
        if self.left == 0 {
            (self.word, self.left) = (self.words.next().copied().unwrap_or(0), u32::BITS);
        }
        let bit = (self.word & 1) as u8;
        self.word >>= 1;
        self.left -= 1;
        bit
    }
}
