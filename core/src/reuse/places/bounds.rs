//! Bounds of the displacement of blocks of tiles in an earlier image, row by row.

use super::super::Reuse;
use super::super::history::Earlier;
use super::super::reach::{greatest, least};
use super::BLOCK;
use glam::{Mat3, Vec2, Vec3};

/// Bounds of the displacement of each block of a row in an earlier image, tiles of that image.
#[derive(Clone, Debug, Default)]
pub(super) struct Bounds {
    map: Option<Map>,
    /// The least, x and y; NaN for blocks that the picture does not show all of.
    pub(super) low: [Vec<f32>; 2],
    /// The greatest, x and y.
    pub(super) high: [Vec<f32>; 2],
    /// x and y of the corners along the upper and the lower edge.
    upper: [Vec<f32>; 2],
    lower: [Vec<f32>; 2],
    /// y of the lower edge, tiles of the newest picture.
    line: Option<f32>,
}

/// Mapping from tiles of the newest picture to tiles of an earlier one.
#[derive(Clone, Copy, Debug)]
struct Map {
    matrix: Mat3,
    /// Farthest that the inside of a block may lie beyond the range of its corners, x and y, tiles.
    bend: Vec2,
}

impl Bounds {
    pub(super) fn begin(&mut self, matrix: Option<Mat3>, reuse: &Reuse, earlier: &Earlier) {
        self.line = None;
        self.map = matrix.map(|matrix| {
            let size = 1.0 / reuse.now().tiles_per_pixel();
            let matrix = Mat3::from_diagonal(earlier.tiles_per_pixel.extend(1.0))
                * matrix
                * Mat3::from_diagonal(size.extend(1.0));
            Map { matrix, bend: bend(&matrix, reuse.now().stale.tiles_across()) }
        });
    }

    /// Whether there is a map to go by.
    pub(super) fn is_known(&self) -> bool {
        self.map.is_some()
    }

    /// Advances to the row of blocks between two lines; false without a map.
    pub(super) fn set(&mut self, edges: &[f32], [top, bottom]: [f32; 2]) -> bool {
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
    pub(super) fn enclose(&mut self, other: &Self) {
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

/// The least and the greatest of the four corners of each block between two lines, widened by the bend of its inside. NaN stays in the
/// least.
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

/// Bound of the bend of a block's inside beyond the range of its corners: a matrix maps points of an image of that size to at most an
/// eighth of the square of their distance times the second derivative from the interpolation of four corners, on each axis. NaN or infinite
/// where some point of the picture is not shown.
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
