//! Poses, from OpenXR and back.

use crate::fault::{Fault, section};
use glam::{Quat, Vec3};
use openxr_sys as xr;

/// A rigid transform from a space to its base space: right-handed, +y up, -z forward, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub orientation: Quat,
    pub position: Vec3,
}

impl Pose {
    pub const IDENTITY: Self = Self { orientation: Quat::IDENTITY, position: Vec3::ZERO };

    /// A pose of the application. Orientations must be of unit length within 1 %, as `XrQuaternionf` demands.
    pub fn checked(name: &str, pose: &xr::Posef) -> Result<Self, Fault> {
        let xr::Quaternionf { x, y, z, w } = pose.orientation;
        let orientation = Quat::from_xyzw(x, y, z, w);
        let position = Vec3::new(pose.position.x, pose.position.y, pose.position.z);
        let length = orientation.length();
        if !((length - 1.0).abs() <= 0.01 && position.is_finite()) {
            let message = format!(
                "{name}: orientation ({x}, {y}, {z}, {w}) has the length {length}, not 1; position {position}"
            );
            return Err(Fault::new(xr::Result::ERROR_POSE_INVALID, section::COORDINATES, message));
        }
        Ok(Self { orientation: orientation.normalize(), position })
    }

    pub fn to_xr(self) -> xr::Posef {
        let [x, y, z, w] = self.orientation.to_array();
        let Vec3 { x: px, y: py, z: pz } = self.position;
        xr::Posef {
            orientation: xr::Quaternionf { x, y, z, w },
            position: xr::Vector3f { x: px, y: py, z: pz },
        }
    }

    /// `inner`, given in the space of this pose, in the base space of this pose.
    pub fn then(self, inner: Self) -> Self {
        Self {
            orientation: (self.orientation * inner.orientation).normalize(),
            position: self.position + self.orientation * inner.position,
        }
    }

    pub fn inverse(self) -> Self {
        let orientation = self.orientation.conjugate();
        Self { orientation, position: -(orientation * self.position) }
    }
}
