//! A gaze that does not change in any bit although the head turns: a tracker that has stopped, or that never was one.

use crate::gaze::GazeSettings;
use glam::Vec3;

/// State of the newest sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FreezeDetector {
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

    /// Whether these are the newest sample's directions, to the last bit.
    pub(super) fn is_same(&self, directions: [Vec3; 2]) -> bool {
        self.directions.is_some_and(|before| bits(before) == bits(directions))
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

fn bits(directions: [Vec3; 2]) -> [[u32; 3]; 2] {
    directions.map(|direction| direction.to_array().map(f32::to_bits))
}
