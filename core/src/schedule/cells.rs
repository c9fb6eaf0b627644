//! Cells of directions: the unit in which both eyes agree on updates.
//!
//! A cube around the viewer, each face a grid of [`SIDE`] x [`SIDE`] cells of about 1.9 degrees. Straight lines of an image are
//! straight on a face, so that the cells of a tile are found from its corners.

use super::{MAX_FACTOR, Phase};
use glam::Vec3;

/// Cells along the edge of a face.
pub(super) const SIDE: usize = 48;

/// Number of cells.
pub const CELLS: usize = 6 * SIDE * SIDE;

/// Cells along the edge of a patch, the unit that takes turns in [`Phase::Staggered`].
///
/// A tile is rendered when any cell that it touches is due, so the smaller the patches, the more is rendered beside
/// them; the larger, the less even is the load. Of 11.25, 15, 22.5 and 30 degrees, 15 has the cheapest worst frame
/// for 11223: on paper B's display in tiles of 16 pixels 45 % of the tiles, 43 % on average (P is 36 %).
pub(super) const PATCH_SIDE: usize = 8;

/// Patches along the edge of a face.
pub(super) const PATCHES: usize = SIDE / PATCH_SIDE;

const _: () = assert!(SIDE.is_multiple_of(PATCH_SIDE));

/// A cell of directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Cell(u16);

impl Cell {
    /// Side of a patch, degrees.
    pub const PATCH_DEG: f32 = 90.0 / PATCHES as f32;

    /// The cell that a direction of any length lies in; nothing for one that is zero or not finite.
    pub fn of(direction: Vec3) -> Option<Self> {
        if !direction.is_finite() || direction == Vec3::ZERO {
            return None;
        }
        let FacePoint { face, across, down } = FacePoint::of(direction / direction.abs().max_element());
        let line = |coordinate: i16| (coordinate.max(0) as usize / FINE).min(SIDE - 1);
        Some(Self::at(usize::from(face), line(across), line(down)))
    }

    /// The cell in column `across` and row `down`, both below [`SIDE`], of a face 0..6.
    pub(super) fn at(face: usize, across: usize, down: usize) -> Self {
        Self(((face * SIDE + down) * SIDE + across) as u16)
    }

    /// The cell with an index below [`CELLS`].
    pub(super) fn from_index(index: usize) -> Self {
        Self(index as u16)
    }

    /// 0..[`CELLS`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The patch that the cell belongs to, 0..6 * [`PATCHES`]^2.
    fn patch(self) -> usize {
        let index = self.index();
        let (across, down) = (index % SIDE, index / SIDE);
        // Rows count on from face to face, and SIDE is a whole number of patches.
        down / PATCH_SIDE * PATCHES + across / PATCH_SIDE
    }

    /// In which of `period` frames (2..=9) the cell is rendered, 0..period.
    pub(super) fn phase_for(self, phase: Phase, period: u8) -> u8 {
        match phase {
            Phase::Staggered => patch_phase(self.patch(), period),
            Phase::Aligned | Phase::AlternateEye => 0,
        }
    }
}

/// Shift of the phase from one row of patches to the next, by period: the lattice whose patches of equal phase are farthest
/// apart. Any `period` patches in a row have all phases, which keeps the load even.
const ROW_SHIFT: [u8; MAX_FACTOR as usize + 1] = [0, 0, 1, 1, 2, 2, 2, 2, 3, 3];

/// Phase of a patch in [`Phase::Staggered`], 0..period, for periods 1..=9.
pub(super) fn patch_phase(patch: usize, period: u8) -> u8 {
    let (across, down) = (patch % PATCHES, patch / PATCHES % PATCHES);
    (across as u8 + ROW_SHIFT[usize::from(period)] * down as u8) % period
}

/// Units of a [`FacePoint`] along the edge of a cell.
pub(super) const FINE: usize = 256;

/// Intersection of a direction with the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FacePoint {
    /// 0..6: +x, -x, +y, -y, +z, -z.
    pub(super) face: u8,
    /// Distance from the first column's edge, cells / [`FINE`], 0..=[`SIDE`] * [`FINE`].
    pub(super) across: i16,
    /// Distance from the first row's edge, the same.
    pub(super) down: i16,
}

