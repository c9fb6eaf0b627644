//! Poses, and the validity of the pose of a gaze.

use crate::inputs::gaze::{degrees, rotation, turn};
use glam::{Quat, Vec3};
use openxr_sys as xr;
use xr::SpaceLocationFlags as Flags;

/// A pose: from its own space to the one that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    orientation: Quat,
    /// In metres.
    position: Vec3,
}

impl Pose {
    /// A pose of OpenXR; `None` if its orientation is not a rotation.
    pub fn read(pose: &xr::Posef) -> Option<Self> {
        let xr::Quaternionf { x, y, z, w } = pose.orientation;
        let xr::Vector3f { x: right, y: up, z: back } = pose.position;
        Some(Self { orientation: rotation(x, y, z, w)?, position: Vec3::new(right, up, back) })
    }

    /// The same for OpenXR.
    pub fn written(self) -> xr::Posef {
        let [x, y, z, w] = self.orientation.to_array();
        let [right, up, back] = self.position.to_array();
        xr::Posef {
            orientation: xr::Quaternionf { x, y, z, w },
            position: xr::Vector3f { x: right, y: up, z: back },
        }
    }

    /// The gaze in the space of the head: it begins between the eyes, looks along -z, and its +y is up as far as it can be.
    pub fn of_gaze(direction: Vec3) -> Self {
        Self { orientation: turn(degrees(direction)), position: Vec3::ZERO }
    }

    /// `inner`, a pose in this one, as a pose where this one is.
    pub fn then(self, inner: Self) -> Self {
        Self {
            orientation: (self.orientation * inner.orientation).normalize(),
            position: self.position + self.orientation * inner.position,
        }
    }

    /// The pose of the outer space in this one.
    pub fn inverse(self) -> Self {
        let orientation = self.orientation.inverse();
        Self { orientation, position: orientation * -self.position }
    }
}

/// Validity of a location that goes through the pose of a gaze, by that of the location of the head: the gaze is tracked wholly or not at
/// all (XR_EXT_eye_gaze_interaction, "Eye gaze input").
pub fn flags(head: Flags) -> Flags {
    if !head.contains(Flags::ORIENTATION_VALID) {
        return Flags::EMPTY;
    }
    let valid = head & (Flags::ORIENTATION_VALID | Flags::POSITION_VALID);
    let tracked = Flags::ORIENTATION_TRACKED | Flags::POSITION_TRACKED;
    if head.contains(tracked | Flags::POSITION_VALID) { valid | tracked } else { valid }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::gaze::direction;

    #[test]
    fn a_pose_and_its_inverse_cancel_out() {
        let pose = Pose { orientation: turn([30.0, -12.0]), position: Vec3::new(1.0, 2.0, -3.0) };
        for both in [pose.then(pose.inverse()), pose.inverse().then(pose)] {
            assert!(both.position.length() < 1e-5 && both.orientation.angle_between(Quat::IDENTITY) < 1e-3);
        }
        let point = Pose { orientation: Quat::IDENTITY, position: Vec3::NEG_Z };
        let turned = Pose { orientation: turn([90.0, 0.0]), position: Vec3::Y }.then(point);
        assert!(turned.position.abs_diff_eq(Vec3::new(-1.0, 1.0, 0.0), 1e-6), "{turned:?}");
    }

    #[test]
    fn the_gaze_looks_along_its_direction_without_roll() {
        let at = direction([-20.0, 10.0]);
        let pose = Pose::of_gaze(at * 3.0);
        assert!((pose.orientation * Vec3::NEG_Z).abs_diff_eq(at, 1e-6));
        assert!((pose.orientation * Vec3::X).y.abs() < 1e-6);
        assert_eq!(Pose::read(&pose.written()).map(|read| read.position), Some(Vec3::ZERO));
    }

    #[test]
    fn the_gaze_is_tracked_wholly_or_not_at_all() {
        let orientation = Flags::ORIENTATION_VALID | Flags::ORIENTATION_TRACKED;
        let position = Flags::POSITION_VALID | Flags::POSITION_TRACKED;
        assert_eq!(flags(orientation | position), orientation | position);
        assert_eq!(flags(orientation), Flags::ORIENTATION_VALID);
        let inferred = Flags::ORIENTATION_VALID | Flags::POSITION_VALID;
        assert_eq!(flags(orientation | Flags::POSITION_VALID), inferred);
        assert_eq!(flags(position), Flags::EMPTY);
    }
}
