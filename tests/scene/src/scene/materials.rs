//! The surfaces: brick, stone tiles, wood, plaster, metal and more. A height field and a colour make a material.

mod leaves;
mod pictures;

use super::noise::{fractal, hash, value};
use super::text;
use super::texture::{Encoding, Texture};

/// Material of a surface. In all but [`Material::is_leafy`] ones, alpha of the albedo is 1 for dielectrics such as glass or paint, and 0
/// for bare metal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Material {
    /// Stone tiles, light and dark in turn.
    Tiles,
    /// Red brick.
    Brick,
    /// Rough plaster.
    Plaster,
    /// Planks.
    Wood,
    /// Brushed dark metal, painted.
    Metal,
    /// The notice board.
    Board,
    /// Lamps: plain white, coloured by their emission.
    Lamp,
    /// Smooth white paint, to be tinted.
    Paint,
    /// White cloth, to be tinted.
    Cloth,
    /// Grained plastic, to be tinted.
    Plastic,
    /// Bare polished steel.
    Chrome,
    /// Bare brass.
    Brass,
    /// Polished marble slabs.
    Marble,
    /// Small glazed wall tiles with joints.
    GlazedTiles,
    /// Road.
    Asphalt,
    /// Earth with grass and moss.
    Soil,
    /// Bark.
    Bark,
    /// Twigs with leaves, cut out by alpha.
    Leaves,
    /// Tufts of grass, cut out by alpha.
    Grass,
    /// Lit windows with curtains and people: 4 x 4 cells.
    Windows,
    /// Shop signs: 1 x 8 cells.
    Signs,
    /// Round instruments with scales: 4 x 4 cells.
    Gauges,
    /// Screens with text: 2 x 2 cells.
    Screens,
    /// Labels and small print: 1 x 8 cells of labels on the left, a page on the right.
    Placards,
    /// Spines of books: 32 x 4 cells.
    Spines,
    /// Two pages of an open book.
    Pages,
}

impl Material {
    /// Whether alpha cuts its shape out.
    pub fn is_leafy(self) -> bool {
        matches!(self, Self::Leaves | Self::Grass)
    }
}

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
        Material::Paint => grained([0.85; 3], 0.0002, 64, 0.22, 1.0),
        Material::Cloth => cloth(),
        Material::Plastic => grained([0.8; 3], 0.0006, 128, 0.5, 1.0),
        Material::Chrome => grained([0.86, 0.88, 0.9], 0.0, 8, 0.08, 0.0),
        Material::Brass => grained([0.86, 0.62, 0.26], 0.0003, 64, 0.18, 0.0),
        Material::Marble => marble(),
        Material::GlazedTiles => glazed_tiles(),
        Material::Asphalt => grained([0.09, 0.09, 0.095], 0.006, 128, 0.75, 1.0),
        Material::Soil => soil(),
        Material::Bark => bark(),
        Material::Leaves => Surface { albedo: leaves::twigs(), relief: smooth(0.45) },
        Material::Grass => Surface { albedo: leaves::grass(), relief: smooth(0.5) },
        Material::Windows => Surface { albedo: pictures::windows(), relief: smooth(0.3) },
        Material::Signs => Surface { albedo: pictures::signs(), relief: smooth(0.4) },
        Material::Gauges => Surface { albedo: pictures::gauges(), relief: smooth(0.35) },
        Material::Screens => Surface { albedo: pictures::screens(), relief: smooth(0.2) },
        Material::Placards => Surface { albedo: pictures::placards(), relief: smooth(0.5) },
        Material::Spines => Surface { albedo: pictures::spines(), relief: smooth(0.55) },
        Material::Pages => Surface { albedo: pictures::pages(), relief: smooth(0.8) },
    }
}

struct Texel {
    colour: [f32; 3],
    height: f32,
    roughness: f32,
}

/// A repeating surface of something that is not a metal; `depth` is how high the height field is, in repeats.
fn surface(depth: f32, texel: impl Fn(f32, f32) -> Texel) -> Surface {
    surface_of_alpha(depth, 1.0, texel)
}

