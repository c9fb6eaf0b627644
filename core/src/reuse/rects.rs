//! Tiles as rectangles: adjacent tiles with one kind of draw are drawn at once.

use crate::geometry::PixelRect;
use bytemuck::{Pod, Zeroable};
use glam::Vec2;

/// Most columns and rows of a [`TileRect`].
const MOST: u32 = (1 << SIDE_BITS) - 1;
const SIDE_BITS: u32 = 14;

/// An edge or a corner of a tile, by the sides that it lies at: at the left or right one, and at the upper or lower one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Edge {
    /// -1: at the left side, 1: at the right one, 0: from side to side.
    pub across: i8,
    /// -1: at the upper side, 1: at the lower one, 0: from side to side.
    pub down: i8,
}

impl Edge {
    /// All edges, then all corners.
    pub const ALL: [Self; 8] = [
        Self { across: 0, down: -1 },
        Self { across: 0, down: 1 },
        Self { across: -1, down: 0 },
        Self { across: 1, down: 0 },
        Self { across: -1, down: -1 },
        Self { across: 1, down: -1 },
        Self { across: -1, down: 1 },
        Self { across: 1, down: 1 },
    ];

    /// Weight of the earlier image at a point within `rect`, the rectangle of this edge, 0..=1: 1 next to the adjacent tile,
    /// falling to 0 at the other side.
    pub fn share(self, rect: &PixelRect, point: Vec2) -> f32 {
        let along = (point - rect.min) / (rect.max - rect.min);
        let axis = |side: i8, along: f32| match side {
            0 => 1.0,
            1.. => along,
            _ => 1.0 - along,
        };
        axis(self.across, along.x) * axis(self.down, along.y)
    }

    /// Of each axis two bits: 0 for the whole side, 1 for its beginning, 2 for its end.
    const fn bits(self) -> u32 {
        const fn axis(side: i8) -> u32 {
            match side {
                0 => 0,
                1.. => 2,
                _ => 1,
            }
        }
        axis(self.across) | axis(self.down) << 2
    }
}

/// A rectangle of tiles, or the same edge of each of its tiles, as two words: column and row of the first tile, 16 bits each;
/// columns and rows, 14 bits each, and above them the edge, for each axis two bits: 0 for the whole side, 1 for its beginning, 2
/// for its end.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
pub struct TileRect([u32; 2]);

impl TileRect {
    /// Tiles of one row.
    fn run([column, row]: [u32; 2], columns: u32, edge: u32) -> Self {
        Self([column | row << 16, columns | 1 << SIDE_BITS | edge << (2 * SIDE_BITS)])
    }

    /// Column and row of the first tile.
    pub fn first(self) -> [u32; 2] {
        [self.0[0] & 0xffff, self.0[0] >> 16]
    }

    /// Columns and rows.
    pub fn size(self) -> [u32; 2] {
        [self.0[1] & MOST, self.0[1] >> SIDE_BITS & MOST]
    }

    /// All tiles, row by row, by column and row.
    pub fn tiles(self) -> impl Iterator<Item = [u32; 2]> {
        let ([column, row], [columns, rows]) = (self.first(), self.size());
        (row..row + rows).flat_map(move |row| (column..column + columns).map(move |column| [column, row]))
    }

    /// The column after the last one.
    fn end(self) -> u32 {
        self.first()[0] + self.size()[0]
    }

    fn is_above(self, below: Self) -> bool {
        let ([column, row], [columns, rows]) = (self.first(), self.size());
        [column, columns] == [below.first()[0], below.size()[0]]
            && row + rows == below.first()[1]
            && rows < MOST
    }
}

/// A list of rectangles that do not overlap, filled run by run. Memory is only asked for beyond the longest list so far.
#[derive(Clone, Debug, Default)]
pub struct TileRects {
    rects: Vec<TileRect>,
    /// Of the row that is being filled.
    row: Vec<TileRect>,
    /// Indices in `rects` of the rectangles that end with the row before.
    open: Vec<usize>,
    /// The same of the row that is being filled.
    next: Vec<usize>,
}

impl TileRects {
    /// Adds so many tiles, at least one, to the right of all others of their row, or an edge of each; this is the first of them.
    pub(super) fn push(&mut self, tile: [u32; 2], count: u32, edge: Option<Edge>) {
        let [mut column, row] = tile;
        let end = column + count;
        if let Some(last) = self.row.last_mut().filter(|last| last.end() == column) {
            let more = (end - column).min(MOST - last.size()[0]);
            last.0[1] += more;
            column += more;
        }
        while column < end {
            let more = (end - column).min(MOST);
            self.row.push(TileRect::run([column, row], more, edge.map_or(0, Edge::bits)));
            column += more;
        }
    }

    /// All of a row was added; the next one is that below. Whether the row has any tile.
    pub(super) fn end_row(&mut self) -> bool {
        self.next.clear();
        let mut open = self.open.iter().copied().peekable();
        for rect in self.row.drain(..) {
            while open.next_if(|&index| self.rects[index].first()[0] < rect.first()[0]).is_some() {}
            let above = open.next_if(|&index| self.rects[index].is_above(rect));
            match above {
                Some(index) => self.rects[index].0[1] += 1 << SIDE_BITS,
                None => self.rects.push(rect),
            }
            self.next.push(above.unwrap_or(self.rects.len() - 1));
        }
        std::mem::swap(&mut self.open, &mut self.next);
        !self.open.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.rects.clear();
        self.row.clear();
        self.open.clear();
    }

    /// The rectangles.
    pub fn iter(&self) -> impl Iterator<Item = TileRect> {
        self.rects.iter().copied()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rects.is_empty()
    }

    /// Number of rectangles.
    pub fn len(&self) -> usize {
        self.rects.len()
    }

    /// Two words for each.
    pub fn words(&self) -> &[u32] {
        bytemuck::cast_slice(&self.rects)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every added tile comes out once.
        #[test]
        fn rectangles_have_the_tiles_that_were_added(
            columns in 1usize..12, tiles in prop::collection::vec(prop::bool::weighted(0.7), 0..120), edge in 0usize..9,
        ) {
            let edge = Edge::ALL.get(edge).copied();
            let mut rects = TileRects::default();
            let mut expected = Vec::new();
            for _ in 0..2 {
                rects.clear();
                expected.clear();
                for (row, line) in (0u32..).zip(tiles.chunks(columns)) {
                    for (column, _) in (0u32..).zip(line).filter(|(_, is_added)| **is_added) {
                        rects.push([column, row], 1, edge);
                        expected.push([row, column]);
                    }
                    rects.end_row();
                }
            }
            let mut found: Vec<_> =
                rects.iter().flat_map(TileRect::tiles).map(|[column, row]| [row, column]).collect();
            found.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn adjacent_tiles_are_one_rectangle() {
        let mut rects = TileRects::default();
        for row in 0..5 {
            for column in 0..6 {
                if column != 3 && row != 2 {
                    rects.push([column, row], 1, Some(Edge { across: 1, down: -1 }));
                }
            }
            rects.end_row();
        }
        let found: Vec<_> = rects.iter().map(|rect| (rect.first(), rect.size())).collect();
        assert_eq!(found, [([0, 0], [3, 2]), ([4, 0], [2, 2]), ([0, 3], [3, 2]), ([4, 3], [2, 2])]);
        assert_eq!(rects.words()[..2], [0, 3 | 2 << 14 | 0b0110 << 28]);
    }
}
