//! Point lights.

use glam::Vec3;

use super::noise;

/// The most lights that the shader's uniform buffer holds.
pub const MAX: u32 = 256;

/// A point light.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Metres.
    pub position: Vec3,
    /// Distance at which its light ends, metres.
    pub range: f32,
    /// Radiant intensity, linear RGB.
    pub colour: Vec3,
}

/// The first `count` of a scene's own lights; beyond them, faint ones scattered in the box between two corners.
pub fn first(own: impl IntoIterator<Item = Light>, count: u32, [low, high]: [Vec3; 2]) -> Vec<Light> {
    let scattered = (0..).map(|index| Light {
        position: low
            + (high - low)
                * Vec3::new(
                    noise::hash(index, 0, 700),
                    noise::hash(index, 1, 700),
                    noise::hash(index, 2, 700),
                ),
        range: 4.0,
        colour: Vec3::splat(0.05),
    });
    own.into_iter().chain(scattered).take(count as usize).collect()
}
