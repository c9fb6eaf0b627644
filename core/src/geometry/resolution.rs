//! Pixels per degree of view, at a pixel: a planar image has more of them the farther out.

use super::ImagePlane;
use glam::Vec2;

/// Pixels per degree of view along the image's two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Along a row, pixels per degree, from 0 on, finite.
    pub horizontal: f32,
    /// Along a column, pixels per degree, from 0 on, finite.
    pub vertical: f32,
}

/// Pixels per degree at a point of the image, in pixels (a pixel's centre is at + 0.5).
///
/// With (x, y) the point on the plane z = -1, moving it by dx turns its direction by
/// dx sqrt(1 + y^2) / (1 + x^2 + y^2), and likewise for y. An axis along which the image spans no angle, and a
/// point that is not finite, give 0.
pub fn resolution(plane: &ImagePlane, pixel: Vec2) -> Resolution {
    let point = plane.origin + plane.step * pixel;
    let squared = point * point;
    let reach = 1.0 + squared.x + squared.y;
    let along = |step: f32, across: f32| {
        let per_radian = reach / ((1.0 + across).sqrt() * step.abs());
        if per_radian.is_finite() { per_radian.to_radians() } else { 0.0 }
    };
    Resolution { horizontal: along(plane.step.x, squared.y), vertical: along(plane.step.y, squared.x) }
}

/// The lesser of both axes of [`resolution`], pixels per degree.
///
/// Half of it is the highest frequency, in cycles per degree, that the image shows along every axis. The lesser
/// one, because frequencies that are taken too low are seen too well, which asks for finer shading.
pub fn pixels_per_degree(plane: &ImagePlane, pixel: Vec2) -> f32 {
    let Resolution { horizontal, vertical } = resolution(plane, pixel);
    horizontal.min(vertical)
}

#[cfg(test)]
mod tests;
