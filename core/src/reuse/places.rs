//! Positions of an image's tiles in earlier images, and the coverage of each tile there.
//!
//! Both hardly change from one tile to the next: tiles are placed in blocks, by the corners of a block and a bound for the inside of it. Blocks
//! side by side that reach equally far from their own place are one stretch, and a stretch of a row is answered with bits of the earlier
//! picture's rows. A block gives each of its tiles a little more than the tile takes, so a picture that has all of a tile may count as having
//! a part of it, and never the other way round.

mod bounds;

use super::history::Earlier;
use super::reach::{EdgeReach, Frame, Placed, ROUNDING, Reach, Reaches, greatest, least};
use super::rects::Edge;
use super::{MAX_AGES, Reuse, bits};
use crate::geometry::PixelRect;
use bounds::Bounds;
use glam::Vec2;
use std::array;

/// Columns and rows of a block: with more, tiles of a turning head are given more than they take, with fewer, there are more blocks.
const BLOCK: u32 = 4;

/// Coverage of a tile by an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Has {
    Nothing,
    Part,
    All,
}

/// Tiles of a row that an image covers, as bits.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    /// Tiles that it covers in full.
    pub(super) all: Vec<u64>,
    /// Tiles that it covers in part or in full, or, at times, not at all.
    pub(super) any: Vec<u64>,
}

/// The places of the newest picture's tiles in each earlier picture, worked out for a row of blocks when that is first asked for. Memory is
/// only asked for beyond the largest picture so far.
#[derive(Clone, Debug, Default)]
pub(super) struct TilePlaces {
    ages: [AgePlaces; MAX_AGES],
    blocks: Blocks,
    /// Width of edges of tiles, pixels.
    border: f32,
}

/// Division of the newest image into blocks.
#[derive(Clone, Debug, Default)]
struct Blocks {
    /// x of the edges between them, tiles.
    edges: Vec<f32>,
    /// Columns of tiles.
    columns: u32,
    /// Width and height of the picture, tiles.
    across: Vec2,
    /// Width and height of edges of tiles, tiles; none where no edge is asked for.
    strip: Option<Vec2>,
}

/// The places in one earlier picture.
#[derive(Clone, Debug, Default)]
struct AgePlaces {
    frame: Frame,
    /// Reach of tiles.
    tiles: Stretches<Reach>,
    /// Reach of their edges.
    edges: Stretches<EdgeReach>,
    reaches: Reaches,
    far: Bounds,
    /// Of content as near as can be, where the head has moved.
    near: Bounds,
}

/// Rows of blocks, in stretches that are alike.
#[derive(Clone, Debug, Default)]
struct Stretches<Reach> {
    /// For each stretch of each row of blocks, from the end of the stretch before: the column of tiles after the last one, and the reach of
    /// each tile; `None` if each tile has its own.
    all: Vec<(u32, Option<Reach>)>,
    /// The end of each row of blocks in `all`.
    ends: Vec<usize>,
}

impl TilePlaces {
    /// Begins with another newest picture, whose tiles have edges of `border` pixels, or half of a tile where that is less; of no
    /// pixels where no edge is asked for.
    pub(super) fn begin(&mut self, reuse: &Reuse, border: f32) {
        let now = reuse.now();
        let (across, [columns, _]) = (now.stale.tiles_across(), now.stale.tiles());
        self.border = border;
        let Blocks { edges, .. } = &mut self.blocks;
        edges.clear();
        edges.extend((0..=columns.div_ceil(BLOCK)).map(|block| least((block * BLOCK) as f32, across.x)));
        (self.blocks.columns, self.blocks.across) = (columns, across);
        self.blocks.strip = (border > 0.0).then(|| (now.tiles_per_pixel() * border).min(Vec2::splat(0.5)));
        for (age, earlier) in self.ages.iter_mut().zip(reuse.earlier()) {
            age.begin(reuse, earlier);
        }
    }

