//! Pictures to analyse, in linear light.

use glam::Vec3;
use parafovea_core::image::Plane;

/// A picture by name.
pub type Picture = (&'static str, fn(u32, u32) -> Vec3);

/// All of them; their size does not matter.
pub const ALL: [Picture; 15] = [
    ("natural", natural),
    ("text", text),
    ("noise", |x, y| noise(x, y)),
    ("dark", |x, y| noise(x, y) * 0.001),
    (
        "high dynamic range",
        |x, y| if noise(x, y).x > 0.99 { Vec3::splat(250.0) } else { natural(x, y) * 4.0 },
    ),
    ("flat", |_, _| Vec3::new(0.2, 0.4, 0.1)),
    ("black", |_, _| Vec3::ZERO),
    ("Nyquist, checkerboard", |x, y| Vec3::splat(0.2 + 0.5 * ((x + y) % 2) as f32)),
    ("Nyquist, columns", |x, _| Vec3::splat((x % 2) as f32)),
    ("gradient", |x, y| Vec3::splat((x + 2 * y) as f32 / 1000.0)),
    ("edge", |x, y| Vec3::splat(if 3 * x > 2 * y + 77 { 0.9 } else { 0.05 })),
    ("a thin line", |x, _| Vec3::splat(if x == 37 { 0.6 } else { 0.5 })),
    ("with NaN", |x, y| marked(x, y, f32::NAN)),
    ("with infinity", |x, y| marked(x, y, f32::INFINITY)),
    ("with negative infinity", |x, y| marked(x, y, f32::NEG_INFINITY)),
];

/// The picture of a size.
pub fn plane((_, color): Picture, [width, height]: [u32; 2]) -> Plane<Vec3> {
    Plane::from_fn(width, height, color)
}

/// 0..1, the same every time.
fn noise(x: u32, y: u32) -> Vec3 {
    let hash = |salt: u32| {
        let mixed =
            (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ salt).wrapping_mul(0xc2b2_ae35);
        (mixed ^ mixed >> 15).wrapping_mul(0x27d4_eb2f) as f32 / u32::MAX as f32
    };
    Vec3::new(hash(1), hash(2), hash(3))
}

/// As much contrast in each octave.
fn natural(x: u32, y: u32) -> Vec3 {
    let octave = |octave: u32| {
        let (frequency, phase) = (3.0 * 0.55f32.powi(octave as i32), octave as f32 * 1.7);
        let (sin, cos) = (octave as f32 * 2.4).sin_cos();
        ((x as f32 * cos + y as f32 * sin) * frequency + phase).sin()
    };
    let sum: f32 = (0..9).map(octave).sum();
    Vec3::new(0.30, 0.28, 0.22) * (1.0 + 0.1 * sum)
}

/// Strokes on paper, in lines of letters of 6 x 10 pixels.
fn text(x: u32, y: u32) -> Vec3 {
    let (letter, line) = (x / 6, y / 10);
    let shape = (letter * 31 + line * 17).wrapping_mul(0x9e37_79b1);
    let within = (x % 6, y % 10);
    let inked = within.0 < 5 && within.1 < 7 && (shape >> ((within.0 + within.1 * 3) % 31)) & 1 == 1;
    Vec3::splat(if inked { 0.03 } else { 0.85 })
}

/// The natural picture, with a value here and there in one component.
fn marked(x: u32, y: u32, value: f32) -> Vec3 {
    let mut color = natural(x, y);
    if (x * 7 + y * 13) % 211 == 5 {
        color[(x % 3) as usize] = value;
    }
    color
}
