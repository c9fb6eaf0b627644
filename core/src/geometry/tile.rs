//! Nearest and farthest eccentricity of a rectangle of pixels.

use super::{ImagePlane, eccentricity, scaled_to_one};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A rectangle in pixels, from the outer corner of its first pixel to that of its last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelRect {
    /// Upper left corner.
    pub min: Vec2,
    /// Lower right corner.
    pub max: Vec2,
}

/// The eccentricities that occur within a rectangle, in radians within 0..=pi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EccentricityRange {
    /// That of the point nearest to the gaze.
    pub min: f32,
    /// That of the farthest point.
    pub max: f32,
}

/// Range of [`eccentricity`] over all points of `rect` on `plane`, exact up to rounding, for any gaze.
///
/// A gaze without a meaning (zero, infinite, NaN) gives 0 for both, as [`eccentricity`] does.
pub fn tile_eccentricity(plane: &ImagePlane, rect: PixelRect, gaze: Vec3) -> EccentricityRange {
    let gaze = scaled_to_one(gaze);
    if gaze == Vec3::ZERO {
        return EccentricityRange { min: 0.0, max: 0.0 };
    }
    let corners = [
        plane.direction(rect.min),
        plane.direction(Vec2::new(rect.max.x, rect.min.y)),
        plane.direction(rect.max),
        plane.direction(Vec2::new(rect.min.x, rect.max.y)),
    ];
    // The farthest point from the gaze is the nearest one to its opposite.
    EccentricityRange { min: nearest(&corners, gaze), max: PI - nearest(&corners, -gaze) }
}

/// Angle from `gaze` to the nearest point of the rectangle with these corners on the plane z = -1.
fn nearest(corners: &[Vec3; 4], gaze: Vec3) -> f32 {
    if pierces(corners, gaze) {
        return 0.0;
    }
    (0..4).map(|i| arc_distance(gaze, corners[i], corners[(i + 1) % 4])).fold(PI, f32::min)
}

/// Whether the ray along `gaze` meets the rectangle; corners 0 and 2 are opposite.
fn pierces(corners: &[Vec3; 4], gaze: Vec3) -> bool {
    if gaze.z >= 0.0 {
        return false;
    }
    let point = gaze.truncate() / -gaze.z;
    let (a, b) = (corners[0].truncate(), corners[2].truncate());
    point.cmpge(a.min(b)).all() && point.cmple(a.max(b)).all()
}

/// Angle from `gaze` to the nearest point of the great-circle arc from `a` to `b`, the image of a straight edge on the sphere of
/// directions.
fn arc_distance(gaze: Vec3, a: Vec3, b: Vec3) -> f32 {
    let ends = eccentricity(gaze, a).min(eccentricity(gaze, b));
    let normal = a.cross(b).normalize_or_zero();
    let foot = gaze - normal * gaze.dot(normal);
    let within = a.cross(foot).dot(normal) > 0.0 && foot.cross(b).dot(normal) > 0.0;
    if within { ends.min(eccentricity(gaze, foot)) } else { ends }
}
