//! A gaze that does not change in any bit although the head turns: a tracker that has stopped, or that never was one.

use crate::gaze::GazeSettings;
use glam::{Quat, Vec3};

/// Fastest that a head turns, degrees a second; what is told to be faster is a jump of the space that it is told in.
const FASTEST_HEAD_DEG_S: f32 = 500.0;

/// What is remembered of the newest sample and of the head.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Freeze {
    directions: Option<[Vec3; 2]>,
    since_ns: i64,
    /// How far the head has turned since then, degrees, there and back.
    turned_deg: f32,
    head: Option<(Quat, i64)>,
    head_deg_s: f32,
}

impl Freeze {
    /// `head` is a unit quaternion. What is told of a time again is a better prediction of it, and no motion.
    pub(super) fn head_turned(&mut self, head: Quat, time_ns: i64) {
        if let Some((before, before_ns)) = self.head.filter(|(_, before_ns)| *before_ns != time_ns) {
            let seconds = (time_ns.saturating_sub(before_ns) as f64 * 1e-9) as f32;
            // Twice the angle of the shorter half turn; 1 - |dot| loses small ones.
            let across = (before.inverse() * head).xyz().length().min(1.0);
            let angle = 2.0 * across.asin().to_degrees();
            if seconds > 0.0 && angle <= FASTEST_HEAD_DEG_S * seconds {
                self.turned_deg += angle;
                self.head_deg_s = angle / seconds;
            } else {
                self.head_deg_s = 0.0;
            }
        }
        self.head = Some((head, time_ns));
    }

    /// Speed of the head, degrees a second; 0 as long as it is not told.
    pub(super) fn head_deg_s(&self) -> f32 {
        self.head_deg_s
    }

    /// Whether these are the newest sample's directions, to the last bit.
    pub(super) fn is_same(&self, directions: [Vec3; 2]) -> bool {
        self.directions.is_some_and(|before| bits(before) == bits(directions))
    }

    /// Takes a sample's directions, and tells whether they have stayed for too long.
    pub(super) fn is_frozen(&mut self, settings: &GazeSettings, directions: [Vec3; 2], now_ns: i64) -> bool {
        if !self.is_same(directions) {
            *self = Self { directions: Some(directions), since_ns: now_ns, turned_deg: 0.0, ..*self };
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
