//! A picture with detail of all sizes and colours, which moves, and degradations of it.

use glam::{Vec2, Vec3};
use parafovea_core::color::Matrix;
use parafovea_core::geometry::{Fov, eccentricity};
use parafovea_core::image::Plane;
use parafovea_models::errors::{Clip, Eye, Frame, Picture, RING_EDGES_DEG};
use std::f32::consts::FRAC_PI_4;
use std::sync::LazyLock;

pub const SIDE: u32 = 256;
const FOV: Fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };

/// Linear light.
pub type Light = [f32; 3];

/// Pseudo-random number in 0..1 for a point of a lattice (Wang's integer hash).
pub fn random(x: i32, y: i32, seed: u32) -> f32 {
    let mut n = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77) ^ seed;
    n = (n ^ 61) ^ (n >> 16);
    n = n.wrapping_mul(9);
    n ^= n >> 4;
    n = n.wrapping_mul(0x27D4_EB2D);
    (n ^ (n >> 15)) as f32 / u32::MAX as f32
}

/// Smooth noise around 0 with a lattice of 1.
fn noise(at: Vec2, seed: u32) -> f32 {
    let (cell, t) = (at.floor(), at - at.floor());
    let t = t * t * (3.0 - 2.0 * t);
    let corner = |dx: i32, dy: i32| random(cell.x as i32 + dx, cell.y as i32 + dy, seed) - 0.5;
    let upper = corner(0, 0) + t.x * (corner(1, 0) - corner(0, 0));
    let lower = corner(0, 1) + t.x * (corner(1, 1) - corner(0, 1));
    upper + t.y * (lower - upper)
}

/// Colour of a texture at a point in pixels: contrast falls as 1 / frequency.
fn texture(at: Vec2) -> Light {
    [1, 2, 3].map(|channel| {
        let octaves = [32.0, 16.0, 8.0, 4.0].iter().zip(1..);
        // All channels have most of their detail in common.
        let sum: f32 = octaves
            .map(|(&size, octave)| {
                let common = noise(at / size, octave);
                let own = noise(at / size, octave + 100 * channel);
                size.powf(0.25) * (0.75 * common + 0.5 * own)
            })
            .sum();
        (0.35 + 0.12 * sum).clamp(0.02, 0.98)
    })
}

/// The texture as far as any clip shows it.
static TEXTURE: LazyLock<Plane<Light>> =
    LazyLock::new(|| Plane::from_fn(SIDE + FARTHEST, SIDE, |x, y| texture(Vec2::new(x as f32, y as f32))));

/// Largest displacement of the texture in clips, pixels.
const FARTHEST: u32 = 64;

/// One eye, `frames` frames at 90 Hz, of the texture moving left by `speed` pixels a frame.
pub fn clip(frames: usize, speed: usize) -> Clip {
    clip_of(frames, [true, false], |_, frame, x, y| TEXTURE.at(x as u32 + (speed * frame) as u32, y as u32))
}

/// A clip of `light(eye, frame, x, y)`.
pub fn clip_of(frames: usize, eyes: [bool; 2], light: impl Fn(usize, usize, f32, f32) -> Light) -> Clip {
    let eye = |eye: usize, frame: usize| {
        let picture = Picture::from_linear(SIDE, SIDE, |x, y| light(eye, frame, x as f32, y as f32));
        Eye { picture, fov: FOV, gaze: Vec3::NEG_Z, age: None }
    };
    let frame = |index: usize| Frame {
        time_s: index as f64 / 90.0,
        eyes: [0, 1].map(|side| eyes[side].then(|| eye(side, index))),
    };
    Clip { frames: (0..frames).map(frame).collect() }
}

/// The ring of a pixel, by the angle itself.
pub fn ring(x: u32, y: u32) -> usize {
    let plane = FOV.tangents().plane([SIDE; 2]);
    let direction = plane.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
    let degrees = eccentricity(Vec3::NEG_Z, direction).to_degrees();
    RING_EDGES_DEG.iter().take_while(|&&edge| degrees >= edge).count()
}

