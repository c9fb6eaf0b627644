//! Cells of directions: the unit in which both eyes agree on what is rendered anew.
//!
//! A cube around the viewer, each face a grid of [`SIDE`] x [`SIDE`] cells of about 1.4 degrees. Straight lines of an image are
//! straight on a face, so that the cells of a tile are found from its corners.

use super::{MAX_FACTOR, Phase};
use glam::Vec3;

/// Cells along the edge of a face.
pub(super) const SIDE: usize = 64;

/// Number of cells.
pub const CELLS: usize = 6 * SIDE * SIDE;

/// Cells along the edge of a patch, the unit that takes turns in [`Phase::Staggered`].
///
/// A tile is rendered when any cell that it touches is due, so the smaller the patches, the more is rendered beside
/// them; the larger, the less even is the load.
pub(super) const PATCH_SIDE: usize = 8;

/// Patches along the edge of a face.
pub(super) const PATCHES: usize = SIDE / PATCH_SIDE;

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
        let FacePoint { face, across, down } = FacePoint::of(direction);
        let line = |coordinate: f32| (coordinate as usize).min(SIDE - 1);
        Some(Self::at(face, line(across), line(down)))
    }

    /// The cell in column `across` and row `down`, both below [`SIDE`], of a face 0..6.
    pub(super) fn at(face: usize, across: usize, down: usize) -> Self {
        Self(((face * SIDE + down) * SIDE + across) as u16)
    }

    /// 0..[`CELLS`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The patch that the cell belongs to, 0..6 * [`PATCHES`]^2.
    pub(super) fn patch(self) -> usize {
        let index = self.index();
        let (across, down) = (index % SIDE, index / SIDE);
        // Rows count on from face to face, and SIDE is a whole number of patches.
        down / PATCH_SIDE * PATCHES + across / PATCH_SIDE
    }

    /// In which of `period` frames (2..=9) the cell is rendered, 0..period.
    pub(super) fn phase_for(self, phase: Phase, period: u8) -> u8 {
        match phase {
            Phase::Staggered => PATCH_PHASES[usize::from(period)][self.patch()],
            Phase::Aligned | Phase::AlternateEye => 0,
        }
    }
}

/// How far the phase moves on from one row of patches to the next, by period: the lattice whose patches of equal
/// phase are farthest apart. Any `period` patches in a row have all phases, which is what keeps the load even.
const ROW_SHIFT: [usize; MAX_FACTOR as usize + 1] = [0, 0, 1, 1, 2, 2, 2, 2, 3, 3];

/// Phase of each patch by period.
pub(super) const PATCH_PHASES: [[u8; 6 * PATCHES * PATCHES]; MAX_FACTOR as usize + 1] = {
    let mut phases = [[0; 6 * PATCHES * PATCHES]; MAX_FACTOR as usize + 1];
    let mut period = 1;
    while period < phases.len() {
        let mut patch = 0;
        while patch < 6 * PATCHES * PATCHES {
            let (across, down) = (patch % PATCHES, patch / PATCHES);
            phases[period][patch] = ((across + ROW_SHIFT[period] * down) % period) as u8;
            patch += 1;
        }
        period += 1;
    }
    phases
};

/// Where a direction meets the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FacePoint {
    /// 0..6: +x, -x, +y, -y, +z, -z.
    pub(super) face: usize,
    /// Column of cells and how far into it, 0..=[`SIDE`].
    pub(super) across: f32,
    /// Row of cells and how far into it, 0..=[`SIDE`].
    pub(super) down: f32,
}

impl FacePoint {
    /// The point of a direction, which is finite and not zero.
    pub(super) fn of(direction: Vec3) -> Self {
        let size = direction.abs();
        let axis = if size.z >= size.x && size.z >= size.y {
            2
        } else if size.x >= size.y {
            0
        } else {
            1
        };
        let face = axis * 2 + usize::from(direction[axis] < 0.0);
        let [across, down] = on_face(direction, face);
        Self { face, across, down }
    }
}

/// Where a direction that lies on the side of `face` meets the face's plane, in cells; beyond the face, outside of
/// 0..=[`SIDE`].
pub(super) fn on_face(direction: Vec3, face: usize) -> [f32; 2] {
    let axis = face / 2;
    let depth = direction[axis].abs();
    [direction[(axis + 1) % 3], direction[(axis + 2) % 3]].map(|side| cell_coordinate(side / depth))
}

/// Maps -1..=1 on a face, the tangent of an angle, to 0..=[`SIDE`], nearly in proportion to the angle: 1.27 t - 0.27 t^3 is
/// within 0.01 of atan(t) / 45 degrees. It keeps to rise up to |t| = 1.25, and is held there.
fn cell_coordinate(tangent: f32) -> f32 {
    let t = tangent.clamp(-1.25, 1.25);
    (t * (1.27 - 0.27 * t * t) + 1.0) * (0.5 * SIDE as f32)
}
