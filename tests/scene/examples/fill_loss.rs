//! The visible loss of pictures with skipped blocks, by the blocks' size, share and filling: the second table of `tests/baselines/fill.md`.
//!
//! `cargo run -p parafovea-scene --example fill_loss [PNG ...]`: of six scenes, or of those pictures.

use anyhow::{Context, Result};
use glam::{IVec2, Quat, UVec2, Vec2, Vec3, Vec4, vec3};
use parafovea_core::fixed_foveation::FixedFoveation;
use parafovea_core::geometry::Fov;
use parafovea_core::kernels::fill::{FillFormat, blend};
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use parafovea_models::errors::{Eye, Picture, Viewing, seen_of_stills};
use parafovea_scene::camera::Camera;
use parafovea_scene::offscreen::Offscreen;
use parafovea_scene::scene::SceneName;
use std::f32::consts::FRAC_PI_4;
use std::fs::File;
use std::io::BufReader;

/// Side of a scene's picture, pixels.
const SIDE: u32 = 512;
/// 90 degrees across.
const FOV: Fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };
/// Of each scene, so that things have moved.
const FRAME: u64 = 40;
/// Side of a tile, pixels.
const TILE: u32 = 16;
/// Beyond this many blocks nothing is looked for.
const REACH: i32 = 8;
/// The preset `balanced` on a CPU device.
const RINGS: FixedFoveation = FixedFoveation::L1_C1;

/// Blocks of pixels, of which a share is shaded.
struct Mask {
    /// Width and height of a block, pixels.
    block: IVec2,
    shares: Shares,
}

/// The number of shaded blocks of a tile.
#[derive(Clone, Copy)]
enum Shares {
    /// The number given by the tile's rate, as in the layer.
    Planned,
    /// Twice as many as planned; as planned if that is all or half of them.
    StepFiner,
    /// At least one block in this number.
    AtLeast(u32),
}

impl Shares {
    /// Columns and rows from one shaded block to the next.
    fn steps(self, rate: ShadingRate) -> IVec2 {
        let planned = rate.width() * rate.height();
        let one_in = match self {
            Self::Planned => planned,
            Self::StepFiner if planned > 2 => planned / 2,
            Self::StepFiner => planned,
            Self::AtLeast(most) => planned.min(most),
        };
        match one_in {
            1 => IVec2::ONE,
            2 => IVec2::new(2, 1),
            4 => IVec2::splat(2),
            8 => IVec2::new(4, 2),
            _ => IVec2::splat(4),
        }
    }

    /// Its name in the table.
    fn name(self) -> String {
        match self {
            Self::Planned => "planned".to_owned(),
            Self::StepFiner => "a step finer".to_owned(),
            Self::AtLeast(most) => format!("1/{most} at least"),
        }
    }
}

/// The filling of skipped pixels.
#[derive(Clone, Copy)]
enum Filling {
    /// From the nearest pixel of the nearest block of each quarter, along edges, as the layer does.
    Pixels,
    /// The same, and from those blocks' means the more, the farther they are; all of it from so many pixels on.
    PixelsAndMeans(f32),
    /// From their means only.
    Means,
    /// From all pixels around by a Gaussian, which is so wide in units of the mean distance to those blocks.
    Gaussian(f32),
}

/// A picture in linear light.
struct Light {
    extent: UVec2,
    pixels: Vec<Vec4>,
}

impl Light {
    fn at(&self, pixel: IVec2) -> Vec4 {
        self.pixels[(pixel.y as u32 * self.extent.x + pixel.x as u32) as usize]
    }
}

/// Eccentricity of a position in the image, 0..=1 along each axis, in degrees; the gaze is at the centre.
fn eccentricity(place: Vec2) -> f32 {
    let plane = (place - 0.5) * 2.0 * FRAC_PI_4.tan();
    plane.length().atan().to_degrees()
}

/// The planned rate of a tile: that of its corner nearest to the gaze.
fn rate(tile: UVec2, extent: UVec2) -> ShadingRate {
    let corners = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE];
    let degrees = corners.map(|corner| eccentricity(((tile + corner) * TILE).as_vec2() / extent.as_vec2()));
    RINGS.shading_rate_of(degrees.into_iter().fold(f32::MAX, f32::min), &VULKAN_RATES)
}

impl Mask {
    /// Whether a block is shaded: rows of blocks, every other one shifted, as the layer has them, and along the picture's edges.
    fn shades(&self, block: IVec2, extent: UVec2) -> bool {
        let step = self.shares.steps(rate((block * self.block).as_uvec2() / TILE, extent));
        let last = extent.as_ivec2() / self.block - 1;
        let on_edge = block.cmpeq(IVec2::ZERO) | block.cmpeq(last);
        let shift = if block.y & step.y == 0 { 0 } else { step.x / 2 };
        let by_row = block.y % step.y == 0;
        let by_column = block.x % step.x == 0;
        match (on_edge.x, on_edge.y) {
            (true, true) => true,
            (true, false) => by_row,
            (false, true) => by_column,
            (false, false) => by_row && block.x % step.x == shift,
        }
    }

