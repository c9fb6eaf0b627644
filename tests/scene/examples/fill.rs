//! Loss of an image with blocks that are not shaded, by pattern and kind of fill: the table of `tests/baselines/fill.md`.
//!
//! `cargo run -p parafovea-scene --example fill`

use anyhow::Result;
use glam::{IVec2, Quat, UVec2, Vec3, Vec4, vec3};
use parafovea_core::kernels::fill::{FillFormat, blend};
use parafovea_core::mask::{BLOCK, Pattern};
use parafovea_core::rate::ShadingRate;
use parafovea_scene::camera::Camera;
use parafovea_scene::offscreen::Offscreen;
use parafovea_scene::scene::SceneName;
use std::f32::consts::FRAC_PI_4;

/// Side of a picture, pixels.
const SIDE: u32 = 512;
/// 90 degrees across.
const PIXELS_PER_DEGREE: f32 = SIDE as f32 / 2.0 * std::f32::consts::PI / 180.0;
/// Of each scene, so that things have moved.
const FRAME: u64 = 40;
/// Beyond this many blocks nothing is looked for.
const REACH: i32 = 7;

/// Choice of the shaded blocks.
#[derive(Clone, Copy)]
enum Choice {
    /// Every nth column and mth row.
    Square(u32, u32),
    /// As the layer does.
    Pattern(ShadingRate),
}

impl Choice {
    fn shades(self, block: UVec2) -> bool {
        let last = SIDE / BLOCK - 1;
        // All along the edges, so that each choice has something to fill from.
        let edge = block.x.is_multiple_of(last) || block.y.is_multiple_of(last);
        edge || match self {
            Self::Square(columns, rows) => block.x.is_multiple_of(columns) && block.y.is_multiple_of(rows),
            Self::Pattern(rate) => Pattern::of(rate).shades_inside(block),
        }
    }
}

/// Method of filling a skipped pixel from the nearest shaded block of each quarter.
#[derive(Clone, Copy)]
enum Filling {
    /// As the nearest of them.
    Nearest,
    /// As their mean by the inverse square of the distance.
    Distance,
    /// As the layer does: the same, along edges.
    Edges,
}

impl Filling {
    fn color(self, sources: [Option<(Vec4, f32)>; 4]) -> Vec4 {
        let there = || sources.iter().flatten();
        match self {
            Self::Nearest => {
                let nearest = there().min_by(|(_, a), (_, b)| a.total_cmp(b));
                nearest.map_or(Vec4::ZERO, |(color, _)| *color)
            }
            Self::Distance => {
                let weights: f32 = there().map(|(_, squared)| 1.0 / squared).sum();
                there().map(|(color, squared)| *color / *squared).sum::<Vec4>() / weights
            }
            Self::Edges => blend(sources),
        }
    }
}

fn filled(picture: &[u8], choice: Choice, filling: Filling) -> Vec<u8> {
    let format = FillFormat::Srgb8;
    let at = |pixel: UVec2| (pixel.y * SIDE + pixel.x) as usize * 4;
    let blocks = SIDE / BLOCK;
    let mut out = picture.to_vec();
    for block in (0..blocks).flat_map(|y| (0..blocks).map(move |x| UVec2::new(x, y))) {
        if choice.shades(block) {
            continue;
        }
        let nearest = [IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y].map(|along| {
            let across = along.perp();
            let offsets =
                (1..=REACH).flat_map(|ahead| (0..=REACH).map(move |side| along * ahead + across * side));
            let shaded = offsets.map(|offset| block.as_ivec2() + offset).filter(|at| {
                at.cmpge(IVec2::ZERO).all()
                    && at.cmplt(IVec2::splat(blocks as i32)).all()
                    && choice.shades(at.as_uvec2())
            });
            shaded.min_by_key(|at| at.distance_squared(block.as_ivec2()))
        });
        for pixel in (0..BLOCK * BLOCK).map(|i| block * BLOCK + UVec2::new(i % BLOCK, i / BLOCK)) {
            let sources = nearest.map(|source| {
                let first = source? * BLOCK as i32;
                let from = pixel.as_ivec2().clamp(first, first + 3);
                let color = format.decode(&picture[at(from.as_uvec2())..][..4]);
                Some((color, from.distance_squared(pixel.as_ivec2()) as f32))
            });
            format.encode(filling.color(sources), &mut out[at(pixel)..][..4]);
        }
    }
    out
}

