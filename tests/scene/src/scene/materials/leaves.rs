//! Cut-out plants: alpha is 1 on a leaf and 0 beside it.

use glam::{Vec2, vec2};

use super::super::noise::{hash, value};
use super::super::texture::{Encoding, Texture};
use super::{SIDE, mix};

/// Depth of a point within a leaf between two points: 0 on its edge, 1 on its middle line, negative outside.
fn inside(point: Vec2, [base, tip]: [Vec2; 2], width: f32) -> f32 {
    let along = tip - base;
    let t = (point - base).dot(along) / along.length_squared();
    if !(0.0..=1.0).contains(&t) {
        return -1.0;
    }
    let off = point.distance(base + along * t);
    // Widest a little below the middle.
    let half = width * (t * (1.0 - t) * 4.0).sqrt() * (1.2 - 0.5 * t);
    1.0 - off / half.max(1e-4)
}

/// A twig with eleven leaves that grows from the middle of the lower edge.
pub fn twigs() -> Texture {
    let leaves: Vec<_> = (0..11)
        .map(|index| {
            let along = 0.08 + 0.075 * index as f32;
            let base = vec2(0.5 + 0.04 * (along * 9.0).sin(), 1.0 - along);
            let side = if index % 2 == 0 { 1.0 } else { -1.0 };
            let length = 0.34 - 0.012 * index as f32;
            let angle = side * (0.95 - 0.07 * index as f32 + 0.3 * (hash(index, 0, 41) - 0.5));
            ([base, base + vec2(angle.sin(), -angle.cos()) * length], index)
        })
        .collect();
    Texture::from_fn(SIDE, Encoding::Srgb, |u, v| {
        let point = vec2(u, v);
        let twig = (point.x - 0.5 - 0.04 * ((1.0 - v) * 9.0).sin()).abs() < 0.008 && v > 0.1;
        let leaf = leaves
            .iter()
            .map(|(leaf, index)| (inside(point, *leaf, 0.055), *index))
            .rfind(|(depth, _)| *depth > 0.0);
        match leaf {
            Some((depth, index)) => {
                let hue = hash(index, 1, 41);
                let blade = mix([0.05, 0.17, 0.02], [0.20, 0.34, 0.05], hue);
                let vein = if depth > 0.92 { 1.5 } else { 0.8 + 0.3 * value(u, v, 64, 42) };
                let [r, g, b] = blade.map(|c| c * vein);
                [r, g, b, 1.0]
            }
            None if twig => [0.14, 0.09, 0.05, 1.0],
            // At the edges, mips blend in the colour of a leaf, not black.
            None => [0.10, 0.22, 0.03, 0.0],
        }
    })
}

/// Blades of grass that grow from the lower edge.
pub fn grass() -> Texture {
    let blades: Vec<_> = (0..26)
        .map(|index| {
            let base = vec2(0.04 + 0.92 * hash(index, 0, 43), 1.05);
            let lean = 0.35 * (hash(index, 1, 43) - 0.5);
            [base, base + vec2(lean, -0.55 - 0.48 * hash(index, 2, 43))]
        })
        .collect();
    Texture::from_fn(SIDE / 2, Encoding::Srgb, |u, v| {
        let found = blades.iter().enumerate().find(|(_, blade)| inside(vec2(u, v), **blade, 0.012) > 0.0);
        match found {
            Some((index, _)) => {
                let dry = hash(index as u32, 3, 43);
                let [r, g, b] = mix([0.07, 0.20, 0.02], [0.36, 0.36, 0.10], dry * dry);
                let shade = 0.45 + 0.75 * (1.0 - v);
                [r * shade, g * shade, b * shade, 1.0]
            }
            None => [0.14, 0.24, 0.05, 0.0],
        }
    })
}