    /// Finds the `wanted` tiles of a row that the earlier image at place `index`, the newest first, covers.
    pub(super) fn find(
        &mut self,
        reuse: &Reuse,
        (index, earlier): (usize, &Earlier),
        row: u32,
        wanted: &[u64],
        found: &mut Found,
    ) {
        let Found { all, any } = found;
        for bits in [&mut *all, &mut *any] {
            bits.clear();
            bits.resize(wanted.len(), 0);
        }
        let Self { ages, blocks, .. } = self;
        let age = &mut ages[index];
        age.work_out(blocks, row);
        let stale = earlier.picture.stale;
        let has = |column: u32| earlier.has_rect(&reuse.tiles([column, row], [1, 1]));
        for (word, of_word, reach) in age.tiles.words(row) {
            let of_word = wanted[word] & of_word;
            if of_word == 0 {
                continue;
            }
            let column = (word * bits::WORD) as u32;
            match reach {
                Some(reach) => {
                    let (mut is_all, is_any) =
                        reach.fresh([column as i32, row as i32], |row| stale.fresh_row(row));
                    is_all &= of_word;
                    if is_all != 0 {
                        let leaving = is_all & reach.beyond().leaving(&age.frame, blocks.across, word, row);
                        for bit in bits::columns(&[leaving]) {
                            is_all &= !(u64::from(has(column + bit) != Has::All) << bit);
                        }
                    }
                    all[word] |= is_all;
                    any[word] |= is_any & of_word;
                }
                None => {
                    for bit in bits::columns(&[of_word]) {
                        let has = has(column + bit);
                        all[word] |= u64::from(has == Has::All) << bit;
                        any[word] |= u64::from(has != Has::Nothing) << bit;
                    }
                }
            }
        }
    }

    /// Finds, for each of [`Edge::ALL`], the `wanted` tiles of a row whose whole edge is in the earlier picture at place `index`.
    pub(super) fn find_edges(
        &mut self,
        reuse: &Reuse,
        (index, earlier): (usize, &Earlier),
        row: u32,
        wanted: &[Vec<u64>; Edge::ALL.len()],
        found: &mut [Vec<u64>; Edge::ALL.len()],
    ) {
        for (found, wanted) in found.iter_mut().zip(wanted) {
            found.clear();
            found.resize(wanted.len(), 0);
        }
        let Self { ages, blocks, border } = self;
        let age = &mut ages[index];
        age.work_out(blocks, row);
        let stale = earlier.picture.stale;
        for (word, of_word, reach) in age.edges.words(row) {
            let wanted = wanted.each_ref().map(|wanted| wanted[word] & of_word);
            if wanted.iter().all(|wanted| *wanted == 0) {
                continue;
            }
            let column = (word * bits::WORD) as u32;
            let (fresh, leaving) = match reach {
                Some(reach) => (
                    reach.fresh([column as i32, row as i32], |row| stale.fresh_row(row)),
                    reach.beyond().leaving(&age.frame, blocks.across, word, row),
                ),
                None => ([u64::MAX; Edge::ALL.len()], u64::MAX),
            };
            for ((wanted, fresh), (found, edge)) in
                wanted.into_iter().zip(fresh).zip(found.iter_mut().zip(Edge::ALL))
            {
                let mut had = wanted & fresh & !leaving;
                for bit in bits::columns(&[wanted & fresh & leaving]) {
                    let rect = reuse.edge([column + bit, row], edge, *border);
                    had |= u64::from(earlier.has_rect(&rect) == Has::All) << bit;
                }
                found[word] |= had;
            }
        }
    }
}

impl<Reach> Stretches<Reach> {
    fn clear(&mut self) {
        self.all.clear();
        self.ends.clear();
    }

    /// Adds a row of blocks, by the blocks after the last ones of its stretches.
    fn add_row(&mut self, columns: u32, stretches: impl Iterator<Item = (usize, Option<Reach>)>) {
        self.all.extend(stretches.map(|(end, reach)| ((end as u32 * BLOCK).min(columns), reach)));
        self.ends.push(self.all.len());
    }

