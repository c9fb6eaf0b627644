//! Tiles of an earlier image that the tiles of a block meet.

use super::bits;
use super::history::Earlier;
use super::rects::Edge;
use glam::Vec2;
use std::ops;

/// Pixels around a tile that its re-used pixels may be interpolated from, with room for rounding.
const MARGIN: f32 = 1.0;

/// A rectangle that ends where a tile begins does not reach into it, pixels.
const END: f32 = 0.5;

/// Up to this part of a tile is given away where a place becomes a whole number of tiles: rounding.
pub(super) const ROUNDING: f32 = 1.0 / 1024.0;

/// Most columns and rows of an earlier picture that a tile of a block is given: a block that would need more is placed tile by tile.
const MOST: i32 = 4;

/// An earlier picture, in its tiles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    pub(super) margin: [f32; 2],
    pub(super) end: [f32; 2],
    /// Width and height.
    pub(super) across: [f32; 2],
    /// The last column and row.
    pub(super) last: [f32; 2],
    /// Whether the border cuts off the last column and row.
    is_cut: [bool; 2],
    /// Tolerance of blocks for rounding, tiles; negative: an extension.
    given: f32,
}

impl Frame {
    pub(super) fn of(earlier: &Earlier) -> Self {
        let tiles = earlier.tiles_per_pixel;
        let pixels = if earlier.is_still { [0.0, END] } else { [MARGIN, 0.0] };
        let [margin, end] = pixels.map(|pixels| (tiles * pixels).to_array());
        let across = (tiles * earlier.picture.size()).to_array();
        let count = earlier.picture.stale.tiles().map(|count| count as f32);
        Self {
            margin,
            end,
            across,
            last: count.map(|count| if count > 1.0 { count - 1.0 } else { 0.0 }),
            is_cut: [0, 1].map(|axis: usize| count[axis] > across[axis] + ROUNDING),
            given: if earlier.is_still { ROUNDING } else { -ROUNDING },
        }
    }
}

/// Columns, or rows, of an earlier picture from the first to the last one, counted from the one at a tile's own place on.
type Range = [i32; 2];

/// The tiles of an earlier picture that a tile of a block meets.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reach {
    columns: Range,
    rows: Range,
    beyond: Beyond,
}

impl Reach {
    /// For 64 tiles in a row from one on, as bits: whether all tiles are fresh that a tile meets, and whether any is.
    #[inline]
    pub(super) fn fresh<'a>(
        &self,
        [column, row]: [i32; 2],
        fresh_row: impl Fn(i32) -> &'a [u64],
    ) -> (u64, u64) {
        let ([left, right], [top, bottom]) = (self.columns, self.rows);
        let (mut all, mut any) = (u64::MAX, 0);
        for down in top..=bottom {
            let line = fresh_row(row + down);
            for across in left..=right {
                let fresh = bits::read(line, column + across);
                all &= fresh;
                any |= fresh;
            }
        }
        (all, any)
    }

    /// Reach of the tiles beyond their own ends.
    pub(super) fn beyond(&self) -> &Beyond {
        &self.beyond
    }
}

/// The tiles of an earlier picture that the edges of a tile of a block meet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EdgeReach {
    columns: EdgeRanges,
    rows: EdgeRanges,
    beyond: Beyond,
}

/// Ranges of edges at the left (or upper) side of a tile, from side to side, and at its right (or lower) side.
type EdgeRanges = [Range; 3];

impl EdgeReach {
    /// For 64 tiles in a row from one on, as bits: whether all tiles are fresh that an edge of a tile meets, of each of [`Edge::ALL`].
    #[inline]
    pub(super) fn fresh<'a>(
        &self,
        [column, row]: [i32; 2],
        fresh_row: impl Fn(i32) -> &'a [u64],
    ) -> [u64; Edge::ALL.len()] {
        // By side of the tile, down and across; the middle of both is the whole tile.
        let mut all = [[u64::MAX; 3]; 3];
        let ([_, [left, right], _], [_, [top, bottom], _]) = (self.columns, self.rows);
        for down in top..=bottom {
            let line = fresh_row(row + down);
            let mut of_line = [u64::MAX; 3];
            for across in left..=right {
                let fresh = bits::read(line, column + across);
                for (all, [first, last]) in of_line.iter_mut().zip(self.columns) {
                    *all &= if (first..=last).contains(&across) { fresh } else { u64::MAX };
                }
            }
            for (all, [first, last]) in all.iter_mut().zip(self.rows) {
                if (first..=last).contains(&down) {
                    all.iter_mut().zip(of_line).for_each(|(all, of_line)| *all &= of_line);
                }
            }
        }
        Edge::ALL.map(|Edge { across, down }| all[(down + 1) as usize][(across + 1) as usize])
    }

    /// Reach of the tiles beyond their own ends.
    pub(super) fn beyond(&self) -> &Beyond {
        &self.beyond
    }
}

