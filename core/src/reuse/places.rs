//! Where the tiles of a picture lie in earlier pictures, and how much of each those have.
//!
//! From one tile to the next that hardly changes: tiles are placed in blocks, by the corners of a block and a bound for the inside of it. Blocks
//! side by side that reach equally far from their own place are one stretch, and a stretch of a row is answered with bits of the earlier
//! picture's rows. A block gives each of its tiles a little more than the tile takes, so a picture that has all of a tile may count as having
//! a part of it, and never the other way round.

use super::history::Earlier;
use super::reach::{Frame, Placed, ROUNDING, Reach};
use super::rects::Edge;
use super::{MAX_AGES, Reuse, bits};
use crate::geometry::PixelRect;
use glam::{Mat3, Vec2, Vec3};
use std::array;

/// Columns and rows of a block: with more, tiles of a turning head are given more than they take, with fewer, there are more blocks.
const BLOCK: u32 = 4;

/// How much of a tile a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Has {
    Nothing,
    Part,
    All,
}

/// Which tiles of a row a picture has, as bits.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    /// All of them.
    pub(super) all: Vec<u64>,
    /// Any of them, or, at times, nothing.
    pub(super) any: Vec<u64>,
}

/// The places of the newest picture's tiles in each earlier picture, worked out for a row of blocks when that is first asked for. Memory is
/// only asked for beyond the largest picture so far.
#[derive(Clone, Debug, Default)]
pub(super) struct TilePlaces {
    ages: [AgePlaces; MAX_AGES],
    /// x of the edges between blocks, tiles.
    edges: Vec<f32>,
    /// Width of edges of tiles, pixels.
    border: f32,
}

/// The places in one earlier picture.
#[derive(Clone, Debug, Default)]
struct AgePlaces {
    /// Row of blocks after row of blocks.
    stretches: Vec<Stretch>,
    /// The end of each row of blocks that is worked out in `stretches`.
    ends: Vec<usize>,
    /// Of each block of these rows: how it lies; `None` where its tiles are looked at one by one.
    blocks: Vec<Option<Placed>>,
    far: Bounds,
    /// Of content as near as can be, where the head has moved.
    near: Bounds,
}

/// Tiles of a row, from the end of the stretch before.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    end: u32,
    /// `None` where each tile has its own.
    reach: Option<Reach>,
}

impl TilePlaces {
    /// Begins with another newest picture, whose tiles have edges of `border` pixels, or half of a tile where that is less.
    pub(super) fn begin(&mut self, reuse: &Reuse, border: f32) {
        let now = reuse.now();
        let across = now.stale.tiles_across().x;
        self.border = border;
        self.edges.clear();
        let blocks = now.stale.tiles()[0].div_ceil(BLOCK);
        self.edges.extend((0..=blocks).map(|block| least((block * BLOCK) as f32, across)));
        for (age, earlier) in self.ages.iter_mut().zip(reuse.earlier()) {
            age.begin(reuse, earlier);
        }
    }

    /// Which of the `wanted` tiles of a row the earlier picture at place `index`, the newest first, has.
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
        let (frame, stale) = (Frame::of(earlier), earlier.picture.stale);
        let mut begin = 0;
        for stretch in self.ages[index].row(reuse, earlier, &self.edges, row) {
            let ends = [begin, stretch.end];
            begin = stretch.end;
            for word in ends[0] as usize / bits::WORD..bits::words(ends[1]) {
                let of_word = wanted[word] & bits::range(word, ends);
                if of_word == 0 {
                    continue;
                }
                let column = (word * bits::WORD) as u32;
                match stretch.reach {
                    Some(reach) => {
                        let at = [column as i32, row as i32];
                        let (mut is_all, is_any) = reach.fresh(at, |row| stale.fresh_row(row));
                        for bit in bits::columns(&[is_all & of_word & reach.meets_cut(&frame, word, row)]) {
                            let has = earlier.has_rect(&reuse.tiles([column + bit, row], [1, 1]));
                            is_all &= !(u64::from(has != Has::All) << bit);
                        }
                        all[word] |= is_all & of_word;
                        any[word] |= is_any & of_word;
                    }
                    None => {
                        for bit in bits::columns(&[of_word]) {
                            let has = earlier.has_rect(&reuse.tiles([column + bit, row], [1, 1]));
                            all[word] |= u64::from(has == Has::All) << bit;
                            any[word] |= u64::from(has != Has::Nothing) << bit;
                        }
                    }
                }
            }
        }
    }

    /// Of which of the `wanted` tiles of a row the earlier picture at place `index` has all of an edge.
    pub(super) fn find_edges(
        &mut self,
        reuse: &Reuse,
        (index, earlier): (usize, &Earlier),
        edge: Edge,
        row: u32,
        wanted: &[u64],
        found: &mut Vec<u64>,
    ) {
        found.clear();
        found.resize(wanted.len(), 0);
        let age = &mut self.ages[index];
        age.row(reuse, earlier, &self.edges, row);
        let blocks = &age.blocks[(row / BLOCK) as usize * (self.edges.len() - 1)..];
        let (frame, stale) = (Frame::of(earlier), earlier.picture.stale);
        let strip = (reuse.now().tiles_per_pixel() * self.border).min(Vec2::splat(0.5));
        let has_edge =
            |column: u32| earlier.has_rect(&reuse.edge([column, row], edge, self.border)) == Has::All;
        for column in bits::columns(wanted) {
            let is_had = match blocks.get((column / BLOCK) as usize).copied().flatten() {
                Some(placed) => {
                    let reach = placed.edge_reach(&frame, edge, strip);
                    let word = column as usize / bits::WORD;
                    let is_cut =
                        reach.meets_cut(&frame, word, row) >> (column as usize % bits::WORD) & 1 == 1;
                    reach.is_fresh([column as i32, row as i32], |row| stale.fresh_row(row))
                        && (!is_cut || has_edge(column))
                }
                None => has_edge(column),
            };
            found[column as usize / bits::WORD] |= u64::from(is_had) << (column as usize % bits::WORD);
        }
    }
}

