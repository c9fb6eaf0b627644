//! The tiles of one view and the nearest point of each to the gaze, exact and without a branch per tile.
//!
//! The nearest point of a tile is a corner, a point on an edge, or the gaze itself. All edges of one lattice line
//! lie on one great circle, which has one point nearest to the gaze: so the corners are done for all tiles alike,
//! and then one tile on each side of each line is corrected.

use crate::geometry::{Fov, FovTangents, ImagePlane, View, pixels_per_degree};
use glam::{Quat, UVec2, Vec2, Vec3};
use std::ops::RangeInclusive;

/// Sides of a tile that are accepted, pixels; other values count as the nearest of them. Devices offer 8 to 64
/// (Vulkan specification, `minFragmentShadingRateAttachmentTexelSize` and its maximum).
pub const TEXEL_SIDES: RangeInclusive<u32> = 8..=64;

/// Longest side of a view, pixels; pixels beyond have no tiles, and keep full rate.
pub const MAX_SIDE: u32 = 16_384;

/// Columns or rows of tiles beyond which a plan takes larger tiles. At 110 degrees they are 1.5 degrees wide, as 16 pixels are at
/// 1024: the cost of planning follows the field of view, not the pixels and not the size of the device's texels.
pub const MOST_TILES: u32 = 72;

/// The tile, pixels, to plan a view of `extent` pixels with on a device whose attachments have texels of `texel` pixels: so many
/// texels, a power of two on each axis, that no axis has more than [`MOST_TILES`], within [`TEXEL_SIDES`].
pub fn tile_of(texel: [u32; 2], extent: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|axis| {
        let mut side = texel[axis].max(1);
        while extent[axis].div_ceil(side) > MOST_TILES && side * 2 <= *TEXEL_SIDES.end() {
            side *= 2;
        }
        side
    })
}

/// Shape of a lattice: a view's place in its image, field of view and tile size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeShape {
    /// First pixel of the view in its image: tiles are counted from the image's corner.
    pub offset: [u32; 2],
    /// Size of the view, pixels.
    pub extent: [u32; 2],
    /// Field of view of that rectangle.
    pub fov: Fov,
    /// Size of a tile, pixels, within [`TEXEL_SIDES`].
    pub texel: [u32; 2],
}

/// Unit directions of the corners of all tiles in the view's own space, one array for each component.
#[derive(Clone, Debug, Default)]
pub struct TileLattice {
    tiles: UVec2,
    /// Pixels of the first tile that lie before the view.
    overhang: UVec2,
    texel: UVec2,
    extent: UVec2,
    plane: Option<ImagePlane>,
    /// x of the lines between columns, y of those between rows, on the plane one unit ahead.
    lines: [Vec<f32>; 2],
    corners: [Vec<f32>; 3],
    /// Pixels per degree in the middle of each tile.
    resolution: Vec<f32>,
    /// Two rows of corners of the chord being computed, kept so that a frame allocates nothing.
    rows: [Vec<f32>; 2],
}

impl TileLattice {
    /// Computes the corners for `shape`. Sides beyond [`MAX_SIDE`] and tiles outside of [`TEXEL_SIDES`] are limited.
    pub fn set(&mut self, shape: &LatticeShape) {
        self.texel =
            UVec2::from(shape.texel.map(|side| side.clamp(*TEXEL_SIDES.start(), *TEXEL_SIDES.end())));
        self.extent = UVec2::from(shape.extent).min(UVec2::splat(MAX_SIDE));
        self.overhang = UVec2::from(shape.offset) % self.texel;
        let covered = self.extent + self.overhang;
        let empty = self.extent.cmpeq(UVec2::ZERO).any();
        self.tiles = if empty {
            UVec2::ZERO
        } else {
            UVec2::new(covered.x.div_ceil(self.texel.x), covered.y.div_ceil(self.texel.y))
        };
        let plane = shape.fov.tangents().plane(shape.extent);
        self.plane = Some(plane);
        for component in &mut self.corners {
            component.clear();
        }
        let lines = if empty { UVec2::ZERO } else { self.tiles + 1 };
        for axis in 0..2 {
            let at = |index| plane.direction(self.corner_pixel(UVec2::splat(index)))[axis];
            let line: Vec<f32> = (0..lines[axis]).map(at).collect();
            self.lines[axis] = line;
        }
        for y in &self.lines[1] {
            for x in &self.lines[0] {
                let direction = Vec3::new(*x, *y, -1.0).normalize();
                for (component, value) in self.corners.iter_mut().zip(direction.to_array()) {
                    component.push(value);
                }
            }
        }
        self.resolution.clear();
        for y in 0..self.tiles.y {
            for x in 0..self.tiles.x {
                let at = UVec2::new(x, y);
                let middle = (self.corner_pixel(at) + self.corner_pixel(at + 1)) * 0.5;
                self.resolution.push(pixels_per_degree(&plane, middle));
            }
        }
        for row in &mut self.rows {
            row.clear();
            row.resize(lines.x as usize, 0.0);
        }
    }