    /// For each stretch of a row and each of its words: the word's index, its tiles as bits, and their reach.
    fn words(&self, row: u32) -> impl Iterator<Item = (usize, u64, Option<&Reach>)> {
        let block = (row / BLOCK) as usize;
        let first = block.checked_sub(1).map_or(0, |above| self.ends[above]);
        let mut begin = 0;
        self.all[first..self.ends[block]].iter().flat_map(move |(end, reach)| {
            let ends = [begin, *end];
            begin = *end;
            let words = ends[0] as usize / bits::WORD..bits::words(ends[1]);
            words.map(move |word| (word, bits::range(word, ends), reach.as_ref()))
        })
    }
}

impl AgePlaces {
    fn begin(&mut self, reuse: &Reuse, earlier: &Earlier) {
        self.frame = Frame::of(earlier);
        self.tiles.clear();
        self.edges.clear();
        // A picture without tiles counts as one tile, which no block has a share in.
        let has_tiles = earlier.picture.stale.tiles() != [0; 2];
        self.far.begin(has_tiles.then_some(earlier.matrix), reuse, earlier);
        self.near.begin(earlier.near_matrix().filter(|_| has_tiles), reuse, earlier);
    }

    /// Works out the rows of blocks up to that of a row of tiles.
    #[inline]
    fn work_out(&mut self, blocks: &Blocks, row: u32) {
        while self.tiles.ends.len() <= (row / BLOCK) as usize {
            self.add_row(blocks);
        }
    }

    /// Works out the next row of blocks.
    #[cold]
    fn add_row(&mut self, blocks: &Blocks) {
        let Blocks { edges, columns, across, strip } = blocks;
        let block = self.tiles.ends.len() as u32;
        let lines = [block, block + 1].map(|line| least((line * BLOCK) as f32, across.y));
        if !self.far.set(edges, lines) {
            let unknown = [edges.len() - 1];
            self.tiles.add_row(*columns, unknown.into_iter().map(|end| (end, None)));
            self.edges.add_row(*columns, unknown.into_iter().map(|end| (end, None)));
            return;
        }
        if self.near.is_known() {
            self.near.set(edges, lines);
            self.far.enclose(&self.near);
        }
        let Bounds { low, high, .. } = &self.far;
        let placed =
            Placed { low: low.each_ref().map(Vec::as_slice), high: high.each_ref().map(Vec::as_slice) };
        self.reaches.set(&placed, &self.frame, *strip);
        self.tiles.add_row(*columns, self.reaches.stretches());
        self.edges.add_row(*columns, self.reaches.edge_stretches());
    }
}

impl Earlier<'_> {
    /// Coverage of a rectangle of the newest image by this one.
    pub(super) fn has_rect(&self, rect: &PixelRect) -> Has {
        let PixelRect { min, max } = *rect;
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for matrix in std::iter::once(self.matrix).chain(self.near_matrix()) {
            for corner in [min, Vec2::new(max.x, min.y), Vec2::new(min.x, max.y), max] {
                let found = matrix * corner.extend(1.0);
                if found.z <= 0.0 || found.z.is_nan() {
                    return Has::Part;
                }
                let at = found.truncate() / found.z * self.tiles_per_pixel;
                low = Vec2::new(least(low.x, at.x), least(low.y, at.y));
                high = Vec2::new(greatest(high.x, at.x), greatest(high.y, at.y));
            }
        }
        let frame = Frame::of(self);
        let (low, high) = (low - Vec2::from(frame.margin), high + Vec2::from(frame.margin));
        let is_beside = |axis: usize| high[axis] <= 0.0 || low[axis] >= frame.across[axis];
        let is_beyond = |axis: usize| low[axis] < 0.0 || high[axis] > frame.across[axis];
        if (0..2).any(is_beside) {
            return Has::Nothing;
        }
        let tile = |at: Vec2| array::from_fn(|axis| greatest(least(at[axis], frame.last[axis]), 0.0) as u32);
        match self.picture.stale.kinds(tile(low + ROUNDING), tile(high - Vec2::from(frame.end) + ROUNDING)) {
            (false, _) => Has::Nothing,
            (true, false) if !(0..2).any(is_beyond) => Has::All,
            (true, _) => Has::Part,
        }
    }
}