/// Reach of tiles beyond their own right and lower ends in an earlier image, with room for rounding, tiles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beyond([f32; 2]);

impl Beyond {
    /// The tiles of a word of a row, as bits, that may reach beyond the border of an earlier picture within a tile which that cuts
    /// off: such a tile has no pixels there, unlike its bit. `across` is the newest picture's size, tiles.
    pub(super) fn leaving(&self, frame: &Frame, across: Vec2, word: usize, row: u32) -> u64 {
        let [x, y] = self.0;
        let is_beyond = |axis: usize, end: f32| frame.is_cut[axis] && end > frame.across[axis];
        if is_beyond(1, least((row + 1) as f32, across.y) + y) {
            return u64::MAX;
        }
        if !is_beyond(0, across.x + x) {
            return 0;
        }
        // A column ends one after its beginning.
        let first = floor(frame.across[0] - x).max(0) as u32;
        bits::range(word, [first, u32::MAX])
    }
}

/// Bounds of the displacement of each block of a row in an earlier image, tiles, x and y. The least is NaN for blocks that the image does
/// not show all of.
pub(super) struct Placed<'a> {
    pub(super) low: [&'a [f32]; 2],
    pub(super) high: [&'a [f32]; 2],
}

/// Reaches of a row of blocks, field by field for vector instructions.
#[derive(Clone, Debug, Default)]
pub(super) struct Reaches {
    sides: [Sides; 2],
    beyond: [Vec<f32>; 2],
    /// All bits of a block whose tiles need not be looked at one by one, none of another.
    is_known: Vec<i32>,
    /// Not 0 for a block with another reach than the block before it.
    differs: Vec<i32>,
    /// The same for reaches of edges.
    edges_differ: Vec<i32>,
}

/// Of each block: first and last of the columns (or rows) that a tile meets.
#[derive(Clone, Debug, Default)]
struct Sides {
    first: Vec<i32>,
    last: Vec<i32>,
    /// The first one that an edge at the tile's right (or lower) side meets.
    first_of_end: Vec<i32>,
    /// The last one that an edge at the tile's left (or upper) side meets.
    last_of_begin: Vec<i32>,
}

impl Reaches {
    /// Takes a row of blocks, whose tiles have edges that are `strip` of a tile wide and high, if edges are asked for.
    pub(super) fn set(&mut self, placed: &Placed, frame: &Frame, strip: Option<Vec2>) {
        let count = placed.low[0].len();
        refill(&mut self.is_known, count, -1);
        refill(&mut self.differs, count, 0);
        for axis in 0..2 {
            let (low, high) = (placed.low[axis], placed.high[axis]);
            let Sides { first, last, .. } = &mut self.sides[axis];
            let taken = ROUNDING - frame.given - frame.end[axis];
            let (before, after) = (frame.given - frame.margin[axis], frame.margin[axis]);
            set_floor(first, low, before);
            set_floor(last, high, 1.0 + after + taken);
            let beyond = &mut self.beyond[axis];
            beyond.clear();
            beyond.extend(high.iter().map(|high| high + (after - frame.given)));
            let most = (MOST + 1) as f32 + before - after;
            let farthest = frame.across[axis] + MOST as f32;
            let ranges = low.iter().zip(high).zip(first.iter().zip(&*last));
            for (is_known, ((low, high), (first, last))) in self.is_known.iter_mut().zip(ranges) {
                // Comparing so makes blocks unknown whose numbers are none.
                let is_near = (high - low < most) & ((low + before).abs() < farthest);
                *is_known &= -i32::from(is_near & (last.wrapping_sub(*first) < MOST));
            }
            compare(&mut self.differs, first);
            compare(&mut self.differs, last);
        }
        refill(&mut self.edges_differ, 0, 0);
        if let Some(strip) = strip {
            self.edges_differ.extend_from_slice(&self.differs);
            for axis in 0..2 {
                let Sides { first_of_end, last_of_begin, .. } = &mut self.sides[axis];
                let taken = ROUNDING - frame.given - frame.end[axis];
                set_floor(
                    first_of_end,
                    placed.low[axis],
                    1.0 - strip[axis] + frame.given - frame.margin[axis],
                );
                set_floor(last_of_begin, placed.high[axis], strip[axis] + frame.margin[axis] + taken);
                compare(&mut self.edges_differ, first_of_end);
                compare(&mut self.edges_differ, last_of_begin);
            }
        }
        for differs in [&mut self.differs, &mut self.edges_differ] {
            let pairs = self.is_known.windows(2).zip(differs.iter_mut().skip(1));
            pairs.for_each(|(pair, differs)| *differs = *differs & pair[1] | (pair[0] ^ pair[1]));
        }
    }

    /// For each stretch of blocks with one reach: the block after its last one, and the reach; `None` if each tile has its own.
    pub(super) fn stretches(&self) -> impl Iterator<Item = (usize, Option<Reach>)> {
        stretches(&self.differs).map(|blocks| {
            let reach = (self.is_known[blocks.start] != 0).then(|| {
                let [columns, rows] = self.sides.each_ref().map(|sides| sides.whole(blocks.start));
                Reach { columns, rows, beyond: self.beyond(&blocks) }
            });
            (blocks.end, reach)
        })
    }

    /// The same of the edges of tiles; none where no edge was asked for.
    pub(super) fn edge_stretches(&self) -> impl Iterator<Item = (usize, Option<EdgeReach>)> {
        stretches(&self.edges_differ).map(|blocks| {
            let reach = (self.is_known[blocks.start] != 0).then(|| {
                let [columns, rows] = self.sides.each_ref().map(|sides| sides.edges(blocks.start));
                EdgeReach { columns, rows, beyond: self.beyond(&blocks) }
            });
            (blocks.end, reach)
        })
    }

    fn beyond(&self, blocks: &ops::Range<usize>) -> Beyond {
        let most = |ends: &Vec<f32>| ends[blocks.clone()].iter().copied().fold(f32::NEG_INFINITY, greatest);
        Beyond(self.beyond.each_ref().map(most))
    }
}

impl Sides {
    fn whole(&self, block: usize) -> Range {
        [self.first[block], self.last[block]]
    }

    fn edges(&self, block: usize) -> EdgeRanges {
        let [first, last] = self.whole(block);
        [[first, self.last_of_begin[block]], [first, last], [self.first_of_end[block], last]]
    }
}

/// Ranges of blocks, each of which but the first does not differ from that before it.
fn stretches(differs: &[i32]) -> impl Iterator<Item = ops::Range<usize>> {
    let mut begin = 0;
    std::iter::from_fn(move || {
        let first = begin;
        let others = differs.get(first + 1..).unwrap_or_default();
        begin = first + 1 + others.iter().position(|differs| *differs != 0).unwrap_or(others.len());
        (first < differs.len()).then_some(first..begin)
    })
}

fn refill(values: &mut Vec<i32>, count: usize, value: i32) {
    values.clear();
    values.resize(count, value);
}

/// The [`floor`] of numbers that are greater by so much. A function of its own, as vector instructions take slices that are known to be apart.
#[inline(never)]
fn set_floor(out: &mut Vec<i32>, numbers: &[f32], more: f32) {
    out.clear();
    out.extend(numbers.iter().map(|number| floor(number + more)));
}

/// Adds where values differ from those before them.
#[inline(never)]
fn compare(differs: &mut [i32], values: &[i32]) {
    let pairs = values.iter().zip(values.iter().skip(1));
    differs.iter_mut().skip(1).zip(pairs).for_each(|(differs, (before, value))| *differs |= before ^ value);
}

/// The greatest whole number that is not above one of up to 2^22, or the one below that where it is whole itself. Rounds as the sum leaves no
/// bits for a fraction, without the checks of a conversion.
#[inline]
fn floor(number: f32) -> i32 {
    const SHIFT: f32 = (3 << 22) as f32;
    (number - 0.5 + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits()) as i32
}

/// The smaller one, as one instruction: `f32::min` has to look for NaN.
pub(super) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater one, likewise.
pub(super) fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