    /// The picture with its skipped blocks filled, and the share of shaded ones.
    fn show(&self, light: &Light, filling: Filling) -> (Vec<Vec4>, f32) {
        let count = light.extent.as_ivec2() / self.block;
        let all: Vec<IVec2> =
            (0..count.y).flat_map(|y| (0..count.x).map(move |x| IVec2::new(x, y))).collect();
        let shaded: Vec<bool> = all.iter().map(|block| self.shades(*block, light.extent)).collect();
        let is_shaded = |block: IVec2| {
            let inside = block.cmpge(IVec2::ZERO).all() && block.cmplt(count).all();
            inside && shaded[(block.y * count.x + block.x) as usize]
        };
        let mut shown = light.pixels.clone();
        for block in all.iter().copied().filter(|block| !is_shaded(*block)) {
            let sources = [IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y].map(|along| {
                let offsets = (1..=REACH)
                    .flat_map(|ahead| (0..=REACH).map(move |side| along * ahead + along.perp() * side));
                let shaded = offsets.filter(|offset| is_shaded(block + *offset));
                shaded
                    .min_by_key(|offset| (*offset * self.block).length_squared())
                    .map(|offset| block + offset)
            });
            for pixel in self.pixels(block) {
                shown[(pixel.y as u32 * light.extent.x + pixel.x as u32) as usize] =
                    self.color(light, (block, pixel), sources, filling, is_shaded);
            }
        }
        let share = shaded.iter().filter(|shaded| **shaded).count() as f32 / shaded.len() as f32;
        (shown, share)
    }

    fn pixels(&self, block: IVec2) -> impl Iterator<Item = IVec2> + use<> {
        let (first, size) = (block * self.block, self.block);
        (0..size.y).flat_map(move |y| (0..size.x).map(move |x| first + IVec2::new(x, y)))
    }

    fn mean(&self, light: &Light, block: IVec2) -> Vec4 {
        self.pixels(block).map(|pixel| light.at(pixel)).sum::<Vec4>() / self.block.element_product() as f32
    }

    fn color(
        &self,
        light: &Light,
        (block, pixel): (IVec2, IVec2),
        sources: [Option<IVec2>; 4],
        filling: Filling,
        is_shaded: impl Fn(IVec2) -> bool,
    ) -> Vec4 {
        let nearest = |source: IVec2| {
            let first = source * self.block;
            let nearest = pixel.clamp(first, first + self.block - 1);
            (light.at(nearest), nearest.distance_squared(pixel) as f32)
        };
        match filling {
            Filling::Pixels => blend(sources.map(|source| source.map(nearest))),
            Filling::PixelsAndMeans(pixels) => blend(sources.map(|source| {
                let (color, squared) = nearest(source?);
                let share = (squared / (pixels * pixels)).min(1.0);
                Some((color.lerp(self.mean(light, source?), share), squared))
            })),
            Filling::Means => blend(sources.map(|source| {
                let middle = (source? * self.block).as_vec2() + (self.block - 1).as_vec2() / 2.0;
                Some((self.mean(light, source?), middle.distance_squared(pixel.as_vec2())))
            })),
            Filling::Gaussian(width) => {
                let distances =
                    sources.iter().flatten().map(|source| ((*source - block) * self.block).as_vec2());
                let lengths: Vec<f32> = distances.map(Vec2::length).collect();
                let sigma = width * lengths.iter().sum::<f32>() / lengths.len() as f32;
                let around =
                    (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| block + IVec2::new(x, y)));
                let from = around.filter(|block| is_shaded(*block)).flat_map(|block| self.pixels(block));
                let (sum, weights) = from.fold((Vec4::ZERO, 0.0), |(sum, weights), from| {
                    let weight = (-(from.distance_squared(pixel) as f32) / (2.0 * sigma * sigma)).exp();
                    (sum + light.at(from) * weight, weights + weight)
                });
                sum / weights
            }
        }
    }
}

/// Mean loss in just noticeable differences from 20 to 30 degrees, beyond, and of the whole view.
fn loss(reference: &Picture, shown: &Picture) -> Result<[f32; 3]> {
    let eye = Eye { picture: reference.clone(), fov: FOV, gaze: Vec3::NEG_Z, age: None };
    let seen = seen_of_stills(&eye, shown, &Viewing::default())?;
    let extent = UVec2::from(reference.extent());
    let mut sums = [(0.0, 0); 3];
    for (index, value) in (0..).zip(seen.texels()) {
        let pixel = UVec2::new(index % extent.x, index / extent.x);
        let degrees = eccentricity((pixel.as_vec2() + 0.5) / extent.as_vec2());
        let rings = [(20.0..30.0).contains(&degrees), degrees >= 30.0, true];
        for (sum, _) in sums.iter_mut().zip(rings).filter(|(_, inside)| *inside) {
            *sum = (sum.0 + value, sum.1 + 1);
        }
    }
    Ok(sums.map(|(sum, count)| sum / count.max(1) as f32))
}

