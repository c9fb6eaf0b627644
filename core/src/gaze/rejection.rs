//! Answers of eye trackers that cannot be true.

use crate::geometry::{Fov, rotation, unit_direction};
use glam::{Quat, Vec3};
use std::fmt;

/// Reason why the newest answer of the eye tracker is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rejection {
    /// The tracker does not stand by it: a blink, most often.
    NotTracked,
    /// It is not a direction: zero, or not finite.
    NotADirection,
    /// It points backwards (SteamVR with a Pimax does).
    Behind,
    /// It is farther to the side than eyes turn.
    OutOfReach,
    /// It is outside of both views.
    OutsideViews,
    /// It is farther from the one before than eyes turn in that time. Until the next sample the tiles there become finer,
    /// as the eyes may be there, and none coarser. A stream of these counts as a lost gaze, as none of them is believed.
    TooFast,
    /// It stays the same for long although the head turns.
    Frozen,
    /// It is older than one that is known.
    OutOfOrder,
}

impl Rejection {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::NotTracked,
        Self::NotADirection,
        Self::Behind,
        Self::OutOfReach,
        Self::OutsideViews,
        Self::TooFast,
        Self::Frozen,
        Self::OutOfOrder,
    ];
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotTracked => "the eyes are not tracked",
            Self::NotADirection => "the gaze is not a direction",
            Self::Behind => "the gaze points backwards",
            Self::OutOfReach => "the gaze is farther to the side than eyes can turn",
            Self::OutsideViews => "the gaze is outside the field of view",
            Self::TooFast => "the gaze moved faster than eyes can",
            Self::Frozen => "the gaze is identical although the head turned",
            Self::OutOfOrder => "the sample is older than the previous one",
        })
    }
}

/// Unit directions of both eyes, or why there are none; an eye that is not seen takes the other's.
pub(super) fn plausible(directions: [Vec3; 2], reach_deg: f32) -> Result<[Vec3; 2], Rejection> {
    let both = match directions.map(unit_direction) {
        [Some(left), Some(right)] => [left, right],
        [Some(one), None] | [None, Some(one)] => [one; 2],
        [None, None] => return Err(Rejection::NotADirection),
    };
    if both.iter().any(|direction| direction.z >= 0.0) {
        return Err(Rejection::Behind);
    }
    let reach = reach_deg.clamp(0.0, 90.0).to_radians().cos();
    if both.iter().any(|direction| -direction.z < reach) {
        return Err(Rejection::OutOfReach);
    }
    Ok(both)
}

/// The directions within both views.
#[derive(Clone, Copy, Debug)]
pub(super) struct Views([(Fov, Quat); 2]);

impl Views {
    /// Limits of fields of view with rotations to the common space; `None` if one is not finite, has no area or is not a rotation.
    pub(super) fn new(views: [(Fov, Quat); 2]) -> Option<Self> {
        let [left, right] = views.map(|(fov, orientation)| {
            let angles = [fov.left, fov.right, fov.up, fov.down];
            let shows =
                angles.iter().all(|angle| angle.is_finite()) && fov.left != fov.right && fov.up != fov.down;
            rotation(orientation).filter(|_| shows).map(|orientation| (fov, orientation))
        });
        Some(Self([left?, right?]))
    }

    /// Whether either eye's direction is in its view, or outside by no more than `margin_deg`.
    pub(super) fn show(&self, directions: [Vec3; 2], margin_deg: f32) -> bool {
        let margin = margin_deg.max(0.0).to_radians();
        let within = |angle: f32, a: f32, b: f32| (a.min(b) - margin..=a.max(b) + margin).contains(&angle);
        self.0.iter().zip(directions).any(|((fov, orientation), direction)| {
            let seen = orientation.inverse() * direction;
            within(seen.x.atan2(-seen.z), fov.left, fov.right)
                && within(seen.y.atan2(-seen.z), fov.down, fov.up)
        })
    }
}
