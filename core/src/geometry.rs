//! View geometry: direction of a pixel, its angle from the gaze, resolution of the image there, and its position in another view.
//!
//! View space is OpenXR's: +x right, +y up, -z forward. Angles are in radians unless a name has another unit.

mod cap;
mod depth;
mod reprojection;
mod resolution;
mod tile;

pub use cap::Cap;
pub use depth::{DepthRange, MAX_VIEW_DISTANCE_M, Nearness, view_distance};
pub(crate) use reprojection::rotation;
pub use reprojection::{Reprojection, View, parallax};
pub use resolution::{Resolution, pixels_per_degree, resolution};
pub use tile::{EccentricityRange, PixelRect, tile_eccentricity};

use glam::{Vec2, Vec3};

/// Widest half angle of a field of view that [`Fov`] represents, 89 degrees: a planar image cannot reach 90.
const MAX_HALF_ANGLE: f32 = 89.0 * std::f32::consts::PI / 180.0;

/// Field of view of one view, as `XrFovf`: angles of the four edges from -z, in radians.
///
/// Left and down are negative in an upright, symmetric view. Mirrored views (left > right) are legal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fov {
    /// Angle of the left edge.
    pub left: f32,
    /// Angle of the right edge.
    pub right: f32,
    /// Angle of the upper edge.
    pub up: f32,
    /// Angle of the lower edge.
    pub down: f32,
}

impl Fov {
    /// Tangents of the edges, always finite: angles beyond 89 degrees count as 89, NaN as 0.
    pub fn tangents(&self) -> FovTangents {
        let tangent = |angle: f32| {
            if angle.is_nan() { 0.0 } else { angle.clamp(-MAX_HALF_ANGLE, MAX_HALF_ANGLE).tan() }
        };
        FovTangents {
            left: tangent(self.left),
            right: tangent(self.right),
            up: tangent(self.up),
            down: tangent(self.down),
        }
    }
}

/// [`Fov`] on the plane one unit ahead: the coordinates of the image's edges there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FovTangents {
    /// x of the left edge.
    pub left: f32,
    /// x of the right edge.
    pub right: f32,
    /// y of the upper edge.
    pub up: f32,
    /// y of the lower edge.
    pub down: f32,
}

impl FovTangents {
    /// The affine map from pixels of an image of `extent` pixels to that plane. A side of 0 pixels counts as 1.
    pub fn plane(&self, extent: [u32; 2]) -> ImagePlane {
        ImagePlane {
            origin: Vec2::new(self.left, self.up),
            step: Vec2::new(
                (self.right - self.left) / extent[0].max(1) as f32,
                (self.down - self.up) / extent[1].max(1) as f32,
            ),
        }
    }
}

/// An image as a rectangle on the plane z = -1 of view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImagePlane {
    /// Position of the outer corner of pixel (0, 0).
    pub origin: Vec2,
    /// From one pixel to the next, to the right and downwards (so y is negative in an upright view).
    pub step: Vec2,
}

impl ImagePlane {
    /// View-space direction, not normalised, of a point in pixels (a pixel's centre is at + 0.5).
    pub fn direction(&self, pixel: Vec2) -> Vec3 {
        (self.origin + self.step * pixel).extend(-1.0)
    }
}

/// Angle between two directions of any length, in radians within 0..=pi.
///
/// The form atan2(|a x b|, a . b) is accurate near 0 and pi, where acos of the dot product is not. Directions
/// without a meaning (zero, infinite, NaN) give 0: an unknown position is treated as at the gaze.
pub fn eccentricity(a: Vec3, b: Vec3) -> f32 {
    let (a, b) = (scaled_to_one(a), scaled_to_one(b));
    // + 0: the dot product of nothing may be -0, for which atan2 gives pi.
    a.cross(b).length().atan2(a.dot(b) + 0.0)
}

/// `v` with a length of 1, for any that is finite and not zero.
pub(crate) fn unit_direction(v: Vec3) -> Option<Vec3> {
    scaled_to_one(v).try_normalize()
}

/// `v` divided by its largest component, so that products of two such neither overflow nor vanish.
fn scaled_to_one(v: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if v.is_finite() && largest > 0.0 { v / largest } else { Vec3::ZERO }
}

#[cfg(test)]
mod tests;
