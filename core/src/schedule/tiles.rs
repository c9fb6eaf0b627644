//! Cells that the tiles of an image touch.

use super::cells::{Cell, FINE, FacePoint, SIDE, on_face, sign};
use crate::geometry::{View, rotation};
use glam::{Mat3, Vec2, Vec3};

/// Rounding in the coordinates of [`FacePoint`], generously: the same direction, computed for another tile or
/// eye, must not fall into a cell that neither of them touches.
const MARGIN: i16 = 2;

/// The same for directions whose largest component is 1.
const DIRECTION_MARGIN: f32 = 1e-3;

/// The cells of all tiles of an image: computed once for each eye and frame.
#[derive(Clone, Debug, Default)]
pub struct TileCells {
    columns: usize,
    rows: usize,
    /// The lines of cells that each tile touches, row by row; of no meaning for [`ColumnSpan::LARGE`].
    lines_touched: Vec<LineSpan>,
    /// The columns of cells.
    columns_touched: Vec<ColumnSpan>,
    /// Indices of the tiles without a block.
    large: Vec<u32>,
    corners: Corners,
    /// Positions of the tiles' edges, pixels from the left.
    lines: Vec<f32>,
    /// The corners along the upper and the lower edge of a row of tiles.
    edges: [Edge; 2],
}

/// Tiles that are looked at together.
const LINE: usize = 16;

/// Directions of the corners: origin + across * x + down * y, with x and y in pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Corners {
    origin: Vec3,
    across: Vec3,
    down: Vec3,
    tile_size: f32,
    extent: Vec2,
}

impl Corners {
    /// Distance of an edge of tiles from the image's first one, pixels.
    fn line(&self, index: usize, axis: usize) -> f32 {
        (index as f32 * self.tile_size).min(self.extent[axis])
    }

    #[inline(always)]
    fn direction(&self, x: f32, y: f32) -> Vec3 {
        self.origin + self.across * x + self.down * y
    }
}

/// [`FacePoint`]s by field.
#[derive(Clone, Debug, Default)]
struct Edge {
    faces: Vec<u8>,
    across: Vec<i16>,
    down: Vec<i16>,
}

impl Edge {
    fn update(&mut self, corners: &Corners, lines: &[f32], y: f32) {
        self.faces.resize(lines.len(), 0);
        self.across.resize(lines.len(), 0);
        self.down.resize(lines.len(), 0);
        let points = self.faces.iter_mut().zip(&mut self.across).zip(&mut self.down);
        for (((face, across), down), &x) in points.zip(lines) {
            let point = FacePoint::of(corners.direction(x, y));
            (*face, *across, *down) = (point.face, point.across, point.down);
        }
    }
}

impl TileCells {
    /// Takes an image of `extent` pixels as it is seen in this frame, cut into square tiles of `tile_size` pixels (0
    /// counts as 1) from its upper left corner; those at the other edges may be smaller.
    ///
    /// The view's orientation leads into the space of [`super::Schedule::is_due`], as that of the view's pose in LOCAL
    /// space does; an invalid one (zero or not finite) turns nothing. Allocates only when there are more
    /// tiles than ever before.
    pub fn update(&mut self, view: &View, extent: [u32; 2], tile_size: u32) {
        let turn = rotation(view.orientation).map_or(Mat3::IDENTITY, Mat3::from_quat);
        let tile_size = tile_size.max(1);
        self.corners = Corners {
            origin: turn * view.plane.direction(Vec2::ZERO),
            across: turn.x_axis * view.plane.step.x,
            down: turn.y_axis * view.plane.step.y,
            tile_size: tile_size as f32,
            extent: Vec2::new(extent[0] as f32, extent[1] as f32),
        };
        [self.columns, self.rows] = extent.map(|side| side.div_ceil(tile_size) as usize);
        self.lines_touched.resize(self.columns * self.rows, LineSpan(0));
        self.columns_touched.resize(self.columns * self.rows, ColumnSpan::LARGE);
        self.large.clear();
        if self.lines_touched.is_empty() {
            return;
        }
        self.lines.clear();
        self.lines.extend((0..=self.columns).map(|column| self.corners.line(column, 0)));
        let [upper, lower] = &mut self.edges;
        lower.update(&self.corners, &self.lines, 0.0);
        let rows = self.lines_touched.chunks_exact_mut(self.columns);
        let rows = rows.zip(self.columns_touched.chunks_exact_mut(self.columns));
        for (row, (lines, columns)) in rows.enumerate() {
            std::mem::swap(upper, lower);
            lower.update(&self.corners, &self.lines, self.corners.line(row + 1, 1));
            find_blocks(upper, lower, lines, columns);
        }
        for (index, tiles) in self.columns_touched.chunks(LINE).enumerate() {
            // A whole line is compared at once, and nearly all have none.
            if tiles.iter().fold(false, |any, columns| any | (*columns == ColumnSpan::LARGE)) {
                let large = (index * LINE..).zip(tiles).filter(|(_, columns)| **columns == ColumnSpan::LARGE);
                self.large.extend(large.map(|(index, _)| index as u32));
            }
        }
    }

