//! Reprojection between two views: by orientation for distant content, and the parallax of near content.

use super::ImagePlane;
use glam::{Mat3, Quat, Vec2, Vec3};

/// An image with the orientation of the view that it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Rotates from the view's space to one that all views have in common, as `XrPosef::orientation`. Need not be
    /// of unit length; q and -q are the same.
    pub orientation: Quat,
    /// The image. Canted displays have the cant in `orientation`.
    pub plane: ImagePlane,
}

/// The map from pixels of one view to pixels of another that differs in orientation and field of view, not in
/// position: a homography, so one matrix for all pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reprojection {
    /// From (x, y, 1) in pixels to homogeneous pixels.
    matrix: Mat3,
}

impl Reprojection {
    /// The map from pixels of `from` to pixels of `to`. `None` for an invalid orientation
    /// (zero or not finite), or a `to` that spans no angle.
    pub fn between(from: &View, to: &View) -> Option<Self> {
        let turn = rotation(to.orientation)?.inverse() * rotation(from.orientation)?;
        let matrix = to_pixels(&to.plane)? * Mat3::from_quat(turn) * to_directions(&from.plane);
        matrix.is_finite().then_some(Self { matrix })
    }

    /// Position in the second image of a point of the first one, both in pixels; it may be outside of the second image. `None`
    /// for points beside or behind the second view (w <= 0), which its plane does not show.
    pub fn pixel(&self, pixel: Vec2) -> Option<Vec2> {
        let Vec3 { x, y, z: w } = self.matrix * pixel.extend(1.0);
        let found = Vec2::new(x, y) / w;
        (w > 0.0 && found.is_finite()).then_some(found)
    }

    /// The homography, by columns: (x, y, 1) to (x' w, y' w, w), with w > 0 ahead of the second view.
    pub fn matrix(&self) -> Mat3 {
        self.matrix
    }
}

/// Parallax: the vector to add to the homogeneous point of [`Reprojection::matrix`], times the pixel's nearness (1 / distance along -z of
/// its view's space, 1/m), if the view was at `from_m` and the other one, `to`, at `to_m` of the space that both orientations lead to. The
/// last coordinate of the sum is the quotient of both distances, that in `to` by that in the other view. `None` as there.
pub fn parallax(to: &View, from_m: Vec3, to_m: Vec3) -> Option<Vec3> {
    let shift = to_pixels(&to.plane)? * (rotation(to.orientation)?.inverse() * (from_m - to_m));
    shift.is_finite().then_some(shift)
}

/// The rotation that a quaternion of any length means; none for one that is zero or not finite.
pub(crate) fn rotation(orientation: Quat) -> Option<Quat> {
    let vector = glam::Vec4::from(orientation);
    let scaled = vector / vector.abs().max_element();
    (vector.is_finite() && scaled.is_finite()).then(|| Quat::from_vec4(scaled.normalize()))
}

/// From (x, y, 1) in pixels to the direction there: [`ImagePlane::direction`] as a matrix.
fn to_directions(plane: &ImagePlane) -> Mat3 {
    let ImagePlane { origin, step } = *plane;
    Mat3::from_cols(Vec3::X * step.x, Vec3::Y * step.y, origin.extend(-1.0))
}

/// From directions to homogeneous pixels, with w = -z.
fn to_pixels(plane: &ImagePlane) -> Option<Mat3> {
    let ImagePlane { origin, step } = *plane;
    let scale = step.recip();
    let offset = origin * scale;
    scale.is_finite().then(|| Mat3::from_cols(Vec3::X * scale.x, Vec3::Y * scale.y, offset.extend(-1.0)))
}

#[cfg(test)]
mod tests;