impl AgePlaces {
    fn begin(&mut self, reuse: &Reuse, earlier: &Earlier) {
        self.stretches.clear();
        self.ends.clear();
        self.blocks.clear();
        // A picture without tiles counts as one tile, which no block has a share in.
        let has_tiles = earlier.picture.stale.tiles() != [0; 2];
        self.far.begin(has_tiles.then_some(earlier.matrix), reuse, earlier);
        self.near.begin(earlier.near_matrix().filter(|_| has_tiles), reuse, earlier);
    }

    /// The stretches of a row of tiles.
    fn row(&mut self, reuse: &Reuse, earlier: &Earlier, edges: &[f32], row: u32) -> &[Stretch] {
        let block = (row / BLOCK) as usize;
        while self.ends.len() <= block {
            self.add_row(reuse, earlier, edges);
        }
        let begin = block.checked_sub(1).map_or(0, |above| self.ends[above]);
        &self.stretches[begin..self.ends[block]]
    }

    /// Works out the next row of blocks.
    #[cold]
    fn add_row(&mut self, reuse: &Reuse, earlier: &Earlier, edges: &[f32]) {
        let now = reuse.now();
        let [columns, _] = now.stale.tiles();
        let block = self.ends.len() as u32;
        let lines = [block, block + 1].map(|line| least((line * BLOCK) as f32, now.stale.tiles_across().y));
        if self.far.set(edges, lines) {
            if self.near.map.is_some() {
                self.near.set(edges, lines);
                self.far.enclose(&self.near);
            }
            let frame = Frame::of(earlier);
            let Bounds { low: [low_x, low_y], high: [high_x, high_y], .. } = &self.far;
            let places = low_x.iter().zip(low_y).zip(high_x.iter().zip(high_y));
            let mut last = None;
            for (index, ((low_x, low_y), (high_x, high_y))) in places.enumerate() {
                let placed = Placed { low: Vec2::new(*low_x, *low_y), high: Vec2::new(*high_x, *high_y) };
                let reach = placed.reach(&frame);
                let end = ((index as u32 + 1) * BLOCK).min(columns);
                self.blocks.push(reach.map(|_| placed));
                match self.stretches.last_mut().filter(|_| last == Some(reach)) {
                    Some(stretch) => stretch.end = end,
                    None => self.stretches.push(Stretch { end, reach }),
                }
                last = Some(reach);
            }
        } else {
            self.stretches.push(Stretch { end: columns, reach: None });
            self.blocks.resize(self.blocks.len() + edges.len() - 1, None);
        }
        self.ends.push(self.stretches.len());
    }
}

/// How far each block of a row lies from its own place in an earlier picture, tiles of that.
#[derive(Clone, Debug, Default)]
struct Bounds {
    map: Option<Map>,
    /// The least, x and y; NaN for blocks that the picture does not show all of.
    low: [Vec<f32>; 2],
    /// The greatest, x and y.
    high: [Vec<f32>; 2],
    /// x and y of the corners along the upper and the lower edge.
    upper: [Vec<f32>; 2],
    lower: [Vec<f32>; 2],
    /// y of the lower edge, tiles of the newest picture.
    line: Option<f32>,
}

/// From tiles of the newest picture to those of an earlier one.
#[derive(Clone, Copy, Debug)]
struct Map {
    matrix: Mat3,
    /// How far the inside of a block may lie beyond the range of its corners, x and y, tiles.
    bend: Vec2,
}