fn rgb(texels: &[u8]) -> Vec<u8> {
    texels.chunks_exact(4).flat_map(|texel| [texel[0], texel[1], texel[2]]).collect()
}

/// PSNR of the stored codes in dB, and the mean of FLIP's error.
fn errors(reference: &[u8], test: &[u8]) -> [f32; 2] {
    let (a, b) = (rgb(reference), rgb(test));
    let squares: u64 = a.iter().zip(&b).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2)).sum();
    let psnr = -10.0 * (squares as f64 / (a.len() as f64 * 255.0 * 255.0)).log10();
    let image = |pixels: &[u8]| nv_flip::FlipImageRgb8::with_data(SIDE, SIDE, pixels);
    let flip = nv_flip::flip(image(&a), image(&b), PIXELS_PER_DEGREE).to_vec();
    [psnr as f32, flip.iter().sum::<f32>() / flip.len() as f32]
}

fn main() -> Result<()> {
    let scenes = [
        SceneName::Courtyard,
        SceneName::Cockpit,
        SceneName::Foliage,
        SceneName::Library,
        SceneName::Interior,
        SceneName::Street,
    ];
    let edge = FRAC_PI_4;
    let camera = Camera::new(vec3(0.0, 1.6, 0.0), Quat::IDENTITY, [-edge, edge, -edge, edge]);
    let mut pictures = Vec::new();
    for scene in scenes {
        let lights = scene.definition().default_lights;
        let mut offscreen = Offscreen::new([SIDE; 2], wgpu::TextureFormat::Rgba8UnormSrgb, scene, lights)?;
        offscreen.draw_gazing(FRAME, &[camera], Vec3::NEG_Z)?;
        pictures.push(offscreen.texels()?);
    }
    let names: Vec<_> = scenes.iter().map(|scene| scene.as_str()).collect();
    println!("| shaded | blocks | filled by | {} | mean dB | mean FLIP |", names.join(" | "));
    println!("|---:|---|---|{}---:|---:|", "---:|".repeat(scenes.len()));
    for (rate, share, others) in [
        (ShadingRate::R2X1, "1/2", &[("columns", 2, 1), ("rows", 1, 2)][..]),
        (ShadingRate::R2X2, "1/4", &[("square", 2, 2)]),
        (ShadingRate::R4X2, "1/8", &[("4 x 2", 4, 2), ("2 x 4", 2, 4)]),
        (ShadingRate::R4X4, "1/16", &[("square", 4, 4)]),
    ] {
        let layer = Choice::Pattern(rate);
        let mut rows = vec![
            ("pattern", "nearest", layer, Filling::Nearest),
            ("pattern", "distance", layer, Filling::Distance),
            ("**pattern**", "**edges**", layer, Filling::Edges),
        ];
        for (name, columns, lines) in others {
            rows.push((name, "edges", Choice::Square(*columns, *lines), Filling::Edges));
        }
        for (blocks, by, choice, filling) in rows {
            let found: Vec<_> =
                pictures.iter().map(|picture| errors(picture, &filled(picture, choice, filling))).collect();
            let mean =
                |which: usize| found.iter().map(|errors| errors[which]).sum::<f32>() / found.len() as f32;
            let each: Vec<_> = found.iter().map(|[psnr, _]| format!("{psnr:.1}")).collect();
            println!(
                "| {share} | {blocks} | {by} | {} | {:.2} | {:.3} |",
                each.join(" | "),
                mean(0),
                mean(1)
            );
        }
    }
    Ok(())
}
