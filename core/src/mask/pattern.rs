//! Shaded blocks at each rate.
//!
//! Rows of shaded blocks, every other one shifted by half of the distance within a row, which is a checkerboard at 1/2
//! and at 1/8: no point is far from a shaded block in any direction. At one fraction this fills better than columns,
//! rows or a square lattice (`tests/baselines/fill.md`), so the direction of a rate such as 2x1 does not count.

use crate::rate::ShadingRate;
use glam::UVec2;

/// The blocks that are shaded in tiles of one rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Pattern {
    /// Blocks from one shaded block to the next in a row, and from one row with shaded blocks to the next: powers of two.
    step: UVec2,
}

impl Pattern {
    /// Columns and rows after which every pattern repeats.
    pub const PERIOD: [u32; 2] = [4, 8];

    /// The pattern of a rate, which counts by its [`ShadingRate::fraction`] alone.
    pub const fn of(rate: ShadingRate) -> Self {
        let step = match rate.width() * rate.height() {
            1 => UVec2::ONE,
            2 => UVec2::new(2, 1),
            4 => UVec2::new(2, 2),
            8 => UVec2::new(4, 2),
            _ => UVec2::new(4, 4),
        };
        Self { step }
    }

    /// Share of the blocks that is shaded, away from the edges of a view.
    pub fn fraction(self) -> f32 {
        1.0 / (self.step.x * self.step.y) as f32
    }

    /// Whether a block is shaded in a view that has the blocks from `first` on up to, not including, `end`.
    ///
    /// Along the edges of the view the blocks of the pattern are moved onto the edge as well, so that between the edge
    /// and the pattern there is something to interpolate with.
    pub(super) fn shades(self, block: UVec2, first: UVec2, end: UVec2) -> bool {
        let on_edge = |axis: usize| block[axis] == first[axis] || block[axis] + 1 == end[axis];
        match (on_edge(0), on_edge(1)) {
            (true, true) => true,
            (true, false) => block.y & (self.step.y - 1) == 0,
            (false, true) => block.x & (self.step.x - 1) == 0,
            (false, false) => self.shades_inside(block),
        }
    }

    /// Whether a block is shaded that is on no edge of its view.
    pub fn shades_inside(self, block: UVec2) -> bool {
        // Steps are powers of two.
        let is_shifted = block.y & self.step.y != 0;
        let shift = if is_shifted { self.step.x / 2 } else { 0 };
        block.y & (self.step.y - 1) == 0 && block.x & (self.step.x - 1) == shift
    }
}
