//! Where the tiles of a picture lie in earlier pictures, and how much of a tile those have.
//!
//! Earlier pictures are measured in their own tiles, row by row of the newest picture: all tiles of a row are worked out together.

use super::history::Earlier;
use super::{MAX_AGES, Reuse};
use crate::geometry::PixelRect;
use glam::{Mat3, Vec2};

/// Pixels around a tile that its re-used pixels may be interpolated from, with room for rounding.
const MARGIN: f32 = 1.0;

/// A rectangle that ends where a tile begins does not reach into it, pixels.
const END: f32 = 0.5;

/// How much of a tile a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Has {
    Nothing,
    Part,
    All,
}

/// The places of one row of the newest picture's tiles in each earlier picture, worked out for an age when it is first asked for. Memory is
/// only asked for beyond the longest row so far.
#[derive(Clone, Debug, Default)]
pub(super) struct TilePlaces {
    ages: [AgePlaces; MAX_AGES],
    /// x of the corners in a row of the newest picture, pixels.
    corners: Vec<f32>,
}

/// The places in one earlier picture.
#[derive(Clone, Debug, Default)]
struct AgePlaces {
    /// The row that is worked out.
    row: Option<u32>,
    far: Row,
    /// Of content as near as can be, where the head has moved.
    near: Row,
    places: Places,
}

impl TilePlaces {
    /// Begins with another newest picture.
    pub(super) fn begin(&mut self, reuse: &Reuse) {
        for age in &mut self.ages {
            age.row = None;
            age.far.row = None;
            age.near.row = None;
        }
        let now = reuse.now();
        let (size, extent) = (1.0 / now.tiles_per_pixel().x, now.size().x);
        self.corners.clear();
        self.corners.extend((0..=now.stale.tiles()[0]).map(|column| least(column as f32 * size, extent)));
    }

    /// How much the earlier picture at place `index`, the newest first, has of a tile.
    #[inline]
    pub(super) fn tile_in(
        &mut self,
        reuse: &Reuse,
        index: usize,
        earlier: &Earlier,
        [column, row]: [u32; 2],
    ) -> Has {
        let age = &mut self.ages[index];
        if age.row != Some(row) {
            age.set_row(reuse, earlier, &self.corners, row);
        }
        age.places.at(column as usize).has(earlier)
    }
}

impl AgePlaces {
    #[cold]
    fn set_row(&mut self, reuse: &Reuse, earlier: &Earlier, corners: &[f32], row: u32) {
        self.row = Some(row);
        self.far.set(reuse, &earlier.matrix, earlier.tiles_per_pixel, corners, row);
        if let Some(matrix) = earlier.near_matrix() {
            self.near.set(reuse, &matrix, earlier.tiles_per_pixel, corners, row);
            self.far.enclose(&self.near);
        }
        self.places.set(&self.far, &Frame::of(earlier));
    }
}

/// A row of tiles in an earlier picture, in its tiles. NaN for corners that it does not show.
#[derive(Clone, Debug, Default)]
struct Row {
    row: Option<u32>,
    /// x and y of the corners along the upper and the lower edge.
    upper: [Vec<f32>; 2],
    lower: [Vec<f32>; 2],
    /// The smallest upright rectangle around each tile, x and y.
    low: [Vec<f32>; 2],
    high: [Vec<f32>; 2],
    /// NaN for tiles that the picture does not show all of.
    shown: Vec<f32>,
}

impl Row {
    fn set(&mut self, reuse: &Reuse, matrix: &Mat3, tiles_per_pixel: Vec2, corners: &[f32], row: u32) {
        let now = reuse.now();
        let (size, extent) = (1.0 / now.tiles_per_pixel().y, now.size().y);
        let line = |row: u32| least(row as f32 * size, extent);
        let matrix = Mat3::from_diagonal(tiles_per_pixel.extend(1.0)) * *matrix;
        std::mem::swap(&mut self.upper, &mut self.lower);
        if row == 0 || self.row != Some(row - 1) {
            fill_line(&mut self.upper, &matrix, corners, line(row));
        }
        fill_line(&mut self.lower, &matrix, corners, line(row + 1));
        self.row = Some(row);
        let count = corners.len().saturating_sub(1);
        for axis in 0..2 {
            let (low, high) = (&mut self.low[axis], &mut self.high[axis]);
            low.resize(count, 0.0);
            high.resize(count, 0.0);
            bound(&self.upper[axis], &self.lower[axis], low, high);
        }
        self.shown.resize(count, 0.0);
        sum(&self.upper[0], &self.lower[0], &mut self.shown);
    }

