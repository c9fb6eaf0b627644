//! The region at full rate: directions near to either of two directions.

use glam::{DVec3, Vec3};
use parafovea_core::gaze::{GazeState, foveal_inflation_deg};
use parafovea_core::plan::SafetySettings;

/// Directions no farther than a radius from either of two centres.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Unit vectors.
    pub centres: [Vec3; 2],
    /// Increase of the radius over its base, degrees.
    pub inflation_deg: f64,
}

impl Region {
    /// With the widening of the safety limits but the tracker's error, which counts to the base.
    pub fn new(gaze: &GazeState) -> Self {
        let safety = SafetySettings::default();
        let (least, error) = (safety.least_foveal_deg, safety.tracker_error_deg);
        let radius = foveal_inflation_deg(least, error, gaze.motion_deg(safety.latency_s));
        Self { centres: gaze.directions, inflation_deg: f64::from(radius - least - error) }
    }

    /// Angle from a direction to the nearer centre, degrees.
    pub fn distance_deg(&self, direction: DVec3) -> f64 {
        self.centres
            .iter()
            .map(|centre| angle_deg(centre.as_dvec3(), direction))
            .fold(f64::INFINITY, f64::min)
    }

    /// Angle between the centres, degrees.
    pub fn separation_deg(&self) -> f64 {
        angle_deg(self.centres[0].as_dvec3(), self.centres[1].as_dvec3())
    }
}

/// Angle between two directions, degrees.
pub fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Solid angle of two caps of a radius together whose centres are this far apart, square degrees.
pub fn union_area_deg2(radius_deg: f64, separation_deg: f64) -> f64 {
    let square = (180.0 / std::f64::consts::PI).powi(2);
    let radius = radius_deg.clamp(0.0, 90.0).to_radians();
    let cap = std::f64::consts::TAU * (1.0 - radius.cos());
    (2.0 * cap - common_area(radius, separation_deg.to_radians())) * square
}

/// Solid angle that two equal caps have in common (Mazonka 2012, Solid angle of conical surfaces), radians and steradians.
fn common_area(radius: f64, separation: f64) -> f64 {
    if separation >= 2.0 * radius {
        return 0.0;
    }
    let half = 0.5 * separation;
    if half < 1e-9 {
        return std::f64::consts::TAU * (1.0 - radius.cos());
    }
    // Each cap's part beyond the great circle half-way between them, twice: a segment of a cap.
    let (tan_half, tan_radius) = (half.tan(), radius.tan());
    let beta = (half.sin() / radius.sin()).clamp(-1.0, 1.0).acos();
    let phi = (tan_half / tan_radius).clamp(-1.0, 1.0).acos();
    2.0 * 2.0 * (beta - phi * radius.cos()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted over a fine grid of directions.
    #[test]
    fn the_area_of_two_caps_is_what_is_counted() {
        for (radius, separation) in
            [(6.1, 9.0), (6.1, 0.0), (5.0, 12.0), (5.0, 3.6), (28.0, 9.0), (10.0, 19.0)]
        {
            let centres = [-0.5, 0.5].map(|side: f64| {
                let angle = (side * separation).to_radians();
                DVec3::new(angle.sin(), 0.0, -angle.cos())
            });
            // Equal areas: z is uniform on a sphere.
            let (rings, spokes) = (2000, 2000);
            let least = f64::cos((radius + separation).to_radians());
            let mut inside = 0;
            for ring in 0..rings {
                let z = least + (1.0 - least) * (f64::from(ring) + 0.5) / f64::from(rings);
                for spoke in 0..spokes {
                    let around = std::f64::consts::TAU * (f64::from(spoke) + 0.5) / f64::from(spokes);
                    let level = (1.0 - z * z).sqrt();
                    let direction = DVec3::new(level * around.cos(), level * around.sin(), -z);
                    let near =
                        centres.iter().any(|centre| centre.dot(direction) >= radius.to_radians().cos());
                    inside += u32::from(near);
                }
            }
            let each = std::f64::consts::TAU * (1.0 - least) / f64::from(rings * spokes);
            let counted = f64::from(inside) * each * (180.0 / std::f64::consts::PI).powi(2);
            let area = union_area_deg2(radius, separation);
            assert!((area / counted - 1.0).abs() < 2e-3, "{radius} {separation}: {area} and {counted}");
        }
    }
}
