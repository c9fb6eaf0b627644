//! Angles and speeds of the gaze.

use glam::DVec3;

/// Angle between two directions, radians.
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Speed from `a` to `b` in `span_ns`, degrees a second.
pub fn velocity_deg_s(a: DVec3, b: DVec3, span_ns: i64) -> f64 {
    angle(a, b).to_degrees() / (span_ns as f64 / 1e9)
}
