//! The lights: lamps on the cables, and lanterns that fly about.

use std::f32::consts::TAU;

use glam::{Vec3, vec3};

use super::lamp_cable;
use crate::scene::lights::Light;
use crate::scene::noise;

/// Default number of lights. It sets the cost of a frame: see the crate's README before changing it.
pub const DEFAULT: u32 = 7;
/// Of each three lights two hang on the cables; the third flies.
fn flies(index: u32) -> bool {
    index % 3 == 2
}

/// The first `count` lights at a time in seconds.
pub fn at(time: f64, count: u32) -> Vec<Light> {
    (0..count).map(|index| if flies(index) { lantern(index, time) } else { lamp(index) }).collect()
}

fn lamp(index: u32) -> Light {
    let hanging = index - index / 3;
    let (from, to, sag) = lamp_cable(hanging as usize);
    let along = 0.15 + 0.7 * noise::hash(hanging, 7, 100);
    let position = from.lerp(to, along) - Vec3::Y * (sag * 4.0 * along * (1.0 - along) + 0.09);
    let warmth = noise::hash(hanging, 8, 100);
    Light { position, range: 7.0, colour: vec3(1.0, 0.72, 0.40 + 0.25 * warmth) * 4.5 }
}

fn lantern(index: u32, time: f64) -> Light {
    let phase = noise::hash(index, 1, 200);
    // Whole turns in f64, so that the angle stays exact in long runs.
    let angle = ((time * 0.11 + f64::from(phase)).fract() as f32) * TAU;
    let (sin, cos) = angle.sin_cos();
    let (wide, deep) = (0.8 + 1.4 * noise::hash(index, 2, 200), 1.0 + 1.6 * noise::hash(index, 3, 200));
    let centre = vec3(0.0, 1.3 + 0.9 * noise::hash(index, 4, 200), -4.5 - 4.0 * noise::hash(index, 5, 200));
    // The golden angle keeps the hues of neighbours apart.
    let hue = TAU * (0.92 + 0.381_966 * (index / 3) as f32);
    let colour = [0.0, TAU / 3.0, TAU * 2.0 / 3.0].map(|shift| 0.55 + 0.45 * (hue + shift).cos());
    Light {
        position: centre + vec3(wide * cos, 0.25 * (angle * 3.0).sin(), deep * sin),
        range: 5.0,
        colour: Vec3::from(colour) * 2.5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame's lights are a prefix of a frame with more of them, so that `--lights` only adds.
    #[test]
    fn more_lights_only_add() {
        let (few, many) = (at(1.5, 5), at(1.5, 40));
        for (a, b) in few.iter().zip(&many) {
            assert_eq!((a.position, a.colour), (b.position, b.colour));
        }
    }
}