    /// Columns and rows of tiles.
    pub fn tiles(&self) -> [u32; 2] {
        [self.columns as u32, self.rows as u32]
    }

    /// The cells of the tile in a column and row; none beyond [`Self::tiles`].
    #[inline]
    pub fn touched(&self, column: u32, row: u32) -> Touched {
        let (column, row) = (column as usize, row as usize);
        if column >= self.columns || row >= self.rows {
            return Touched(Cells::Ranges([Range::NONE; 6]));
        }
        self.at(row * self.columns + column)
    }

    /// The cells of a tile, counted row by row.
    #[inline]
    pub(super) fn at(&self, index: usize) -> Touched {
        match self.columns_touched[index] {
            ColumnSpan::LARGE => Touched(self.ranges(index % self.columns, index / self.columns)),
            columns => Touched(Cells::Block { lines: self.lines_touched[index], columns }),
        }
    }

    /// The lines and columns of cells of each tile, row by row.
    pub(super) fn blocks(&self) -> (&[LineSpan], &[ColumnSpan]) {
        (&self.lines_touched, &self.columns_touched)
    }

    /// Tiles without a block, counted row by row, and their cells.
    pub(super) fn large(&self) -> impl Iterator<Item = (usize, Touched)> {
        self.large.iter().map(|&index| (index as usize, self.at(index as usize)))
    }

    /// The cells of a tile that reaches over the edge of a face or is larger than three cells.
    #[cold]
    fn ranges(&self, column: usize, row: usize) -> Cells {
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| {
            let corner =
                self.corners.direction(self.corners.line(column + x, 0), self.corners.line(row + y, 1));
            corner / corner.abs().max_element()
        });
        // The largest component of any direction in between is at least this, so a face whose depth is less at all
        // corners is not reached.
        let spread = corners
            .iter()
            .fold(0.0, |spread: f32, corner| spread.max((*corner - corners[0]).abs().max_element()));
        let least = 1.0 - spread - DIRECTION_MARGIN;
        let deepest = corners.iter().fold(Vec3::NEG_INFINITY, |deepest, corner| deepest.max(*corner));
        let shallowest = corners.iter().fold(Vec3::INFINITY, |shallowest, corner| shallowest.min(*corner));
        Cells::Ranges(std::array::from_fn(|face| {
            let depth = if face % 2 == 0 { deepest[face / 2] } else { -shallowest[face / 2] };
            if depth < least { Range::NONE } else { Range::on(face, &corners) }
        }))
    }
}

/// Finds the block of each tile between two edges.
fn find_blocks(upper: &Edge, lower: &Edge, lines: &mut [LineSpan], columns: &mut [ColumnSpan]) {
    let count = lines.len();
    // Slices of one length, and sums that wrap (they never do, but for tiles without a block): neither bounds nor
    // overflow are checked, so that vector instructions do all of it.
    let [a0, a1, b0, b1] = four(&upper.across, &lower.across, count);
    let [c0, c1, d0, d1] = four(&upper.down, &lower.down, count);
    let [f0, f1, g0, g1] = four(&upper.faces, &lower.faces, count);
    let columns = &mut columns[..count];
    const END: i16 = (SIDE * FINE) as i16;
    const SHIFT: u32 = FINE.trailing_zeros();
    for i in 0..count {
        let left = a0[i].min(a1[i]).min(b0[i].min(b1[i])).wrapping_sub(MARGIN);
        let right = a0[i].max(a1[i]).max(b0[i].max(b1[i])).wrapping_add(MARGIN);
        let top = c0[i].min(c1[i]).min(d0[i].min(d1[i])).wrapping_sub(MARGIN);
        let bottom = c0[i].max(c1[i]).max(d0[i].max(d1[i])).wrapping_add(MARGIN);
        let one_face = (f0[i] == f1[i]) & (f0[i] == g0[i]) & (f0[i] == g1[i]);
        let inside = (left >= 0) & (top >= 0) & (right < END) & (bottom < END);
        let (column, row) = (left >> SHIFT, top >> SHIFT);
        let wide = (right >> SHIFT).wrapping_sub(column);
        let high = (bottom >> SHIFT).wrapping_sub(row);
        let line = (u16::from(f0[i]).wrapping_mul(SIDE as u16)).wrapping_add(row as u16);
        lines[i] = LineSpan((line << LineSpan::HEIGHT_BITS) | (high as u16 & LineSpan::HEIGHT));
        let span = (column as u8) | (wide as u8) << ColumnSpan::COLUMN_BITS;
        let is_block = one_face & inside & (wide <= 2) & (high <= 2);
        columns[i] = if is_block { ColumnSpan(span) } else { ColumnSpan::LARGE };
    }
}

/// The values at the four corners of `count` tiles between two edges.
fn four<'a, T>(upper: &'a [T], lower: &'a [T], count: usize) -> [&'a [T]; 4] {
    [&upper[..count], &upper[1..=count], &lower[..count], &lower[1..=count]]
}