    /// Widens the rectangles to include other places of the same tiles.
    fn enclose(&mut self, other: &Self) {
        for axis in 0..2 {
            for (low, other) in self.low[axis].iter_mut().zip(&other.low[axis]) {
                *low = least(*low, *other);
            }
            for (high, other) in self.high[axis].iter_mut().zip(&other.high[axis]) {
                *high = greatest(*high, *other);
            }
        }
        for (shown, other) in self.shown.iter_mut().zip(&other.shown) {
            *shown += other;
        }
    }
}

/// Takes the corners of one line, at `y` pixels, to where a matrix leads.
fn fill_line([xs, ys]: &mut [Vec<f32>; 2], matrix: &Mat3, corners: &[f32], y: f32) {
    let start = matrix.y_axis * y + matrix.z_axis;
    let along = matrix.x_axis;
    xs.resize(corners.len(), 0.0);
    ys.resize(corners.len(), 0.0);
    for ((corner, x), y) in corners.iter().zip(xs).zip(ys) {
        let depth = along.z * corner + start.z;
        let scale = if depth > 0.0 { 1.0 / depth } else { f32::NAN };
        *x = (along.x * corner + start.x) * scale;
        *y = (along.y * corner + start.y) * scale;
    }
}

/// The least and the greatest of the four corners of each tile between two lines.
fn bound(upper: &[f32], lower: &[f32], low: &mut [f32], high: &mut [f32]) {
    let [a, b, c, d] = four(upper, lower, low.len());
    let high = &mut high[..low.len()];
    for i in 0..low.len() {
        low[i] = least(least(a[i], b[i]), least(c[i], d[i]));
        high[i] = greatest(greatest(a[i], b[i]), greatest(c[i], d[i]));
    }
}

/// The sum of the four corners of each tile: NaN stays NaN in it, and both coordinates of a corner are where one is.
fn sum(upper: &[f32], lower: &[f32], sums: &mut [f32]) {
    let [a, b, c, d] = four(upper, lower, sums.len());
    for i in 0..sums.len() {
        sums[i] = (a[i] + b[i]) + (c[i] + d[i]);
    }
}

/// The values at the corners of `count` tiles between two lines: slices of one length, so that no bounds are checked.
fn four<'a>(upper: &'a [f32], lower: &'a [f32], count: usize) -> [&'a [f32]; 4] {
    [&upper[..count], &upper[1..=count], &lower[..count], &lower[1..=count]]
}

/// The smaller one, as one instruction: `f32::min` has to look for NaN.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater one, likewise.
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// An earlier picture, in its tiles.
struct Frame {
    margin: [f32; 2],
    end: [f32; 2],
    /// Width and height.
    across: [f32; 2],
    /// The last column and row.
    last: [f32; 2],
}

impl Frame {
    fn of(earlier: &Earlier) -> Self {
        let tiles = earlier.tiles_per_pixel;
        let pixels = if earlier.is_still { [0.0, END] } else { [MARGIN, 0.0] };
        let [margin, end] = pixels.map(|pixels| (tiles * pixels).to_array());
        let stale = earlier.picture.stale;
        Self {
            margin,
            end,
            across: (tiles * earlier.picture.size()).to_array(),
            last: stale.tiles().map(|count| count.saturating_sub(1) as f32),
        }
    }
}

/// [`Place`]s by field.
#[derive(Clone, Debug, Default)]
struct Places {
    first: [Vec<u32>; 2],
    last: [Vec<u32>; 2],
    reach: [Vec<u32>; 2],
    shown: Vec<f32>,
}

/// The whole part of a number from 0 to 2^22, and up to 2^-10 of it is given away: [`MARGIN`] is more. Rounds as the sum leaves no bits
/// for a fraction, which vector instructions do without the checks of a conversion.
#[inline]
fn whole(number: f32) -> u32 {
    const SHIFT: f32 = (3 << 22) as f32;
    (number + (1.0 / 1024.0 - 0.5) + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits())
}

