//! Sources of a skipped block: the nearest shaded block in each quarter around it.

use super::{BLOCK, MaskView, Pattern};
use crate::image::Plane;
use crate::rate::ShadingRate;
use glam::{IVec2, UVec2};

/// Blocks that a skipped one is filled from, at most: one for each quarter, of which the first lies to the right and the
/// others follow clockwise. Those two apart are opposite to each other.
pub const SOURCES: usize = 4;

/// Largest distance of a source, blocks in each direction. All patterns have every fourth block of every eighth row in common.
pub const REACH: u32 = 7;

/// Largest distance of the sources of [`Pattern::sources`], blocks in each direction.
const REACH_IN_PATTERN: u32 = 4;

/// Position of a shaded block relative to the skipped one: columns and rows, -7..=7, not both 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source(IVec2);

impl Source {
    /// Columns and rows from the skipped block on.
    pub fn offset(self) -> IVec2 {
        self.0
    }

    /// Both in four bits, two's complement, columns in the lower ones.
    fn byte(self) -> u8 {
        (self.0.x & 15 | (self.0.y & 15) << 4) as u8
    }

    /// The inverse of [`Self::byte`]; nothing for 0.
    fn from_byte(byte: u8) -> Option<Self> {
        let signed = |nibble: u8| i32::from((nibble << 4) as i8 >> 4);
        let offset = IVec2::new(signed(byte & 15), signed(byte >> 4));
        (offset != IVec2::ZERO).then_some(Self(offset))
    }
}

/// The sources of one block.
type Sources = [Option<Source>; SOURCES];

/// Sources in a word, a byte each; 0 where there is none.
pub(super) fn encode(sources: Sources) -> u32 {
    u32::from_le_bytes(sources.map(|source| source.map_or(0, Source::byte)))
}

/// The inverse of [`encode`].
pub(super) fn decode(word: u32) -> Sources {
    word.to_le_bytes().map(Source::from_byte)
}

/// Columns within [`REACH`] of a block to both sides, and its own, which is bit [`REACH`] of a row's window.
const WINDOW: u32 = 2 * REACH + 1;

/// Columns from the middle of a window to the nearest shaded block on the right, the middle's own not counted where `from` is 1.
fn to_the_right(window: u32, from: u32) -> Option<i32> {
    let bits = window >> (REACH + from);
    (bits != 0).then(|| (bits.trailing_zeros() + from) as i32)
}

/// The same on the left.
fn to_the_left(window: u32, from: u32) -> Option<i32> {
    let bits = window & ((1 << (REACH + 1 - from)) - 1);
    bits.checked_ilog2().map(|last| (REACH - last) as i32)
}

/// The nearest shaded block of each quarter within [`REACH`], given which blocks are shaded of the row so many rows below: a bit
/// a column, [`WINDOW`] of them. Of two at one distance the one farther from the quarter's axis counts: it is within [`REACH_IN_PATTERN`], where
/// one on the axis may not be.
fn nearest(row: impl Fn(i32) -> u32) -> Sources {
    let reach = REACH as i32;
    // The axis is the row: `down` is the direction of the rows beside it.
    let level = |down: i32, search: fn(u32, u32) -> Option<i32>| {
        let (mut found, mut limit) = (None, i32::MAX);
        for side in 0..=reach {
            if side * side >= limit {
                break;
            }
            let Some(ahead) = search(row(down * side), 1) else { continue };
            let distance = ahead * ahead + side * side;
            // As far, and farther aside, is nearer in each direction.
            if distance <= limit {
                (found, limit) = (Some((ahead, side)), distance);
            }
        }
        found
    };
    // The axis is the column: `down` is its direction.
    let upright = |down: i32, search: fn(u32, u32) -> Option<i32>| {
        let (mut found, mut limit) = (None, i32::MAX);
        for ahead in 1..=reach {
            if ahead * ahead >= limit {
                break;
            }
            let Some(side) = search(row(down * ahead), 0) else { continue };
            let distance = ahead * ahead + side * side;
            if distance < limit {
                (found, limit) = (Some((ahead, side)), distance);
            }
        }
        found
    };
    let source = |x: i32, y: i32| Source(IVec2::new(x, y));
    [
        level(1, to_the_right).map(|(ahead, side)| source(ahead, side)),
        upright(1, to_the_left).map(|(ahead, side)| source(-side, ahead)),
        level(-1, to_the_left).map(|(ahead, side)| source(-ahead, -side)),
        upright(-1, to_the_right).map(|(ahead, side)| source(side, -ahead)),
    ]
}

