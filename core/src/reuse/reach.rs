//! Which tiles of an earlier picture the tiles of a block meet.

use super::bits;
use super::history::Earlier;
use super::rects::Edge;
use glam::Vec2;

/// Pixels around a tile that its re-used pixels may be interpolated from, with room for rounding.
const MARGIN: f32 = 1.0;

/// A rectangle that ends where a tile begins does not reach into it, pixels.
const END: f32 = 0.5;

/// Up to this part of a tile is given away where a place becomes a whole number of tiles: rounding.
pub(super) const ROUNDING: f32 = 1.0 / 1024.0;

/// Most columns and rows of an earlier picture that a tile of a block is given: a block that would need more is placed tile by tile.
const MOST: i32 = 4;

/// An earlier picture, in its tiles.
pub(super) struct Frame {
    pub(super) margin: [f32; 2],
    pub(super) end: [f32; 2],
    /// Width and height.
    pub(super) across: [f32; 2],
    /// The last column and row.
    pub(super) last: [f32; 2],
    /// Whether the border cuts off the last column and row.
    is_cut: [bool; 2],
    /// What blocks give away for rounding, tiles; negative: what they take more.
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

    /// What is added to the end of a tile of a block.
    fn taken(&self, axis: usize) -> f32 {
        ROUNDING - self.given - self.end[axis]
    }
}

/// The tiles of an earlier picture that a tile of a block meets, counted from the tile at its own place on: first and last column, and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reach([[i32; 2]; 2]);

impl Reach {
    /// For 64 tiles in a row from one on, as bits: whether all tiles are fresh that a tile meets, and whether any is.
    #[inline]
    pub(super) fn fresh<'a>(
        self,
        [column, row]: [i32; 2],
        fresh_row: impl Fn(i32) -> &'a [u64],
    ) -> (u64, u64) {
        let Self([[left, right], [top, bottom]]) = self;
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

    /// The tiles of a word of a row that meet a tile cut off by the border of the earlier picture, as bits: that has no pixels beyond the
    /// border, unlike its bit, so that such tiles have to be looked at one by one.
    pub(super) fn meets_cut(self, frame: &Frame, word: usize, row: u32) -> u64 {
        let Self([[_, right], [_, bottom]]) = self;
        let meets = |axis: usize, last: i32| frame.is_cut[axis] && last >= frame.last[axis] as i32;
        if meets(1, row as i32 + bottom) {
            return u64::MAX;
        }
        let first = (frame.last[0] as i32 - right).max(0) as u32;
        if frame.is_cut[0] { bits::range(word, [first, u32::MAX]) } else { 0 }
    }

    /// Whether all tiles are fresh that one tile meets.
    #[inline]
    pub(super) fn is_fresh<'a>(self, [column, row]: [i32; 2], fresh_row: impl Fn(i32) -> &'a [u64]) -> bool {
        let Self([[left, right], [top, bottom]]) = self;
        let wanted = bits::first((right - left + 1) as u32);
        (top..=bottom).all(|down| bits::read(fresh_row(row + down), column + left) & wanted == wanted)
    }
}

/// How a block of tiles lies in an earlier picture: by how far its points lie from their own place, in tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) low: Vec2,
    pub(super) high: Vec2,
}

impl Placed {
    /// What its tiles meet; `None` where they have to be looked at one by one.
    #[inline]
    pub(super) fn reach(&self, frame: &Frame) -> Option<Reach> {
        let mut reach = Reach([[0; 2]; 2]);
        for axis in 0..2 {
            let (low, high) = self.range(frame, axis);
            // Not `<=`: either may be NaN.
            let is_near = high - low < (MOST + 1) as f32 && low.abs() < frame.across[axis] + MOST as f32;
            let first = floor(low);
            let last = floor(1.0 + high + frame.taken(axis));
            if !is_near || last - first >= MOST {
                return None;
            }
            reach.0[axis] = [first, last];
        }
        Some(reach)
    }

    /// What an edge of its tiles meets that is so wide and high, tiles; only where there is [`Self::reach`].
    #[inline]
    pub(super) fn edge_reach(&self, frame: &Frame, Edge { across, down }: Edge, strip: Vec2) -> Reach {
        let side = |axis: usize, side: i8| {
            let (low, high) = self.range(frame, axis);
            let begin = if side > 0 { 1.0 - strip[axis] } else { 0.0 };
            let end = if side < 0 { strip[axis] } else { 1.0 };
            [floor(begin + low), floor(end + high + frame.taken(axis))]
        };
        Reach([side(0, across), side(1, down)])
    }

    #[inline]
    fn range(&self, frame: &Frame, axis: usize) -> (f32, f32) {
        (self.low[axis] - frame.margin[axis] + frame.given, self.high[axis] + frame.margin[axis])
    }
}

/// The greatest whole number that is not above one of up to 2^22, or the one below that where it is whole itself. Rounds as the sum leaves no
/// bits for a fraction, without the checks of a conversion.
#[inline]
fn floor(number: f32) -> i32 {
    const SHIFT: f32 = (3 << 22) as f32;
    (number - 0.5 + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits()) as i32
}