impl Places {
    fn set(&mut self, row: &Row, frame: &Frame) {
        for axis in 0..2 {
            let count = row.low[axis].len();
            let (first, last) = (&mut self.first[axis], &mut self.last[axis]);
            first.resize(count, 0);
            last.resize(count, 0);
            let reach = &mut self.reach[axis];
            reach.resize(count, 0);
            let (margin, end, limit) = (frame.margin[axis], frame.end[axis], frame.last[axis]);
            let tile = |at: f32| whole(greatest(least(at, limit), 0.0));
            for (first, low) in first.iter_mut().zip(&row.low[axis]) {
                *first = tile(low - margin);
            }
            for (last, high) in last.iter_mut().zip(&row.high[axis]) {
                *last = tile(high + margin - end);
            }
            for ((reach, low), high) in reach.iter_mut().zip(&row.low[axis]).zip(&row.high[axis]) {
                *reach = Place::reach(low - margin, high + margin, frame.across[axis]);
            }
        }
        self.shown.clone_from(&row.shown);
    }

    #[inline]
    fn at(&self, column: usize) -> Place {
        Place {
            first: [0, 1].map(|axis: usize| self.first[axis][column]),
            last: [0, 1].map(|axis: usize| self.last[axis][column]),
            reach: self.reach[0][column] | self.reach[1][column],
            is_shown: !self.shown[column].is_nan(),
        }
    }
}

/// The tiles of an earlier picture that a rectangle of the newest one meets.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Column and row.
    first: [u32; 2],
    last: [u32; 2],
    reach: u32,
    /// Whether the picture could show all of it.
    is_shown: bool,
}

impl Place {
    /// The rectangle lies beside the picture.
    const BESIDE: u32 = 1;
    /// The rectangle reaches beyond the picture.
    const BEYOND: u32 = 2;

    /// How a range lies in a picture that is so wide or high.
    #[inline]
    fn reach(low: f32, high: f32, across: f32) -> u32 {
        let is_beside = (high <= 0.0) | (low >= across);
        let is_beyond = (low < 0.0) | (high > across);
        (u32::from(is_beside) * Self::BESIDE) | (u32::from(is_beyond) * Self::BEYOND)
    }

    #[inline]
    fn has(&self, earlier: &Earlier) -> Has {
        if !self.is_shown {
            return Has::Part;
        }
        if self.reach & Self::BESIDE != 0 {
            return Has::Nothing;
        }
        match earlier.picture.stale.kinds(self.first, self.last) {
            (false, _) => Has::Nothing,
            (true, false) if self.reach == 0 => Has::All,
            (true, _) => Has::Part,
        }
    }
}

impl Earlier<'_> {
    /// How much this picture has of a rectangle of the newest one.
    pub(super) fn has_rect(&self, rect: &PixelRect) -> Has {
        place_of(self, rect).map_or(Has::Part, |place| place.has(self))
    }
}

/// The tiles of an earlier picture that a rectangle of the newest one meets; `None` where the picture does not show all of it.
fn place_of(earlier: &Earlier, rect: &PixelRect) -> Option<Place> {
    let PixelRect { min, max } = *rect;
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for matrix in std::iter::once(earlier.matrix).chain(earlier.near_matrix()) {
        for corner in [min, Vec2::new(max.x, min.y), Vec2::new(min.x, max.y), max] {
            let found = matrix * corner.extend(1.0);
            if found.z <= 0.0 || found.z.is_nan() {
                return None;
            }
            let at = found.truncate() / found.z * earlier.tiles_per_pixel;
            low = Vec2::new(least(low.x, at.x), least(low.y, at.y));
            high = Vec2::new(greatest(high.x, at.x), greatest(high.y, at.y));
        }
    }
    let frame = Frame::of(earlier);
    let (low, high) = (low - Vec2::from(frame.margin), high + Vec2::from(frame.margin));
    let tile = |at: f32, axis: usize| greatest(least(at, frame.last[axis]), 0.0) as u32;
    let reach = |axis: usize| Place::reach(low[axis], high[axis], frame.across[axis]);
    Some(Place {
        first: [0, 1].map(|axis| tile(low[axis], axis)),
        last: [0, 1].map(|axis| tile(high[axis] - frame.end[axis], axis)),
        reach: reach(0) | reach(1),
        is_shown: true,
    })
}
