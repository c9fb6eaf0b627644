//! The surfaces: brick, stone tiles, wood, plaster, metal. A height field and a colour make a material.

use super::noise::{fractal, hash, value};
use super::texture::{Encoding, Texture};
use super::{Material, text};

/// Texels along each side of the repeating textures.
pub const SIDE: u32 = 512;

/// The two textures that every surface has.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Diffuse colour.
    pub albedo: Texture,
    /// Tangent-space normal in RGB (0.5 is zero) and roughness in alpha.
    pub relief: Texture,
}

/// The textures of a material.
pub fn surface_of(material: Material) -> Surface {
    match material {
        Material::Brick => brick(),
        Material::Tiles => tiles(),
        Material::Wood => wood(),
        Material::Plaster => plaster(),
        Material::Metal => metal(),
        Material::Board => Surface { albedo: text::board(), relief: smooth(0.4) },
        Material::Lamp => {
            Surface { albedo: Texture::from_fn(4, Encoding::Srgb, |_, _| [1.0; 4]), relief: smooth(0.5) }
        }
    }
}

struct Texel {
    colour: [f32; 3],
    height: f32,
    roughness: f32,
}

fn surface(depth: f32, texel: impl Fn(f32, f32) -> Texel) -> Surface {
    let albedo = Texture::from_fn(SIDE, Encoding::Srgb, |u, v| {
        let [r, g, b] = texel(u, v).colour;
        [r, g, b, 1.0]
    });
    let step = 1.0 / SIDE as f32;
    let relief = Texture::from_fn(SIDE, Encoding::Linear, |u, v| {
        let here = texel(u, v);
        let du = (texel(u + step, v).height - here.height) * depth * SIDE as f32;
        let dv = (texel(u, v + step).height - here.height) * depth * SIDE as f32;
        let length = (du * du + dv * dv + 1.0).sqrt();
        // v grows downwards in the texture, the bitangent upwards on the surface.
        [0.5 - 0.5 * du / length, 0.5 + 0.5 * dv / length, 0.5 + 0.5 / length, here.roughness]
    });
    Surface { albedo, relief }
}

fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

/// 0 in the joint between two blocks, 1 on the block; `x` and `y` in blocks, `joint` in blocks.
fn block(x: f32, y: f32, joint: [f32; 2]) -> f32 {
    let edge = |t: f32, joint: f32| {
        let distance = (t.fract().min(1.0 - t.fract()) / joint).min(1.0);
        distance * distance * (3.0 - 2.0 * distance)
    };
    edge(x, joint[0]).min(edge(y, joint[1]))
}

/// Red bricks in a running bond, eight courses to a repeat.
fn brick() -> Surface {
    surface(0.006, |u, v| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let course = (v * 8.0) as u32;
        let x = u * 4.0 + 0.5 * (course % 2) as f32;
        let stone = block(x, v * 8.0, [0.04, 0.08]);
        let shade = hash(x as u32 % 4, course, 1);
        let grain = fractal(u, v, 32, 3, 2);
        let clay = mix([0.36, 0.10, 0.06], [0.55, 0.24, 0.13], shade * 0.7 + grain * 0.3);
        Texel {
            colour: mix([0.42, 0.40, 0.36].map(|c| c * (0.7 + 0.3 * grain)), clay, stone),
            height: stone * 0.8 + grain * 0.2,
            roughness: 0.75 + 0.2 * grain,
        }
    })
}

/// Polished stone tiles, light and dark in turn.
fn tiles() -> Surface {
    surface(0.002, |u, v| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let tile = block(u * 4.0, v * 4.0, [0.02, 0.02]);
        let light = ((u * 4.0) as u32 + (v * 4.0) as u32).is_multiple_of(2);
        let vein = (fractal(u, v, 6, 5, 3) * 2.0 - 1.0).abs();
        let stone = if light {
            mix([0.58, 0.55, 0.50], [0.72, 0.70, 0.66], vein)
        } else {
            mix([0.055, 0.06, 0.065], [0.12, 0.13, 0.13], vein)
        };
        Texel {
            colour: mix([0.16, 0.15, 0.14], stone, tile),
            height: tile,
            roughness: 0.9 - 0.65 * tile + 0.1 * vein,
        }
    })
}

/// Planks with grain along `u`.
fn wood() -> Surface {
    surface(0.003, |u, v| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let plank = (v * 4.0) as u32;
        let seam = block(0.5, v * 4.0, [0.5, 0.04]);
        let warp = value(u, v, 4, 20 + plank) * 0.35;
        let ring = (v * 36.0 + warp * 22.0).fract();
        let fibre = value(u * 2.0, v, 128, 5);
        let board = mix([0.25, 0.12, 0.05], [0.50, 0.29, 0.13], 0.3 * hash(plank, 0, 4) + 0.7 * ring);
        Texel {
            colour: board.map(|c| c * (0.25 + 0.75 * seam) * (0.8 + 0.2 * fibre)),
            height: seam * 0.7 + 0.2 * ring + 0.1 * fibre,
            roughness: 0.55 + 0.25 * fibre,
        }
    })
}

/// Rough plaster, nothing but noise.
fn plaster() -> Surface {
    surface(0.006, |u, v| {
        let coarse = fractal(u, v, 4, 6, 7);
        let fine = fractal(u, v, 64, 2, 8);
        Texel {
            colour: mix([0.45, 0.40, 0.33], [0.74, 0.70, 0.62], coarse),
            height: 0.5 * coarse + 0.5 * fine,
            roughness: 0.85 + 0.1 * fine,
        }
    })
}

/// Brushed, dark metal.
fn metal() -> Surface {
    surface(0.0008, |u, v| {
        let brush = 0.5 * value(u, v, 256, 9) + 0.5 * value(u * 0.0, v, 256, 10);
        Texel {
            colour: mix([0.10, 0.11, 0.12], [0.20, 0.21, 0.22], brush),
            height: brush,
            roughness: 0.25 + 0.2 * brush,
        }
    })
}

/// Seamless clouds and grime in three channels of different fineness, sampled by sky and surfaces.
pub fn detail() -> Texture {
    Texture::from_fn(SIDE, Encoding::Linear, |u, v| {
        [fractal(u, v, 4, 6, 11), fractal(u, v, 8, 5, 12), fractal(u, v, 32, 3, 13), 1.0]
    })
}

/// What a surface without relief has: straight normals and even roughness.
fn smooth(roughness: f32) -> Texture {
    Texture::from_fn(4, Encoding::Linear, |_, _| [0.5, 0.5, 1.0, roughness])
}