fn surface_of_alpha(depth: f32, alpha: f32, texel: impl Fn(f32, f32) -> Texel) -> Surface {
    let centre = |index: u32| (index as f32 + 0.5) / SIDE as f32;
    let texels: Vec<_> =
        (0..SIDE * SIDE).map(|index| texel(centre(index % SIDE), centre(index / SIDE))).collect();
    let at = |x: u32, y: u32| &texels[(y % SIDE * SIDE + x % SIDE) as usize];
    let place = |u: f32, v: f32| ((u * SIDE as f32) as u32, (v * SIDE as f32) as u32);
    let albedo = Texture::from_fn(SIDE, Encoding::Srgb, |u, v| {
        let (x, y) = place(u, v);
        let [r, g, b] = at(x, y).colour;
        [r, g, b, alpha]
    });
    let relief = Texture::from_fn(SIDE, Encoding::Linear, |u, v| {
        let (x, y) = place(u, v);
        let here = at(x, y);
        let du = (at(x + 1, y).height - here.height) * depth * SIDE as f32;
        let dv = (at(x, y + 1).height - here.height) * depth * SIDE as f32;
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

/// An even colour with a fine grain.
fn grained(colour: [f32; 3], depth: f32, cells: u32, roughness: f32, alpha: f32) -> Surface {
    surface_of_alpha(depth, alpha, |u, v| {
        let grain = fractal(u, v, cells, 2, 21);
        Texel {
            colour: colour.map(|c| c * (0.9 + 0.1 * grain)),
            height: grain,
            roughness: roughness * (0.85 + 0.15 * fractal(u, v, 4, 3, 22)),
        }
    })
}

/// A plain weave.
fn cloth() -> Surface {
    surface(0.004, |u, v| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let (warp, weft) = ((u * 64.0).fract(), (v * 64.0).fract());
        let over = ((u * 64.0) as u32 + (v * 64.0) as u32).is_multiple_of(2);
        let thread = if over { warp * (1.0 - warp) } else { weft * (1.0 - weft) } * 4.0;
        let fold = fractal(u, v, 4, 3, 23);
        Texel {
            colour: [0.85; 3].map(|c| c * (0.55 + 0.3 * thread + 0.15 * fold)),
            height: 0.4 * thread + fold,
            roughness: 0.9,
        }
    })
}

/// White slabs with grey veins and thin joints, polished.
fn marble() -> Surface {
    surface(0.0008, |u, v| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let slab = block(u * 2.0, v * 2.0, [0.006, 0.006]);
        let vein = 1.0 - (fractal(u, v, 3, 6, 24) * 2.0 - 1.0).abs();
        let vein = vein * vein * vein * vein * vein * vein;
        let stone = mix([0.62, 0.60, 0.57], [0.20, 0.19, 0.20], vein);
        Texel { colour: mix([0.1; 3], stone, slab), height: slab, roughness: 0.6 - 0.5 * slab }
    })
}

/// White glazed tiles, each tilted a little, with dark joints.
fn glazed_tiles() -> Surface {
    surface(0.0012, |u, v| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let tile = block(u * 8.0, v * 8.0, [0.03, 0.03]);
        let (i, j) = ((u * 8.0) as u32, (v * 8.0) as u32);
        let tilt = (hash(i, j, 25) - 0.5) * (u * 8.0).fract() + (hash(i, j, 26) - 0.5) * (v * 8.0).fract();
        let shade = 0.6 + 0.15 * hash(i, j, 27);
        Texel {
            colour: mix([0.12, 0.12, 0.11], [shade * 0.86, shade * 0.97, shade], tile),
            height: tile + 0.5 * tilt,
            roughness: 0.85 - 0.72 * tile,
        }
    })
}

/// Earth, moss and short grass.
fn soil() -> Surface {
    surface(0.012, |u, v| {
        let (coarse, fine) = (fractal(u, v, 5, 5, 28), fractal(u, v, 96, 2, 29));
        let moss = ((coarse - 0.45) * 6.0).clamp(0.0, 1.0);
        Texel {
            colour: mix([0.16, 0.11, 0.06], [0.10, 0.19, 0.04], moss).map(|c| c * (0.4 + 1.0 * fine)),
            height: 0.4 * coarse + 0.6 * fine,
            roughness: 0.95,
        }
    })
}

/// Furrows that run up and down.
fn bark() -> Surface {
    surface(0.02, |u, v| {
        let warp = fractal(u, v, 6, 3, 30);
        let furrow = value(u + 0.06 * warp, v * 0.25, 24, 31);
        let fine = fractal(u, v, 64, 2, 32);
        Texel {
            colour: mix([0.05, 0.035, 0.025], [0.26, 0.20, 0.14], furrow).map(|c| c * (0.7 + 0.5 * fine)),
            height: 0.8 * furrow + 0.2 * fine,
            roughness: 0.92,
        }
    })
}

/// Seamless clouds and grime in three channels of different fineness, sampled by sky and surfaces.
pub fn detail() -> Texture {
    Texture::from_fn(SIDE, Encoding::Linear, |u, v| {
        [fractal(u, v, 4, 6, 11), fractal(u, v, 8, 5, 12), fractal(u, v, 32, 3, 13), 1.0]
    })
}

/// Maps of a surface without relief: straight normals and even roughness.
fn smooth(roughness: f32) -> Texture {
    Texture::from_fn(4, Encoding::Linear, |_, _| [0.5, 0.5, 1.0, roughness])
}