/// 1 to 3 lines of cells: their number minus one in the lowest bits, and above them the first line, counted through all faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LineSpan(u16);

impl LineSpan {
    const HEIGHT_BITS: u32 = 2;
    const HEIGHT: u16 = (1 << Self::HEIGHT_BITS) - 1;
    /// Number of spans, of meaning or not.
    pub(super) const COUNT: usize = (6 * SIDE) << Self::HEIGHT_BITS;

    /// 0..[`Self::COUNT`]: four a line, in the order of heights; the fourth is unused.
    #[inline]
    pub(super) fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The first line and the last one.
    fn lines(self) -> std::ops::RangeInclusive<usize> {
        let first = usize::from(self.0 >> Self::HEIGHT_BITS);
        first..=first + usize::from(self.0 & Self::HEIGHT)
    }
}

/// 1 to 3 columns of cells of a face: the first one in the lowest bits, and above them their number minus one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ColumnSpan(u8);

impl ColumnSpan {
    const COLUMN_BITS: u32 = 6;
    /// Of a tile that reaches over the edge of a face or touches more cells.
    const LARGE: Self = Self(u8::MAX);

    /// The first column in its face.
    #[inline]
    pub(super) fn first(self) -> u32 {
        u32::from(self.0) % (1 << Self::COLUMN_BITS)
    }

    /// Number of columns minus one.
    #[inline]
    pub(super) fn wider(self) -> u32 {
        u32::from(self.0) >> Self::COLUMN_BITS
    }
}

const _: () = assert!(SIDE < 1 << ColumnSpan::COLUMN_BITS && LineSpan::COUNT <= u16::MAX as usize);

/// The cells that a tile touches, at times a few beside them; never one too few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touched(pub(super) Cells);

/// Set of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cells {
    /// Nearly always: within one face.
    Block { lines: LineSpan, columns: ColumnSpan },
    /// On each face.
    Ranges([Range; 6]),
}

impl Touched {
    /// Calls `each` for every cell.
    pub fn for_each(&self, mut each: impl FnMut(Cell)) {
        match &self.0 {
            &Cells::Block { lines, columns } => {
                for line in lines.lines() {
                    for column in columns.first()..=columns.first() + columns.wider() {
                        each(Cell::from_index(line * SIDE + column as usize));
                    }
                }
            }
            Cells::Ranges(ranges) => {
                for (face, range) in ranges.iter().enumerate() {
                    range.cells(face).for_each(&mut each);
                }
            }
        }
    }
}

/// A rectangle of cells of a face, first and last line; none where the first is above the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    across: [u8; 2],
    down: [u8; 2],
}

impl Range {
    const LAST: u8 = SIDE as u8 - 1;
    const NONE: Self = Self { across: [1, 0], down: [1, 0] };
    const ALL: Self = Self { across: [0, Self::LAST], down: [0, Self::LAST] };

    /// The cells of a face that a tile with these corners touches, for tiles of any size. The largest component
    /// of each corner is 1.
    fn on(face: usize, corners: &[Vec3; 4]) -> Self {
        let axis = face / 2;
        let depths = corners.map(|corner| corner[axis] * sign(face));
        if depths.iter().any(|&depth| depth <= DIRECTION_MARGIN) {
            // A tile that reaches behind the face's plane has no bounds on it, unless it lies beside the face: where
            // all corners have a side that is larger than the depth.
            let beside = |side: usize, sense: f32| {
                let beyond = |(corner, depth): (&Vec3, &f32)| {
                    depth + sense * corner[(axis + side) % 3] < -DIRECTION_MARGIN
                };
                corners.iter().zip(&depths).all(beyond)
            };
            let outside = beside(1, 1.0) || beside(1, -1.0) || beside(2, 1.0) || beside(2, -1.0);
            return if outside { Self::NONE } else { Self::ALL };
        }
        let points = corners.map(|corner| on_face(corner, face));
        let bounds = |axis: usize| {
            let least = points.iter().fold(i16::MAX, |least, point| least.min(point[axis]));
            let most = points.iter().fold(i16::MIN, |most, point| most.max(point[axis]));
            [least - MARGIN, most + MARGIN]
        };
        let (across, down) = (bounds(0), bounds(1));
        let beside = |[least, most]: [i16; 2]| most < 0 || least > (SIDE * FINE) as i16;
        if beside(across) || beside(down) {
            return Self::NONE;
        }
        let lines = |edges: [i16; 2]| edges.map(|edge| (edge.max(0) as usize / FINE).min(SIDE - 1) as u8);
        Self { across: lines(across), down: lines(down) }
    }

    pub(super) fn cells(self, face: usize) -> impl Iterator<Item = Cell> {
        let lines = |[first, last]: [u8; 2]| usize::from(first)..usize::from(last) + 1;
        lines(self.down)
            .flat_map(move |down| lines(self.across).map(move |across| Cell::at(face, across, down)))
    }
}

#[cfg(test)]
mod tests;
