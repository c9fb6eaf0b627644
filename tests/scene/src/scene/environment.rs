//! Sun, sky, air, wind and reflections of polished surfaces.

use bytemuck::{Pod, Zeroable};

/// Light and air of a scene; the layout of `Environment` in `scenes.wgsl`. Radiance is linear; 1 before tone mapping is
/// about 0.8 of the display's white after it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Environment {
    /// Unit vector towards the sun or the moon.
    pub sun_direction: [f32; 3],
    /// Share of light that a metre of air replaces by the horizon's.
    pub fog_per_m: f32,
    /// Irradiance of the sun.
    pub sun: [f32; 3],
    /// Share of the sky under clouds, 0 to 1.
    pub cloud: f32,
    /// Light from above.
    pub sky_light: [f32; 3],
    /// Amplitude of the swing of leaves, metres.
    pub wind: f32,
    /// Light from below.
    pub ground_light: [f32; 3],
    /// Height of the mirror's plane on the z axis; read only where there is one.
    pub mirror_z: f32,
    /// Radiance of the sky overhead.
    pub zenith: [f32; 3],
    /// Whether there is a mirror, 1 or 0.
    pub has_mirror: f32,
    /// Radiance of the sky at the horizon.
    pub horizon: [f32; 3],
    /// Radiance of a star, 0 where there are none.
    pub stars: f32,
    /// Lowest corner of the room that polished surfaces reflect.
    pub room_min: [f32; 3],
    /// Radiance of the panels of light in the room's ceiling.
    pub panels: f32,
    /// Highest corner of that room; not above the lowest: the sky is reflected.
    pub room_max: [f32; 3],
    /// Exposure, a factor before tone mapping.
    pub exposure: f32,
}

impl Environment {
    /// A clear day without anything special.
    pub const DAY: Self = Self {
        // (0.5, 0.7, -0.51) made a unit vector.
        sun_direction: [0.5, 0.7, -0.509_902],
        fog_per_m: 0.0,
        sun: [2.6, 2.3, 1.9],
        cloud: 0.45,
        sky_light: [0.26, 0.32, 0.44],
        wind: 0.0,
        ground_light: [0.12, 0.11, 0.09],
        mirror_z: 0.0,
        zenith: [0.10, 0.24, 0.62],
        has_mirror: 0.0,
        horizon: [0.72, 0.82, 0.95],
        stars: 0.0,
        room_min: [0.0; 3],
        panels: 0.0,
        room_max: [0.0; 3],
        exposure: 1.0,
    };

    /// No sun and no sky: lamps are the only light.
    pub const INDOORS: Self = Self {
        sun: [0.0; 3],
        sky_light: [0.0; 3],
        ground_light: [0.0; 3],
        zenith: [0.0; 3],
        horizon: [0.0; 3],
        cloud: 0.0,
        ..Self::DAY
    };
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::scene::SceneName;

    #[test]
    fn directions_to_the_sun_are_unit_vectors() {
        for environment in SceneName::ALL.iter().filter_map(|name| name.definition().environment) {
            assert!(Vec3::from(environment.sun_direction).is_normalized(), "{environment:?}");
        }
    }
}
