//! Where changes of content are looked for.

use super::Planning;
use glam::{Quat, Vec3};

/// What of a picture of an eye may be re-used in later frames, so that it counts whether it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watched {
    orientation: Quat,
    /// What is rendered in each frame anyhow is around these, in the view's space, ...
    centres: [Vec3; 2],
    /// ... within the angle that has this cosine.
    cosine: f32,
}

impl Planning {
    /// What is watched in pictures of an eye, by the newest plan; nothing where that renders everything in each frame.
    pub fn watched(&self, eye: usize) -> Option<Watched> {
        let plan = self.planner.as_ref()?.newest();
        let always = plan.periods.iter().take_while(|period| **period == 1).count();
        let radius_deg = match always {
            0 => -1.0,
            _ => *plan.regions_deg.get(always - 1)?,
        };
        let cosine = if radius_deg < 0.0 { 2.0 } else { radius_deg.min(180.0).to_radians().cos() };
        Some(Watched { orientation: self.orientations[eye], centres: plan.eyes[eye].centres, cosine })
    }
}

impl Watched {
    /// How the view was turned in the world when its picture was planned.
    pub fn orientation(&self) -> Quat {
        self.orientation
    }

    /// Whether a direction in the view's space, of any length, is watched.
    pub fn is_watched(&self, direction: Vec3) -> bool {
        let limit = self.cosine * direction.length();
        self.centres.iter().all(|centre| centre.dot(direction) < limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_rendered_in_each_frame_anyhow_is_not_watched() {
        let cosine = 9.1f32.to_radians().cos();
        let ahead = Watched { orientation: Quat::IDENTITY, centres: [Vec3::NEG_Z, Vec3::NEG_Z], cosine };
        for (angle_deg, is_watched) in [(0.0f32, false), (8.9, false), (9.3, true), (40.0, true)] {
            let direction = 3.0 * (Quat::from_rotation_y(angle_deg.to_radians()) * Vec3::NEG_Z);
            assert_eq!(ahead.is_watched(direction), is_watched, "{angle_deg}");
        }
        let everywhere = Watched { cosine: 2.0, ..ahead };
        assert!(everywhere.is_watched(Vec3::NEG_Z));
        assert_eq!(Planning::default().watched(0), None, "without a plan");
    }
}
