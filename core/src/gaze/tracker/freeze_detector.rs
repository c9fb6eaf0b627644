//! A gaze that does not change although the head turns: a tracker that has stopped, or that never was one.

use crate::gaze::GazeSettings;
use crate::geometry::unit_direction;
use glam::Vec3;

/// Angle within which two directions are one answer of the tracker, degrees. Runtimes that turn the gaze into the world and back change its
/// last bits with every pose of the head, by some 1e-5 degrees; drift and noise of live eyes exceed this within a second.
const UNCHANGED_DEG: f32 = 0.005;

/// Whether the direction `now` of a gaze is the same answer of the tracker as the one `before`: within 0.005 degrees, or both without a
/// meaning.
pub fn is_unchanged(before: Vec3, now: Vec3) -> bool {
    match (unit_direction(before), unit_direction(now)) {
        (Some(before), Some(now)) => before.distance(now) <= UNCHANGED_DEG.to_radians(),
        (None, None) => true,
        _ => false,
    }
}

/// State of the newest answer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FreezeDetector {
    /// Of the first sample with it.
    directions: Option<[Vec3; 2]>,
    since_ns: i64,
    /// Total turn of the head since then, degrees, there and back.
    turned_deg: f32,
}

impl FreezeDetector {
    /// The head has turned by so many degrees.
    pub(super) fn head_turned(&mut self, angle_deg: f32) {
        self.turned_deg += angle_deg;
    }

    /// Whether these are the directions of the newest answer.
    pub(super) fn is_same(&self, directions: [Vec3; 2]) -> bool {
        self.directions.is_some_and(|[left, right]| {
            is_unchanged(left, directions[0]) && is_unchanged(right, directions[1])
        })
    }

    /// Takes a sample's directions, and returns whether they have stayed for too long.
    pub(super) fn is_frozen(&mut self, settings: &GazeSettings, directions: [Vec3; 2], now_ns: i64) -> bool {
        if !self.is_same(directions) {
            *self = Self { directions: Some(directions), since_ns: now_ns, turned_deg: 0.0 };
            return false;
        }
        let stayed_ms = now_ns.saturating_sub(self.since_ns) as f64 * 1e-6;
        stayed_ms >= f64::from(settings.frozen_ms.max(0.0))
            && self.turned_deg > settings.frozen_head_deg.max(0.0)
    }
}