    /// Columns and rows of tiles.
    pub fn tiles(&self) -> [u32; 2] {
        self.tiles.into()
    }

    /// Size of a tile, pixels.
    pub fn texel(&self) -> [u32; 2] {
        self.texel.into()
    }

    /// Size of the view, pixels.
    pub(super) fn extent(&self) -> [u32; 2] {
        self.extent.into()
    }

    /// Pixels of the first tile that lie before the view.
    pub(super) fn overhang(&self) -> [u32; 2] {
        self.overhang.into()
    }

    /// Image plane of the view; one point before the first [`Self::set`].
    pub(super) fn plane(&self) -> ImagePlane {
        self.plane.unwrap_or(ImagePlane { origin: Vec2::ZERO, step: Vec2::ZERO })
    }

    /// Pixels per degree in the middle of each tile, row by row, see [`pixels_per_degree`].
    pub fn resolution(&self) -> &[f32] {
        &self.resolution
    }

    /// Pixels of the view that column `x` (or row) `index` of tiles covers on `axis` (0 horizontal, 1 vertical).
    pub fn covered(&self, axis: usize, index: u32) -> u32 {
        let line = |index: u32| {
            (index * self.texel[axis]).saturating_sub(self.overhang[axis]).min(self.extent[axis])
        };
        line(index + 1) - line(index)
    }

    /// Unit direction of the corner in column `x` and row `y` of the lattice, view space.
    pub fn corner(&self, x: u32, y: u32) -> Vec3 {
        let index = y as usize * (self.tiles.x as usize + 1) + x as usize;
        Vec3::from_array([0, 1, 2].map(|axis: usize| self.corners[axis][index]))
    }

    /// x of the lines between columns of tiles and y of those between rows, on the plane one unit ahead.
    pub(super) fn lines(&self) -> [&[f32]; 2] {
        [&self.lines[0], &self.lines[1]]
    }

    /// The edges of the view, farther out by some pixels; `None` without tiles.
    pub(super) fn edges(&self, pixels: f32) -> Option<FovTangents> {
        let plane = self.plane.filter(|_| self.tiles != UVec2::ZERO)?;
        let first = plane.origin - plane.step * pixels;
        let last = plane.origin + plane.step * (self.extent.as_vec2() + pixels);
        Some(FovTangents { left: first.x, right: last.x, up: first.y, down: last.y })
    }

    /// The tiles as pixels of a view with this orientation; `None` without tiles. Tiles cut by the border are whole there.
    pub(super) fn tile_view(&self, orientation: Quat) -> Option<View> {
        let plane = self.plane.filter(|_| self.tiles != UVec2::ZERO)?;
        let plane = ImagePlane {
            origin: plane.origin - plane.step * self.overhang.as_vec2(),
            step: plane.step * self.texel.as_vec2(),
        };
        Some(View { orientation, plane })
    }

    /// Position of a corner of the lattice in the view, pixels; tiles end where the view ends.
    pub(super) fn corner_pixel(&self, corner: UVec2) -> Vec2 {
        (corner * self.texel).saturating_sub(self.overhang).min(self.extent).as_vec2()
    }

    /// Squared chord, |a - b|^2 = 4 sin^2(angle / 2) within 0..=4, between the nearest point of each tile and the
    /// nearer one of `gazes` (unit vectors, view space), row by row into `chords`, which has a place for each tile.
    ///
    /// The chord keeps its digits near 0, where the cosine does not; both order angles alike.
    pub fn nearest(&mut self, gazes: [Vec3; 2], chords: &mut [f32]) {
        self.measure_corners(gazes, chords);
        self.lower_by_edges(gazes[0], chords);
        if gazes[1] != gazes[0] {
            self.lower_by_edges(gazes[1], chords);
        }
    }

    fn measure_corners(&mut self, gazes: [Vec3; 2], chords: &mut [f32]) {
        let columns = self.tiles.x as usize;
        if columns == 0 {
            return;
        }
        let [upper, lower] = &mut self.rows;
        let [x, y, z] = &self.corners;
        let row = |index: usize, out: &mut [f32]| {
            let range = index * (columns + 1)..(index + 1) * (columns + 1);
            corner_chords([&x[range.clone()], &y[range.clone()], &z[range]], gazes, out);
        };
        row(0, upper);
        for (index, out) in chords.chunks_exact_mut(columns).enumerate() {
            row(index + 1, lower);
            let corners = upper.iter().zip(&upper[1..]).zip(lower.iter().zip(&lower[1..]));
            for (chord, ((a, b), (c, d))) in out.iter_mut().zip(corners) {
                *chord = least(least(*a, *b), least(*c, *d));
            }
            std::mem::swap(upper, lower);
        }
    }