impl Bounds {
    fn begin(&mut self, matrix: Option<Mat3>, reuse: &Reuse, earlier: &Earlier) {
        self.line = None;
        self.map = matrix.map(|matrix| {
            let size = 1.0 / reuse.now().tiles_per_pixel();
            let matrix = Mat3::from_diagonal(earlier.tiles_per_pixel.extend(1.0))
                * matrix
                * Mat3::from_diagonal(size.extend(1.0));
            Map { matrix, bend: bend(&matrix, reuse.now().stale.tiles_across()) }
        });
    }

    /// Goes on to the row of blocks between two lines; false where there is nothing to go by.
    fn set(&mut self, edges: &[f32], [top, bottom]: [f32; 2]) -> bool {
        let Some(Map { matrix, bend }) = &self.map else { return false };
        std::mem::swap(&mut self.upper, &mut self.lower);
        if self.line != Some(top) {
            fill_line(&mut self.upper, matrix, edges, top);
        }
        fill_line(&mut self.lower, matrix, edges, bottom);
        self.line = Some(bottom);
        for axis in 0..2 {
            let (low, high) = (&mut self.low[axis], &mut self.high[axis]);
            low.resize(edges.len() - 1, 0.0);
            high.resize(edges.len() - 1, 0.0);
            bound(&self.upper[axis], &self.lower[axis], bend[axis], low, high);
        }
        true
    }

    /// Widens the ranges to include others of the same blocks.
    fn enclose(&mut self, other: &Self) {
        for axis in 0..2 {
            let ranges = self.low[axis].iter_mut().zip(&mut self.high[axis]);
            for ((low, high), (least_of, most_of)) in
                ranges.zip(other.low[axis].iter().zip(&other.high[axis]))
            {
                // NaN in either stays.
                *low = if *least_of >= *low { *low } else { *least_of };
                *high = greatest(*high, *most_of);
            }
        }
    }
}

/// Takes the corners of one line of blocks to where a matrix leads, from where they are: both in tiles. NaN for corners that are not shown.
fn fill_line([xs, ys]: &mut [Vec<f32>; 2], matrix: &Mat3, edges: &[f32], line: f32) {
    let start = matrix.y_axis * line + matrix.z_axis;
    let along = matrix.x_axis;
    xs.resize(edges.len(), 0.0);
    ys.resize(edges.len(), 0.0);
    for ((edge, x), y) in edges.iter().zip(xs).zip(ys) {
        let depth = along.z * edge + start.z;
        let scale = if depth > 0.0 { 1.0 / depth } else { f32::NAN };
        *x = (along.x * edge + start.x) * scale - edge;
        *y = (along.y * edge + start.y) * scale - line;
    }
}

/// The least and the greatest of the four corners of each block between two lines, with what its inside may lie beyond them. NaN stays in
/// the least.
fn bound(upper: &[f32], lower: &[f32], bend: f32, low: &mut [f32], high: &mut [f32]) {
    let count = low.len();
    let [a, b, c, d] = [&upper[..count], &upper[1..=count], &lower[..count], &lower[1..=count]];
    let high = &mut high[..count];
    for i in 0..count {
        // 0 or NaN.
        let nothing = ((a[i] + b[i]) + (c[i] + d[i])) * 0.0;
        low[i] = least(least(a[i], b[i]), least(c[i], d[i])) - bend + nothing;
        high[i] = greatest(greatest(a[i], b[i]), greatest(c[i], d[i])) + bend;
    }
}

/// The most by which the inside of a block may lie beyond the range of its corners: what a matrix does to points of a picture of that size
/// differs from what is interpolated between four of them by at most an eighth of the square of their distance times the second
/// derivative, on each axis. NaN or infinite where some point of the picture is not shown.
fn bend(matrix: &Mat3, across: Vec2) -> Vec2 {
    let rows = matrix.transpose();
    let depth = |x: f32, y: f32| rows.z_axis.dot(Vec3::new(x, y, 1.0));
    let corners = [depth(0.0, 0.0), depth(across.x, 0.0), depth(0.0, across.y), depth(across.x, across.y)];
    let nearest = corners.into_iter().fold(f32::INFINITY, least);
    if nearest <= 0.0 {
        return Vec2::INFINITY;
    }
    let side = BLOCK as f32;
    let of = |row: Vec3| {
        let steepest = |axis: usize| {
            // The first derivative along an axis is this by the square of the depth, and linear along the other axis.
            let other = 1 - axis;
            let slope = |at: f32| {
                let (point, depth) = (row[other] * at + row.z, rows.z_axis[other] * at + rows.z_axis.z);
                row[axis] * depth - rows.z_axis[axis] * point
            };
            greatest(slope(0.0).abs(), slope(across[other]).abs()) * rows.z_axis[axis].abs() * 2.0
        };
        (steepest(0) + steepest(1)) / (nearest * nearest * nearest) * (side * side / 8.0)
    };
    Vec2::new(of(rows.x_axis), of(rows.y_axis))
}

/// The smaller one, as one instruction: `f32::min` has to look for NaN.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater one, likewise.
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl Earlier<'_> {
    /// How much this picture has of a rectangle of the newest one.
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
