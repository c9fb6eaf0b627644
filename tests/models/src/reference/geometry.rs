//! View geometry by rays and angles.

use glam::{DQuat, DVec2, DVec3};

/// Angle between two directions, radians: twice the angle whose tangent is |a - b| / |a + b| of the unit vectors.
pub fn eccentricity(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = (a.normalize(), b.normalize());
    2.0 * (a - b).length().atan2((a + b).length())
}

/// Tangents and pixels of a field of view.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// Left, right, up, down.
    pub tangents: [f64; 4],
    /// Width and height.
    pub extent: [f64; 2],
}

impl Image {
    /// With the angles of its edges, radians.
    pub fn new(angles: [f64; 4], extent: [f64; 2]) -> Self {
        Self { tangents: angles.map(f64::tan), extent }
    }

    /// The ray through a pixel.
    pub fn ray(&self, pixel: DVec2) -> DVec3 {
        let [left, right, up, down] = self.tangents;
        let x = left + (right - left) * pixel.x / self.extent[0];
        let y = up + (down - up) * pixel.y / self.extent[1];
        DVec3::new(x, y, -1.0)
    }

    /// Position in the image, pixels, of a ray; None if it does not point ahead.
    pub fn pixel(&self, ray: DVec3) -> Option<DVec2> {
        let [left, right, up, down] = self.tangents;
        let at = DVec2::new(ray.x, ray.y) / -ray.z;
        let pixel = DVec2::new((at.x - left) / (right - left), (at.y - up) / (down - up));
        (ray.z < 0.0).then(|| pixel * DVec2::from(self.extent))
    }

    /// Pixels per degree along the axis on which there are fewer, from the angle that a thousandth of a pixel spans.
    pub fn pixels_per_degree(&self, pixel: DVec2) -> f64 {
        let along = |axis: DVec2| {
            let half = axis * 5e-4;
            1e-3 / eccentricity(self.ray(pixel - half), self.ray(pixel + half)).to_degrees()
        };
        along(DVec2::X).min(along(DVec2::Y))
    }
}

/// Reprojects a pixel of one view into another, by its ray; orientations of unit length. None if the ray does not point ahead there.
pub fn reprojected(
    pixel: DVec2,
    from: &Image,
    to: &Image,
    from_turned: DQuat,
    to_turned: DQuat,
) -> Option<DVec2> {
    to.pixel(to_turned.inverse() * (from_turned * from.ray(pixel)))
}

/// Distance of a depth value: 1 / distance is linear in depth.
pub fn view_distance(depth: f64, [min_depth, max_depth]: [f64; 2], near_z: f64, far_z: f64) -> f64 {
    let t = (depth - min_depth) / (max_depth - min_depth);
    1.0 / ((1.0 - t) / near_z + t / far_z)
}
