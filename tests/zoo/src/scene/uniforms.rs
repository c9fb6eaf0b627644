//! Parameters of a frame, as `Frame` in `scene.wgsl`: they follow from the number of the frame and the views.

use glam::{Mat4, Quat, Vec3, Vec4};
use openxr as xr;

/// Metres to the near plane.
pub const NEAR: f32 = 0.1;

/// Metres to the far plane.
pub const FAR: f32 = 100.0;

/// Radians of the animation a frame.
const STEP: f32 = 0.02;

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct View {
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    eye: Vec4,
}

#[repr(C)]
#[derive(Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
struct Light {
    position: Vec4,
    color: Vec4,
}

/// A frame's uniforms.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Uniforms {
    views: [View; 2],
    lights: [Light; 4],
    /// Phase of the animation, and the sub-pixel offset in clip space.
    animation: Vec4,
}

/// Conversion of views to clip space.
#[derive(Clone, Copy, Default)]
pub struct Projection {
    /// The far plane at depth 0, the near plane at 1.
    pub reversed: bool,
    /// Added to x and y in clip space.
    pub jitter: [f32; 2],
}

impl Uniforms {
    /// Of the frame with this number.
    pub fn new(frame: u64, views: &[xr::View; 2], projection: Projection) -> Self {
        let phase = frame as f32 * STEP;
        Self {
            views: views.each_ref().map(|view| View::new(view, projection)),
            lights: std::array::from_fn(|index| Light::new(index, phase)),
            animation: Vec4::new(phase, projection.jitter[0], projection.jitter[1], 0.0),
        }
    }
}

impl Uniforms {
    /// The same with the lights out.
    pub fn dark(&self) -> Self {
        Self { lights: Default::default(), ..*self }
    }

    /// Of the animation, in radians.
    pub fn phase(&self) -> f32 {
        self.animation.x
    }
}

impl View {
    fn new(view: &xr::View, projection: Projection) -> Self {
        let (position, orientation) = (view.pose.position, view.pose.orientation);
        let eye = Vec3::new(position.x, position.y, position.z);
        let turn = Quat::from_xyzw(orientation.x, orientation.y, orientation.z, orientation.w);
        let world_from_view = Mat4::from_rotation_translation(turn, eye);
        let clip_from_world = clip_from_view(&view.fov, projection) * world_from_view.inverse();
        Self { clip_from_world, world_from_clip: clip_from_world.inverse(), eye: eye.extend(1.0) }
    }
}

impl Light {
    /// Four lights that circle above the boxes.
    fn new(index: usize, phase: f32) -> Self {
        let angle = phase * 0.5 + index as f32 * std::f32::consts::FRAC_PI_2;
        let position = Vec3::new(5.0 * angle.cos(), 2.5 + 0.5 * index as f32, -7.0 + 4.0 * angle.sin());
        let colors = [[1.0, 0.85, 0.6], [0.6, 0.8, 1.0], [1.0, 0.6, 0.7], [0.7, 1.0, 0.75]];
        Self { position: position.extend(1.0), color: Vec3::from(colors[index]).extend(0.0) }
    }
}

/// Clip space of Vulkan, y pointing down, from a view's, y pointing up and looking along -z.
fn clip_from_view(fov: &xr::Fovf, projection: Projection) -> Mat4 {
    let (left, right) = (fov.angle_left.tan(), fov.angle_right.tan());
    let (down, up) = (fov.angle_down.tan(), fov.angle_up.tan());
    let (near, far) = if projection.reversed { (FAR, NEAR) } else { (NEAR, FAR) };
    let [x, y] = projection.jitter;
    let (width, height, depth) = (right - left, up - down, far - near);
    Mat4::from_cols(
        Vec4::new(2.0 / width, 0.0, 0.0, 0.0),
        Vec4::new(0.0, -2.0 / height, 0.0, 0.0),
        Vec4::new((right + left) / width - x, -(up + down) / height - y, -far / depth, -1.0),
        Vec4::new(0.0, 0.0, -far * near / depth, 0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOV: xr::Fovf = xr::Fovf { angle_left: -0.9, angle_right: 0.7, angle_up: 0.6, angle_down: -0.8 };

    fn projected(at: Vec3, projection: Projection) -> Vec3 {
        clip_from_view(&FOV, projection).project_point3(at)
    }

    #[test]
    fn corners_of_the_field_of_view_are_those_of_clip_space() {
        for (x, y, clip) in
            [(FOV.angle_left, FOV.angle_up, [-1.0, -1.0]), (FOV.angle_right, FOV.angle_down, [1.0, 1.0])]
        {
            let at = projected(Vec3::new(x.tan(), y.tan(), -1.0) * 7.0, Projection::default());
            assert!((at.x - clip[0]).abs() < 1e-5 && (at.y - clip[1]).abs() < 1e-5, "{at}");
        }
    }

    #[test]
    fn depth_runs_from_the_near_plane_to_the_far_plane() {
        for (reversed, near, far) in [(false, 0.0, 1.0), (true, 1.0, 0.0)] {
            let projection = Projection { reversed, ..Projection::default() };
            assert!((projected(Vec3::NEG_Z * NEAR, projection).z - near).abs() < 1e-5);
            assert!((projected(Vec3::NEG_Z * FAR, projection).z - far).abs() < 1e-5);
        }
    }

    #[test]
    fn jitter_moves_the_picture() {
        let moved = Projection { jitter: [0.01, -0.02], ..Projection::default() };
        let by = projected(Vec3::new(1.0, 2.0, -5.0), moved)
            - projected(Vec3::new(1.0, 2.0, -5.0), Projection::default());
        assert!((by - Vec3::new(0.01, -0.02, 0.0)).length() < 1e-5, "{by}");
    }
}