/// Shaded blocks of a view, a bit each, within an empty margin as wide as sources reach. Kept, so that a frame allocates nothing.
#[derive(Clone, Debug)]
pub(super) struct ShadedBlocks {
    row_bytes: usize,
    bits: Vec<u8>,
}

impl ShadedBlocks {
    /// With memory for a picture of so many columns and rows of blocks.
    pub(super) fn new([columns, rows]: [u32; 2]) -> Self {
        // A window is read as four bytes.
        let row_bytes = (columns + 2 * REACH).div_ceil(8) as usize + 3;
        Self { row_bytes, bits: vec![0; row_bytes * (rows + 2 * REACH) as usize] }
    }

    /// Fills in the shaded blocks from `first` on up to, not including, `end`.
    pub(super) fn fill(&mut self, skipped: &Plane<bool>, (first, end): (UVec2, UVec2)) {
        self.bits.fill(0);
        for y in first.y..end.y {
            let shaded = skipped.row(y)[first.x as usize..end.x as usize].iter().map(|skipped| !skipped);
            let row = &mut self.bits[self.row_bytes * (y + REACH) as usize..][..self.row_bytes];
            for (at, is_shaded) in (first.x + REACH..).zip(shaded) {
                row[at as usize / 8] |= u8::from(is_shaded) << (at % 8);
            }
        }
    }

    /// A block is shaded after all.
    pub(super) fn shade(&mut self, block: UVec2) {
        let at = block + REACH;
        self.bits[self.row_bytes * at.y as usize + at.x as usize / 8] |= 1 << (at.x % 8);
    }

    /// The nearest sources of a skipped block, as [`encode`] gives them; `None` if there are none within reach.
    pub(super) fn nearest(&self, block: UVec2) -> Option<u32> {
        let first_byte = self.row_bytes * (block.y + REACH) as usize + block.x as usize / 8;
        let found = nearest(|down| {
            let at = first_byte.saturating_add_signed(down as isize * self.row_bytes as isize);
            let bytes =
                self.bits.get(at..).and_then(|bytes| bytes.first_chunk()).copied().unwrap_or_default();
            u32::from_le_bytes(bytes) >> (block.x % 8) & ((1 << WINDOW) - 1)
        });
        Some(encode(found)).filter(|word| *word != 0)
    }
}

impl Pattern {
    /// The sources of each block of this pattern alone, by column and row modulo [`Pattern::PERIOD`].
    fn sources(self) -> Vec<u32> {
        let [columns, rows] = Self::PERIOD;
        // Far enough from 0 that no source is left of or above it.
        let around = UVec2::new(columns, rows) * 2;
        let blocks = (0..rows).flat_map(|y| (0..columns).map(move |x| UVec2::new(x, y)));
        let of = |block: UVec2| {
            let is_shaded = |down: i32, column: u32| {
                let offset = IVec2::new(column as i32 - REACH as i32, down);
                self.shades_inside((around + block).saturating_add_signed(offset))
            };
            let row = |down| (0..WINDOW).map(|column| u32::from(is_shaded(down, column)) << column).sum();
            encode(nearest(row))
        };
        blocks.map(of).collect()
    }
}

/// The sources within each pattern, computed once.
#[derive(Clone, Debug)]
pub(super) struct PatternSources(Vec<(Pattern, Vec<u32>)>);

impl PatternSources {
    pub(super) fn new() -> Self {
        let rates = [ShadingRate::R2X1, ShadingRate::R2X2, ShadingRate::R4X2, ShadingRate::R4X4];
        Self(rates.map(Pattern::of).map(|pattern| (pattern, pattern.sources())).to_vec())
    }

    /// Sources of a row of blocks of a pattern; `None` for the pattern that skips nothing.
    fn row(&self, pattern: Pattern, y: u32) -> Option<RowSources> {
        let (_, sources) = self.0.iter().find(|(known, _)| *known == pattern)?;
        let [columns, rows] = Pattern::PERIOD;
        let row = sources.get((y % rows * columns) as usize..)?;
        row.first_chunk().copied().map(RowSources)
    }
}