fn scenes() -> Result<Vec<(UVec2, Vec<u8>)>> {
    let scenes = [
        SceneName::Courtyard,
        SceneName::Cockpit,
        SceneName::Foliage,
        SceneName::Library,
        SceneName::Interior,
        SceneName::Street,
    ];
    let Fov { left, right, up, down } = FOV;
    let camera = Camera::new(vec3(0.0, 1.6, 0.0), Quat::IDENTITY, [left, right, down, up]);
    let draw = |scene: SceneName| {
        let lights = scene.definition().default_lights;
        let mut offscreen = Offscreen::new([SIDE; 2], wgpu::TextureFormat::Rgba8UnormSrgb, scene, lights)?;
        offscreen.draw_gazing(FRAME, &[camera], Vec3::NEG_Z)?;
        Ok((UVec2::splat(SIDE), offscreen.texels()?))
    };
    scenes.into_iter().map(draw).collect()
}

fn load(path: &str) -> Result<(UVec2, Vec<u8>)> {
    let mut reader =
        png::Decoder::new(BufReader::new(File::open(path).context(path.to_owned())?)).read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().context("its size")?];
    let info = reader.next_frame(&mut pixels)?;
    anyhow::ensure!(info.color_type == png::ColorType::Rgba, "{path} has no alpha");
    Ok((UVec2::new(info.width, info.height), pixels))
}

fn main() -> Result<()> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let pictures = if paths.is_empty() {
        scenes()?
    } else {
        paths.iter().map(|path| load(path)).collect::<Result<_>>()?
    };
    let shares = [Shares::Planned, Shares::AtLeast(8), Shares::AtLeast(4), Shares::StepFiner];
    let fillings =
        [Filling::Means, Filling::PixelsAndMeans(4.0), Filling::PixelsAndMeans(8.0), Filling::Gaussian(0.4)];
    let by_share = shares.map(|shares| ([4, 4], shares, Filling::Pixels));
    let by_filling = fillings.map(|filling| ([4, 4], Shares::Planned, filling));
    let by_size = [[8, 4], [4, 2], [2, 2]].map(|block| (block, Shares::Planned, Filling::Pixels));
    let finer = [[4, 2], [2, 2]].map(|block| (block, Shares::StepFiner, Filling::Pixels));
    let masks = by_share.into_iter().chain(by_filling).chain(by_size).chain(finer);
    println!("| blocks | share | filled from | shaded | JND 20-30 | >30 | view |");
    println!("|---|---|---|---:|---:|---:|---:|");
    let print = |name: String, found: Vec<([f32; 3], f32)>| {
        let mean =
            |value: fn(&([f32; 3], f32)) -> f32| found.iter().map(value).sum::<f32>() / found.len() as f32;
        let [ring, beyond, view] =
            [mean(|found| found.0[0]), mean(|found| found.0[1]), mean(|found| found.0[2])];
        println!("| {name} | {:.3} | {ring:.2} | {beyond:.2} | {view:.2} |", mean(|found| found.1));
    };
    let stored = |(extent, bytes): &(UVec2, Vec<u8>)| {
        let (texels, _) = bytes.as_chunks();
        Picture::from_srgb8(extent.x, extent.y, texels).context("as many pixels as its size says")
    };
    let rates = pictures.iter().map(|picture| {
        let reference = stored(picture)?;
        let at = |x: u32, y: u32| rate(UVec2::new(x, y) / TILE, picture.0);
        let tiles = picture.0.map(|side| side.div_ceil(TILE));
        let shares = (0..tiles.element_product())
            .map(|tile| rate(UVec2::new(tile % tiles.x, tile / tiles.x), picture.0).fraction());
        let share = shares.sum::<f32>() / tiles.element_product() as f32;
        Ok((loss(&reference, &reference.shaded_at(at))?, share))
    });
    print("rates | planned | –".to_owned(), rates.collect::<Result<_>>()?);
    for (block, shares, filling) in masks {
        let mask = Mask { block: block.into(), shares };
        let found = pictures.iter().map(|picture| {
            let decoded = picture.1.chunks_exact(4).map(|texel| FillFormat::Srgb8.decode(texel));
            let light = Light { extent: picture.0, pixels: decoded.collect() };
            let (shown, share) = mask.show(&light, filling);
            let mut bytes = picture.1.clone();
            bytes
                .chunks_exact_mut(4)
                .zip(shown)
                .for_each(|(texel, color)| FillFormat::Srgb8.encode(color, texel));
            Ok((loss(&stored(picture)?, &stored(&(picture.0, bytes))?)?, share))
        });
        let from = match filling {
            Filling::Pixels => "pixels".to_owned(),
            Filling::PixelsAndMeans(pixels) => format!("pixels, means from {pixels} pixels on"),
            Filling::Means => "means of blocks".to_owned(),
            Filling::Gaussian(width) => format!("Gaussian of {width} distances"),
        };
        let name = format!("{}x{} | {} | {from}", block[0], block[1], shares.name());
        print(name, found.collect::<Result<_>>()?);
    }
    Ok(())
}