    /// Lowers the chords of the tiles whose edge, or inside, holds the point nearest to `gaze`.
    fn lower_by_edges(&self, gaze: Vec3, chords: &mut [f32]) {
        let Some(plane) = self.plane else { return };
        let [columns, rows] = self.tiles();
        if columns == 0 || rows == 0 {
            return;
        }
        let mut lower = |x: Option<u32>, y: Option<u32>, chord: f32| {
            if let (Some(x), Some(y)) = (x.filter(|x| *x < columns), y.filter(|y| *y < rows)) {
                let held = &mut chords[y as usize * columns as usize + x as usize];
                *held = least(*held, chord);
            }
        };
        for (line, y) in (0u32..).zip(&self.lines[1]) {
            let (foot, chord) = foot_on(gaze, Vec3::new(0.0, 1.0, *y));
            let column = self.tile_at(&plane, foot, 0);
            lower(column, line.checked_sub(1), chord);
            lower(column, Some(line), chord);
        }
        for (line, x) in (0u32..).zip(&self.lines[0]) {
            let (foot, chord) = foot_on(gaze, Vec3::new(1.0, 0.0, *x));
            let row = self.tile_at(&plane, foot, 1);
            lower(line.checked_sub(1), row, chord);
            lower(Some(line), row, chord);
        }
        lower(self.tile_at(&plane, gaze, 0), self.tile_at(&plane, gaze, 1), 0.0);
    }

    /// Column (`axis` 0) or row (1) of the tile that `direction` meets, if it meets the view.
    pub(super) fn tile_at(&self, plane: &ImagePlane, direction: Vec3, axis: usize) -> Option<u32> {
        if direction.z >= 0.0 {
            return None;
        }
        let pixel = (direction[axis] / -direction.z - plane.origin[axis]) / plane.step[axis];
        // NaN, from a field of view without width, is not inside either.
        let inside = pixel >= 0.0 && pixel <= self.extent[axis] as f32;
        inside.then(|| ((pixel as u32 + self.overhang[axis]) / self.texel[axis]).min(self.tiles[axis] - 1))
    }
}

/// Squared chord from each corner to the nearer gaze.
fn corner_chords([x, y, z]: [&[f32]; 3], gazes: [Vec3; 2], out: &mut [f32]) {
    let chord = |gaze: Vec3, x: f32, y: f32, z: f32| {
        let (dx, dy, dz) = (x - gaze.x, y - gaze.y, z - gaze.z);
        dx * dx + dy * dy + dz * dz
    };
    let corners = out.iter_mut().zip(x).zip(y).zip(z);
    if gazes[0] == gazes[1] {
        corners.for_each(|(((out, x), y), z)| *out = chord(gazes[0], *x, *y, *z));
    } else {
        corners.for_each(|(((out, x), y), z)| {
            *out = least(chord(gazes[0], *x, *y, *z), chord(gazes[1], *x, *y, *z));
        });
    }
}

/// The point nearest to the unit vector `gaze` on the great circle across `normal` (not of unit length), and its
/// squared chord. That point may lie behind the view.
fn foot_on(gaze: Vec3, normal: Vec3) -> (Vec3, f32) {
    let along = gaze.dot(normal) / normal.length_squared();
    let foot = gaze - normal * along;
    // sin of the angle to the circle; the chord by way of 1 - cos = sin^2 / (1 + cos).
    let sin_squared = (along * along * normal.length_squared()).min(1.0);
    (foot, 2.0 * sin_squared / (1.0 + (1.0 - sin_squared).sqrt()))
}

/// The smaller one, as one instruction: `f32::min` has to look for NaN, which cannot occur here.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Squared chord of an angle in degrees, 0..=180.
pub(super) fn chord_of_deg(angle_deg: f32) -> f32 {
    let half = (angle_deg.clamp(0.0, 180.0) * 0.5).to_radians().sin();
    4.0 * half * half
}

/// Angle of a squared chord, degrees within 0..=180.
pub(super) fn deg_of_chord(chord: f32) -> f32 {
    (2.0 * (chord.sqrt() * 0.5).min(1.0).asin()).to_degrees()
}

#[cfg(test)]
mod tests;
