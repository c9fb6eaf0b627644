//! Eccentricity of a pixel of a submitted image.

use crate::picture::Picture;
use crate::scenario::{Scenario, View};
use glam::{Quat, Vec2, Vec3};
use parafovea_core::geometry::{Fov, eccentricity};

/// Field of view and gaze of one eye, both in the eye's own space.
#[derive(Clone, Copy, Debug)]
pub struct EyeView {
    /// Its field of view.
    pub fov: Fov,
    /// Unit direction of the gaze: +x right, +y up, -z forward.
    pub gaze: Vec3,
}

impl EyeView {
    /// The views of a scenario, with the gaze where its first keyframe puts it.
    pub fn of_scenario(scenario: &Scenario) -> Vec<Self> {
        let direction = scenario.gaze.first().map_or(Vec3::NEG_Z, |gaze| {
            // Yaw about +y turns to the left, pitch about +x upwards.
            let yaw = Quat::from_rotation_y(gaze.yaw_deg.to_radians());
            yaw * Quat::from_rotation_x(gaze.pitch_deg.to_radians()) * Vec3::NEG_Z
        });
        let own = |view: &View| Quat::from_array(view.orientation).inverse() * direction;
        scenario.views.iter().map(|view| Self::new(view, own(view))).collect()
    }

    /// A view of a scenario with a gaze, a unit vector in the eye's own space.
    pub fn new(view: &View, gaze: Vec3) -> Self {
        let degrees = view.fov_deg;
        let [left, right, up, down] =
            [degrees.left, degrees.right, degrees.up, degrees.down].map(f32::to_radians);
        Self { fov: Fov { left, right, up, down }, gaze }
    }

    /// Angle between the gaze and a pixel's centre, in degrees.
    pub fn eccentricity_deg(&self, picture: &Picture, x: u32, y: u32) -> f32 {
        let plane = self.fov.tangents().plane([picture.width, picture.height]);
        let direction = plane.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        eccentricity(self.gaze, direction).to_degrees()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::ScenarioExt;

    #[test]
    fn the_gaze_lies_where_the_scenario_puts_it() {
        let view = EyeView::of_scenario(&Scenario::new(1).gazing(-45.0, 0.0))[0];
        let picture = Picture::from_fn(100, 100, |_, _| [0; 4]);
        // 45 degrees to the right is the middle of the right edge of a view of 90 degrees.
        assert!(view.eccentricity_deg(&picture, 99, 50) < 0.7);
        assert!((view.eccentricity_deg(&picture, 50, 50) - 45.0).abs() < 1.0);
    }

    #[test]
    fn a_canted_view_sees_the_gaze_from_its_side() {
        let mut scenario = Scenario::new(1);
        scenario.views[0].orientation = Quat::from_rotation_y(0.2).to_array();
        let view = EyeView::of_scenario(&scenario)[0];
        // A view turned to the left sees the forward direction on its right.
        assert!((view.gaze.x - 0.2_f32.sin()).abs() < 1e-6, "{}", view.gaze);
    }
}
