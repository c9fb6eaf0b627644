//! Directions of the gaze, as unit vectors. Quaternions rotate from a view to the space that it is posed in; views and
//! the head look along -z.

pub mod auto;
pub mod correction;
mod look;
pub mod osc;
pub mod recording;
pub mod script;

pub use look::Look;

use glam::{EulerRot, Quat, Vec3};

/// Direction in which a view looks, in its own space.
pub const FORWARD: Vec3 = Vec3::NEG_Z;

/// An orientation as OpenXR gives it, made a unit quaternion; `None` for one that is not a rotation.
pub fn rotation(x: f32, y: f32, z: f32, w: f32) -> Option<Quat> {
    let quaternion = Quat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    (length.is_finite() && length > 0.5).then(|| quaternion.normalize())
}

/// A unit vector of angles from the centre of the view, degrees: to the left about +y, then upwards about the new +x.
pub fn direction([left, up]: [f32; 2]) -> Vec3 {
    turn([left, up]) * FORWARD
}

/// The turn by such angles.
pub fn turn([left, up]: [f32; 2]) -> Quat {
    Quat::from_euler(EulerRot::YXZ, left.to_radians(), up.to_radians(), 0.0)
}

/// Such angles of a direction of any length but 0.
pub fn degrees(direction: Vec3) -> [f32; 2] {
    let across = direction.x.hypot(direction.z);
    [(-direction.x).atan2(-direction.z), direction.y.atan2(across)].map(f32::to_degrees)
}

/// A gaze farther to the left and upwards by so many degrees.
pub fn turned(look: Look, [left, up]: [f32; 2]) -> Look {
    match look {
        Look::At { direction: seen, sampled_ns, uncertainty_ns } if [left, up] != [0.0; 2] => {
            let [seen_left, seen_up] = degrees(seen);
            let direction = direction([seen_left + left, seen_up + up]);
            Look::At { direction, sampled_ns, uncertainty_ns }
        }
        other => other,
    }
}

/// `direction` as seen from a view.
pub fn in_view(direction: Vec3, view: Quat) -> Vec3 {
    view.inverse() * direction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_turns_a_gaze_that_is_there_and_nothing_else() {
        let at = |left_up| Look::At { direction: direction(left_up), sampled_ns: 7, uncertainty_ns: 3 };
        let Look::At { direction: found, sampled_ns: 7, uncertainty_ns: 3 } =
            turned(at([10.0, -5.0]), [1.5, -0.5])
        else {
            panic!("no gaze");
        };
        assert!(found.abs_diff_eq(direction([11.5, -5.5]), 1e-6), "{found}");
        for look in [Look::NoTracker, Look::Unseen] {
            assert_eq!(turned(look, [1.5, -0.5]), look);
        }
        // Without a correction, the tracker's answer stays unchanged.
        let zero = Look::At { direction: Vec3::ZERO, sampled_ns: 7, uncertainty_ns: 3 };
        assert_eq!(turned(zero, [0.0; 2]), zero);
    }

    #[test]
    fn invalid_quaternions_are_refused() {
        assert_eq!(rotation(0.0, 0.0, 0.0, 0.0), None);
        assert_eq!(rotation(f32::NAN, 0.0, 0.0, 1.0), None);
        assert_eq!(rotation(0.0, 0.0, 0.0, 1.1), Some(Quat::IDENTITY));
    }
}