impl FacePoint {
    /// The point of a direction, which is finite and not zero. Without a branch, to suit vector instructions.
    #[inline(always)]
    pub(super) fn of(direction: Vec3) -> Self {
        let Vec3 { x, y, z } = direction;
        let along_z = (z.abs() >= x.abs()) & (z.abs() >= y.abs());
        let along_x = x.abs() >= y.abs();
        let pick = |by_x: f32, by_y: f32, by_z: f32| {
            let other = if along_x { by_x } else { by_y };
            if along_z { by_z } else { other }
        };
        let depth = pick(x, y, z);
        let scale = 1.0 / depth.abs();
        let axis = if along_z { 4 } else { if along_x { 0 } else { 2 } };
        Self {
            face: axis | u8::from(depth < 0.0),
            across: coordinate(pick(y, z, x) * scale),
            down: coordinate(pick(z, x, y) * scale),
        }
    }
}

/// Intersection of a direction that lies on the side of `face` with the face's plane, in the units of [`FacePoint`]; beyond the
/// face, outside of its range.
pub(super) fn on_face(direction: Vec3, face: usize) -> [i16; 2] {
    let axis = face / 2;
    let scale = 1.0 / direction[axis].abs();
    [direction[(axis + 1) % 3], direction[(axis + 2) % 3]].map(|side| coordinate(side * scale))
}

/// 1 for the faces on the positive side of their axis, -1 for the others.
pub(super) fn sign(face: usize) -> f32 {
    1.0 - 2.0 * (face & 1) as f32
}

/// Maps -1..=1 on a face, the tangent of an angle, to 0..=[`SIDE`] * [`FINE`], nearly in proportion to the angle. It
/// continues up to |t| = 1.25, and is constant beyond.
#[inline(always)]
fn coordinate(tangent: f32) -> i16 {
    let t = tangent.clamp(-1.25, 1.25);
    let fine = (part_of_angle(t) + 1.0) * (0.5 * (SIDE * FINE) as f32);
    // Rounds as it leaves no bits for a fraction, which costs less than a conversion with its checks.
    const SHIFT: f32 = (3 << 22) as f32;
    (fine + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits()) as i16
}

/// atan(t) / 45 degrees within 0.005 for |t| <= 1: the odd polynomial with its value at 1 and its slopes at 0 and 1,
/// 4 / pi and 2 / pi.
#[inline(always)]
fn part_of_angle(t: f32) -> f32 {
    let [a, b, c] = ANGLE;
    let square = t * t;
    t * (a + square * (b + square * c))
}

/// Coefficients of t, t^3 and t^5.
const ANGLE: [f32; 3] = [1.2732, -0.3647, 0.0915];

/// Direction of the centre of a cell, of unit length.
pub(super) fn centre(cell: Cell) -> Vec3 {
    point(cell, [0.5, 0.5]).normalize()
}

/// Direction of a point of a cell, given as parts of its sides, 0..=1.
pub(super) fn point(cell: Cell, within: [f32; 2]) -> Vec3 {
    let index = cell.index();
    let lines = [index % SIDE, index / SIDE % SIDE];
    let face = index / (SIDE * SIDE);
    let axis = face / 2;
    let mut direction = Vec3::ZERO;
    direction[axis] = sign(face);
    for i in 0..2 {
        let position = (lines[i] as f32 + within[i]) / (0.5 * SIDE as f32) - 1.0;
        direction[(axis + 1 + i) % 3] = tangent(position);
    }
    direction
}

/// Inverse of [`part_of_angle`] within -1..=1, by Newton's method.
fn tangent(position: f32) -> f32 {
    let [a, b, c] = ANGLE;
    let mut t = position;
    for _ in 0..6 {
        let square = t * t;
        let slope = a + square * (3.0 * b + square * 5.0 * c);
        t -= (part_of_angle(t) - position) / slope;
    }
    t
}

#[cfg(test)]
mod tests;