/// `clip` with the pixels of one ring from `degraded`, for both eyes.
pub fn in_ring(clip: &Clip, degraded: &Clip, chosen: usize) -> Clip {
    let rings: Vec<usize> = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| ring(x, y))).collect();
    let mut result = clip.clone();
    for (frame, from) in result.frames.iter_mut().zip(&degraded.frames) {
        for (eye, from) in frame.eyes.iter_mut().zip(&from.eyes) {
            let (Some(eye), Some(from)) = (eye, from) else { continue };
            let pixels = rings.iter().zip(eye.picture.codes()).zip(from.picture.codes());
            let pixels: Vec<[u8; 4]> = pixels
                .map(|((&ring, &kept), &degraded)| if ring == chosen { degraded } else { kept })
                .map(|[r, g, b]| [r, g, b, 255])
                .collect();
            eye.picture = Picture::from_srgb8(SIDE, SIDE, &pixels).unwrap();
        }
    }
    result
}

/// Each picture of a clip changed by `change(frame, picture)`.
pub fn each(clip: &Clip, change: impl Fn(usize, &Picture) -> Picture) -> Clip {
    let mut result = clip.clone();
    for (index, frame) in result.frames.iter_mut().enumerate() {
        for eye in frame.eyes.iter_mut().flatten() {
            eye.picture = change(index, &eye.picture);
        }
    }
    result
}

pub fn light(picture: &Picture, x: u32, y: u32) -> Light {
    picture.codes()[(y * SIDE + x) as usize]
        .map(|code| parafovea_core::color::srgb_to_linear(f32::from(code) / 255.0))
}

/// Mean of a square of `2 radius + 1` pixels.
pub fn blurred(clip: &Clip, radius: i32) -> Clip {
    each(clip, |_, picture| {
        let lights: Vec<Light> = (0..SIDE)
            .flat_map(|y| (0..SIDE).map(move |x| (x, y)))
            .map(|(x, y)| light(picture, x, y))
            .collect();
        let along = |from: &[Light], step: fn(i32, i32, i32) -> (i32, i32)| -> Vec<Light> {
            let at = |x: i32, y: i32| {
                let last = SIDE as i32 - 1;
                from[(y.clamp(0, last) * SIDE as i32 + x.clamp(0, last)) as usize]
            };
            let mean = |x: i32, y: i32| {
                let mut sum = [0.0; 3];
                for by in -radius..=radius {
                    let (x, y) = step(x, y, by);
                    sum.iter_mut().zip(at(x, y)).for_each(|(sum, light)| *sum += light);
                }
                sum.map(|sum| sum / (2 * radius + 1) as f32)
            };
            let side = SIDE as i32;
            (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect()
        };
        let across = along(&lights, |x, y, by| (x + by, y));
        let both = along(&across, |x, y, by| (x, y + by));
        Picture::from_linear(SIDE, SIDE, |x, y| both[(y * SIDE + x) as usize])
    })
}

/// Grey noise, new in each frame.
pub fn noisy(clip: &Clip, amplitude: f32) -> Clip {
    each(clip, |frame, picture| {
        Picture::from_linear(SIDE, SIDE, |x, y| {
            let grain = amplitude * (random(x as i32, y as i32, 7 + frame as u32) - 0.5);
            light(picture, x, y).map(|light| light + grain)
        })
    })
}

/// Colour taken away in linear light at constant luminance.
pub fn desaturated(clip: &Clip, share: f32) -> Clip {
    each(clip, |_, picture| {
        Picture::from_linear(SIDE, SIDE, |x, y| {
            let light = light(picture, x, y);
            let grey = Vec3::from(light).dot(Matrix::Bt709.weights());
            light.map(|light| light + share * (grey - light))
        })
    })
}

/// Only every n-th frame is new.
pub fn held(clip: &Clip, period: usize) -> Clip {
    taken(clip, |frame| frame / period * period)
}

/// Each frame is that of some frames before; the first stands until then.
pub fn delayed(clip: &Clip, frames: usize) -> Clip {
    taken(clip, |frame| frame.saturating_sub(frames))
}

fn taken(clip: &Clip, from: impl Fn(usize) -> usize) -> Clip {
    let mut result = clip.clone();
    for (index, frame) in result.frames.iter_mut().enumerate() {
        frame.eyes = clip.frames[from(index)].eyes.clone();
    }
    result
}
