//! From an eye's pose and field of view to the matrices of the shader.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Quat, Vec3, Vec4};

/// Distance of the near plane in metres, where depth is 0.
pub const NEAR: f32 = 0.05;
/// Distance of the far plane in metres, where depth is 1.
pub const FAR: f32 = 250.0;

/// One eye.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Position, metres.
    pub position: Vec3,
    /// Orientation: it looks along its -z, +y is up.
    pub orientation: Quat,
    /// Tangents of the angles of the left, right, lower and upper edge; left and lower are negative in a
    /// symmetric view.
    pub tangents: [f32; 4],
}

/// The shader's parameters of a camera; the layout of `View` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewUniform {
    clip_from_world: Mat4,
    ray_centre: Vec3,
    light_count: u32,
    ray_right: Vec3,
    time: f32,
    ray_up: Vec3,
    padding: f32,
    eye: Vec3,
    padding_2: f32,
}

impl Camera {
    /// A camera with the angles of its edges in radians, left and down negative (as in `XrFovf`).
    pub fn new(position: Vec3, orientation: Quat, [left, right, down, up]: [f32; 4]) -> Self {
        Self { position, orientation, tangents: [left.tan(), right.tan(), down.tan(), up.tan()] }
    }

    /// From world space to Vulkan-style clip space with depth 0 (near) to 1 (far), y up.
    pub fn clip_from_world(&self) -> Mat4 {
        let [left, right, down, up] = self.tangents;
        let (width, height, depth) = (right - left, up - down, FAR / (NEAR - FAR));
        let clip_from_view = Mat4::from_cols(
            Vec4::new(2.0 / width, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 2.0 / height, 0.0, 0.0),
            Vec4::new((right + left) / width, (up + down) / height, depth, -1.0),
            Vec4::new(0.0, 0.0, depth * NEAR, 0.0),
        );
        clip_from_view * Mat4::from_rotation_translation(self.orientation, self.position).inverse()
    }

    /// The uniform of this camera.
    pub fn uniform(&self, time: f64, light_count: u32) -> ViewUniform {
        let [left, right, down, up] = self.tangents;
        let world = |x: f32, y: f32, z: f32| self.orientation * Vec3::new(x, y, z);
        ViewUniform {
            clip_from_world: self.clip_from_world(),
            ray_centre: world((left + right) / 2.0, (down + up) / 2.0, -1.0),
            light_count,
            ray_right: world((right - left) / 2.0, 0.0, 0.0),
            time: time as f32,
            ray_up: world(0.0, (up - down) / 2.0, 0.0),
            padding: 0.0,
            eye: self.position,
            padding_2: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of an asymmetric field of view land on the corners of clip space, near and far on 0 and 1.
    #[test]
    fn field_of_view_fills_clip_space() {
        let turned = Quat::from_rotation_y(0.3);
        let camera = Camera::new(Vec3::new(1.0, 2.0, 3.0), turned, [-0.9, 0.6, -0.8, 0.7]);
        let [left, right, down, up] = camera.tangents;
        for (x, y, distance, clip) in [
            (left, down, NEAR, Vec3::new(-1.0, -1.0, 0.0)),
            (right, up, FAR, Vec3::new(1.0, 1.0, 1.0)),
            (left, up, FAR, Vec3::new(-1.0, 1.0, 1.0)),
        ] {
            let point = camera.position + turned * (Vec3::new(x, y, -1.0) * distance);
            let seen = camera.clip_from_world().project_point3(point);
            assert!(seen.abs_diff_eq(clip, 1e-3), "{seen} is not {clip}");
        }
    }
}