/// The sources in a row of one pattern, by column modulo the period.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSources([u32; Pattern::PERIOD[0] as usize]);

impl RowSources {
    /// Sources of a block in a column, in the form of [`encode`].
    pub(super) fn at(self, x: u32) -> u32 {
        self.0[(x % Pattern::PERIOD[0]) as usize]
    }
}

/// For each tile of a row of tiles the pattern that all around it have too, as far as sources reach. Kept, so that a frame
/// allocates nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct PatternsAround(Vec<Option<Pattern>>);

impl PatternsAround {
    /// With memory for so many tiles.
    pub(super) fn with_capacity(tiles: usize) -> Self {
        Self(Vec::with_capacity(tiles))
    }
}

/// Finds the sources of the blocks of one view, row by row.
pub(super) struct SourceFinder<'a, 'b> {
    view: &'a MaskView<'b>,
    patterns: &'a PatternSources,
    /// The first block, and the one after the last.
    blocks: (UVec2, UVec2),
    /// Blocks in a tile; `None` if tiles are not whole blocks.
    tile: Option<UVec2>,
    around: &'a mut PatternsAround,
    /// The row of tiles that `around` is of.
    row: Option<u32>,
}

impl<'a, 'b> SourceFinder<'a, 'b> {
    /// For a view that has the blocks from the first of `blocks` on up to, not including, the second.
    pub(super) fn new(
        view: &'a MaskView<'b>,
        patterns: &'a PatternSources,
        blocks: (UVec2, UVec2),
        around: &'a mut PatternsAround,
    ) -> Self {
        let texel = UVec2::from(view.tiles.texel).max(UVec2::ONE);
        let tile = (texel % BLOCK == UVec2::ZERO).then(|| texel / BLOCK);
        Self { view, patterns, blocks, tile, around, row: None }
    }

    /// The column up to which the blocks of a row from `block` on are alike: with the sources that are returned, or else
    /// each with its own.
    pub(super) fn run(&mut self, block: UVec2) -> (u32, Option<RowSources>) {
        let (first, end) = self.blocks;
        let margin = REACH_IN_PATTERN + 1;
        let (inner, inner_end) = (first + margin, end.saturating_sub(UVec2::splat(margin)));
        let Some(tile) = self.tile else { return (end.x, None) };
        if block.y < inner.y || block.y >= inner_end.y || block.x >= inner_end.x {
            return (end.x, None);
        }
        if block.x < inner.x {
            return (inner.x.min(end.x), None);
        }
        let tile_end = (block.x / tile.x + 1) * tile.x;
        let pattern = self.pattern_around(block / tile);
        (tile_end.min(inner_end.x), pattern.and_then(|pattern| self.patterns.row(pattern, block.y)))
    }

    /// The pattern of a tile, where all tiles have it that [`Pattern::sources`] could reach.
    fn pattern_around(&mut self, tile: UVec2) -> Option<Pattern> {
        if self.row != Some(tile.y) {
            self.row = Some(tile.y);
            let columns = self.tile.map_or(0, |blocks| self.blocks.1.x.div_ceil(blocks.x));
            self.around.0.clear();
            for x in 0..columns {
                let pattern = self.alike(UVec2::new(x, tile.y));
                self.around.0.push(pattern);
            }
        }
        self.around.0.get(tile.x as usize).copied().flatten()
    }

    fn alike(&self, tile: UVec2) -> Option<Pattern> {
        let texel = UVec2::from(self.view.tiles.texel).max(UVec2::ONE);
        let reach = (texel - 1 + REACH_IN_PATTERN * BLOCK) / texel;
        let pattern = Pattern::of(self.view.tiles.rate(tile));
        let rows = tile.y.saturating_sub(reach.y)..=tile.y + reach.y;
        let mut around = rows
            .flat_map(|y| (tile.x.saturating_sub(reach.x)..=tile.x + reach.x).map(move |x| UVec2::new(x, y)));
        let is_alike =
            |other| Pattern::of(self.view.tiles.rate(other)) == pattern && !self.view.tiles.is_stale(other);
        around.all(is_alike).then_some(pattern)
    }
}
