//! The pass `analyze` on a Vulkan device, under the validation layers where they are installed, compared stage by stage
//! with its CPU reference. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

mod formats;
mod pictures;
#[path = "../compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use formats::stored;
use glam::Vec3;
use half::f16;
use parafovea::gpu::AppCommands;
use parafovea::kernels::analyze::{
    Analyze, AnalyzeParams, AnalyzedPicture, Levels, USAGE, ViewTiles, rate_row_bytes,
};
use parafovea_core::color::Matrix;
use parafovea_core::image::Plane;
use parafovea_core::kernels::analyze::{
    Aggregation, Buffers, ContrastSettings, DARKEST_CD_M2, SETTLED, half, half_plane, level_place,
    level_size, levels_extent, restore, tiles,
};
use parafovea_core::perception::luminance::luminance_plane;
use parafovea_core::perception::pyramid::{LEVELS, Pyramid};
use parafovea_core::perception::{ContrastMap, TileContrast};
use parafovea_core::rate::VULKAN_RATES;
use parafovea_core::reuse::STALE;
use std::sync::Arc;
use transfer::Layer;
use vulkan::Vulkan;

const FLOATS: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

const WHITE_CD_M2: f32 = 100.0;

/// Greatest relative difference between results that are computed alike from the same numbers.
const SAME: f32 = 1e-4;

/// A view in an image, and the tiles of that image.
#[derive(Clone, Copy)]
struct Shape {
    image: [u32; 2],
    offset: [u32; 2],
    extent: [u32; 2],
    texel: [u32; 2],
    aggregation: Aggregation,
}

impl Shape {
    fn settings(&self) -> ContrastSettings {
        let Self { texel, offset, aggregation, .. } = *self;
        ContrastSettings { texel, overhang: offset, aggregation, ..ContrastSettings::default() }
    }
}

/// A whole image, by tiles of 16 x 16.
fn whole(extent: [u32; 2]) -> Shape {
    Shape { image: extent, offset: [0; 2], extent, texel: [16; 2], aggregation: Aggregation::Peak }
}

/// A picture as it is stored, and its colours.
type Stored = (Vec<u8>, Plane<Vec3>);

/// The results for pictures at rates, one after the other.
struct Analyzed {
    levels: Vec<Vec<Plane>>,
    maps: Vec<Vec<TileContrast>>,
}

impl Analyzed {
    fn on_gpu(
        (vulkan, analyze): (&Vulkan, &Analyze),
        shape: &Shape,
        format: vk::Format,
        passes: &[(&[u8], &Plane<u8>)],
    ) -> Self {
        let [width, height] = shape.image;
        let extent = vk::Extent2D { width, height };
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST | USAGE;
        // In the second layer, so that the first one shows where it is taken instead.
        let image = vulkan.image(vk::ImageCreateFlags::empty(), format, extent, 2, usage);
        let settings = shape.settings();
        let params = AnalyzeParams::new(shape.offset, shape.extent, &settings, WHITE_CD_M2, Matrix::Bt709);
        let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, settings.tiles(shape.extent)).unwrap());
        let levels = Arc::new(Levels::new(&vulkan.gpu, shape.extent).unwrap());
        let target = analyze.target((image, format, 1), &params, (&tiles, &levels)).unwrap();
        let (mut all_levels, mut maps) = (Vec::new(), Vec::new());
        for (picture, rates) in passes {
            vulkan.upload(Layer { image, layer: 1, extent }, picture);
            let bytes = packed(rates);
            vulkan.copy(vulkan.staging(&bytes), tiles.rates(), bytes.len());
            vulkan.run(|commands| {
                // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
                let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
                analyze.record(&commands, &[AnalyzedPicture { target: &target, layout, comparison: 0 }]);
            });
            let count = rates.texels().len();
            let bytes = vulkan.read(tiles.contrast(), count * size_of::<TileContrast>());
            maps.push(numbers(&bytes));
            all_levels.push(levels_of(vulkan, &levels));
        }
        Self { levels: all_levels, maps }
    }

    /// Computes each stage from the GPU's output of the stage before: `levels`, of each pass.
    fn on_cpu(shape: &Shape, passes: &[(&Plane<Vec3>, &Plane<u8>)], levels: &[Vec<Plane>]) -> Self {
        let (mut all_levels, mut maps) = (Vec::new(), Vec::new());
        let (mut previous, mut shown) = (ContrastMap::default(), Plane::default());
        for ((colors, rates), levels) in passes.iter().zip(levels) {
            let part = Plane::from_fn(shape.extent[0], shape.extent[1], |x, y| {
                colors.at(shape.offset[0] + x, shape.offset[1] + y)
            });
            let (mut luminance, mut kept) = (Plane::default(), Plane::default());
            luminance_plane(&part, WHITE_CD_M2, Matrix::Bt709, &mut luminance);
            half_plane(&luminance, &mut kept);
            let reduced = levels[..LEVELS].iter().map(|finer| {
                let mut pyramid = Pyramid::default();
                pyramid.build_rounded(finer, half);
                pyramid.level(1).clone()
            });
            all_levels.push(std::iter::once(kept).chain(reduced).collect());
            let coarser = std::array::from_fn(|index| levels[index + 1].clone());
            let mut buffers = Buffers::default();
            buffers.pyramid = Pyramid::of_levels(coarser);
            let mut map = ContrastMap::default();
            tiles(&levels[0], &shape.settings(), &mut buffers, &mut map);
            restore(rates, &previous, &mut shown, &mut map);
            maps.push(map.tiles.texels().to_vec());
            previous = map;
        }
        Self { levels: all_levels, maps }
    }
}

/// The levels of the pyramid as the device left them.
fn levels_of(vulkan: &Vulkan, levels: &Levels) -> Vec<Plane> {
    let extent = levels.extent();
    let [width, height] = levels_extent(extent);
    let whole = Layer { image: levels.image(), layer: 0, extent: vk::Extent2D { width, height } };
    let bytes = vulkan.download_in(vk::ImageLayout::GENERAL, whole, size_of::<[u16; 4]>());
    let blocks: Vec<[u16; 4]> = numbers(&bytes);
    (0..=LEVELS)
        .map(|level| {
            let ([left, top], [columns, rows]) = (level_place(extent, level), level_size(extent, level));
            Plane::from_fn(columns, rows, |x, y| {
                let block = (top + y / 2) * width + left + x / 2;
                f16::from_bits(blocks[block as usize][(2 * (y % 2) + x % 2) as usize]).to_f32()
            })
        })
        .collect()
}

/// The numbers in a buffer, one after the other.
fn numbers<T: bytemuck::Pod>(bytes: &[u8]) -> Vec<T> {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}

fn packed(rates: &Plane<u8>) -> Vec<u8> {
    let row_bytes = rate_row_bytes(rates.width()) as usize;
    let mut bytes = vec![0; row_bytes * rates.height() as usize];
    for (row, bytes) in (0..).zip(bytes.chunks_mut(row_bytes)) {
        bytes[..rates.width() as usize].copy_from_slice(rates.row(row));
    }
    bytes
}

/// Compares every stage. `relative`: tolerance of the device's luminance for the format, besides half floats.
fn assert_matches(case: &str, gpu: &Analyzed, cpu: &Analyzed, relative: f32) {
    for (gpu, cpu) in gpu.levels.iter().zip(&cpu.levels) {
        for (level, (gpu, cpu)) in gpu.iter().zip(cpu).enumerate() {
            assert_eq!((gpu.width(), gpu.height()), (cpu.width(), cpu.height()));
            let mut others = 0;
            for (index, (gpu, cpu)) in gpu.texels().iter().zip(cpu.texels()).enumerate() {
                // A value between two half floats may be rounded to either: they are 1 / 1024 apart at most.
                let close = (gpu - cpu).abs() <= (1.0 / 1024.0 + relative) * cpu;
                assert!(close, "{case}, level {level}, texel {index}: {gpu} {cpu}");
                others += u32::from(gpu != cpu);
            }
            let is_same = level > 0 || relative <= SAME;
            // Of few texels one more.
            let most = gpu.texels().len() / 200 + 1;
            assert!(!is_same || others as usize <= most, "{case}, level {level}: {others} differ");
        }
    }
    for (pass, (gpu, cpu)) in gpu.maps.iter().zip(&cpu.maps).enumerate() {
        assert_eq!(gpu.len(), cpu.len());
        for (tile, (gpu, cpu)) in gpu.iter().zip(cpu).enumerate() {
            let light = (gpu.adaptation_cd_m2 - cpu.adaptation_cd_m2).abs();
            assert!(light <= SAME * cpu.adaptation_cd_m2 + 1e-6, "{case}, tile {tile}: {gpu:?} {cpu:?}");
            for (band, (gpu, cpu)) in gpu.bands.iter().zip(cpu.bands).enumerate() {
                // The rounding error of a difference of equal numbers is not contrast.
                let close = (gpu - cpu).abs() <= SAME * cpu + SAME * 1e-2;
                assert!(close, "{case}, rates {pass}, tile {tile}, band {band}: {gpu} {cpu}");
            }
        }
    }
}

/// Everything at 1x1, then all rates beside each other, then again.
fn compare(
    (vulkan, analyze): (&Vulkan, &Analyze),
    case: &str,
    shape: &Shape,
    format: vk::Format,
    (bytes, colors): Stored,
    relative: f32,
) {
    let [columns, rows] = shape.settings().tiles(shape.extent);
    let fine = Plane::filled(columns, rows, 0);
    let coarse = Plane::from_fn(columns, rows, |x, y| VULKAN_RATES[((x + 3 * y) % 7) as usize].texel());
    let rates = [&coarse, &fine, &coarse];
    let gpu = Analyzed::on_gpu((vulkan, analyze), shape, format, &rates.map(|rates| (&bytes[..], rates)));
    let cpu = Analyzed::on_cpu(shape, &rates.map(|rates| (&colors, rates)), &gpu.levels);
    assert_matches(case, &gpu, &cpu, relative);
}

/// The pass on a device.
fn analyze() -> (Vulkan, Analyze) {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let analyze = Analyze::new(&vulkan.gpu).unwrap();
    (vulkan, analyze)
}

/// The pass as a GPU has it, and as a software device has it.
fn both() -> (Vulkan, [Analyze; 2]) {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let both = [true, false].map(|at_once| Analyze::reducing(&vulkan.gpu, at_once).unwrap());
    (vulkan, both)
}

#[test]
fn pictures_match_the_reference() {
    let (vulkan, both) = both();
    for picture in pictures::ALL {
        for (format, analyze) in [FLOATS, vk::Format::R16G16B16A16_SFLOAT]
            .into_iter()
            .flat_map(|format| both.iter().map(move |analyze| (format, analyze)))
        {
            let shape = whole([160, 112]);
            compare(
                (&vulkan, analyze),
                picture.0,
                &shape,
                format,
                stored(format, &pictures::plane(picture, shape.image), &[]),
                SAME,
            );
        }
    }
    vulkan.assert_valid();
}

/// A picture that fades, and another one, at rates that stay.
#[test]
fn pictures_that_change_match_the_reference() {
    let (vulkan, analyze) = analyze();
    let shape = whole([160, 112]);
    let [columns, rows] = shape.settings().tiles(shape.extent);
    let rates = Plane::from_fn(columns, rows, |x, y| VULKAN_RATES[((x + 3 * y) % 7) as usize].texel());
    let natural = pictures::plane(pictures::ALL[0], shape.image);
    let faded = |contrast: f32| {
        let texel = |x, y| Vec3::splat(0.2) + (natural.at(x, y) - Vec3::splat(0.2)) * contrast;
        Plane::from_fn(shape.image[0], shape.image[1], texel)
    };
    let stored: Vec<Stored> = [1.0, 0.95, 0.65, 0.65, 0.9, 0.2]
        .map(faded)
        .iter()
        .chain([&pictures::plane(pictures::ALL[2], shape.image)])
        .map(|plane| stored(FLOATS, plane, &[]))
        .collect();
    let on_gpu: Vec<_> = stored.iter().map(|(bytes, _)| (&bytes[..], &rates)).collect();
    let on_cpu: Vec<_> = stored.iter().map(|(_, colors)| (colors, &rates)).collect();
    let gpu = Analyzed::on_gpu((&vulkan, &analyze), &shape, FLOATS, &on_gpu);
    let cpu = Analyzed::on_cpu(&shape, &on_cpu, &gpu.levels);
    let before_last = &cpu.maps[4..6];
    assert!(before_last[0] != before_last[1], "nothing fades");
    assert_matches("fading", &gpu, &cpu, SAME);
    vulkan.assert_valid();
}

/// While the view stays, pictures and rates are compared with the ones before: all is as if each had been analysed, and once nothing changes any
/// more, nothing is written.
/// Both eyes beside each other in one image, and one of them in a layer of its own.
#[test]
fn pictures_side_by_side_are_as_one_after_the_other() {
    let (vulkan, all) = both();
    const EYE: [u32; 2] = [100, 84];
    let extent = vk::Extent2D { width: 2 * EYE[0], height: EYE[1] };
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST | USAGE;
    let image = vulkan.image(vk::ImageCreateFlags::empty(), FLOATS, extent, 2, usage);
    for layer in 0..2 {
        let texel =
            |at: u32| [(at * 7 + layer * 3) % 11, (at * 5) % 13, at % 3, 9].map(|part| part as f32 / 13.0);
        let picture: Vec<f32> = (0..extent.width * extent.height).flat_map(texel).collect();
        vulkan.upload(Layer { image, layer, extent }, bytemuck::cast_slice(&picture));
    }
    let settings = ContrastSettings::default();
    let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    for analyze in &all {
        let analyzed = |is_apart: bool| {
            let targets = [(0, 0), (EYE[0], 0), (0, 1)].map(|(left, layer)| {
                let params = AnalyzeParams::new([left, 0], EYE, &settings, WHITE_CD_M2, Matrix::Bt709);
                let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, settings.tiles(EYE)).unwrap());
                let levels = Arc::new(Levels::new(&vulkan.gpu, EYE).unwrap());
                let target = analyze.target((image, FLOATS, layer), &params, (&tiles, &levels)).unwrap();
                (target, tiles)
            });
            for comparisons in [[0, 0, 0], [0, 0, 1]] {
                let pictures: Vec<_> = targets
                    .iter()
                    .zip(comparisons)
                    .map(|((target, _), comparison)| AnalyzedPicture { target, layout, comparison })
                    .collect();
                for pictures in pictures.chunks(if is_apart { 1 } else { 3 }) {
                    vulkan.run(|commands| {
                        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                        let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
                        analyze.record(&commands, pictures);
                    });
                }
            }
            let [columns, rows] = settings.tiles(EYE);
            let bytes = (columns * rows) as usize * size_of::<TileContrast>();
            targets.map(|(_, tiles)| vulkan.read(tiles.contrast(), bytes))
        };
        let [together, apart] = [false, true].map(analyzed);
        assert_eq!(together, apart);
        assert!(together[0] != together[1] && together[0] != together[2], "they are different pictures");
    }
    vulkan.assert_valid();
}

#[test]
fn a_picture_that_stays_is_analysed_until_nothing_changes() {
    let (vulkan, analyze) = analyze();
    let shape = whole([160, 112]);
    let [width, height] = shape.image;
    let extent = vk::Extent2D { width, height };
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST | USAGE;
    let image = vulkan.image(vk::ImageCreateFlags::empty(), FLOATS, extent, 1, usage);
    let settings = shape.settings();
    let [columns, rows] = settings.tiles(shape.extent);
    let rates = Plane::from_fn(columns, rows, |x, y| VULKAN_RATES[((x + 3 * y) % 7) as usize].texel());
    let params = AnalyzeParams::new([0; 2], shape.extent, &settings, WHITE_CD_M2, Matrix::Bt709);
    let tiles = Arc::new(ViewTiles::new(&vulkan.gpu, [columns, rows]).unwrap());
    let levels = Arc::new(Levels::new(&vulkan.gpu, shape.extent).unwrap());
    let target = analyze.target((image, FLOATS, 0), &params, (&tiles, &levels)).unwrap();
    // One tile at a different rate; then another one that is not shaded, regardless of its rate.
    let with = |rates: &Plane<u8>, tile: u32, rate: u8| {
        Plane::from_fn(columns, rows, |x, y| if y * columns + x == tile { rate } else { rates.at(x, y) })
    };
    let other =
        with(&rates, 13, VULKAN_RATES[usize::from(rates.at(3, 1) == VULKAN_RATES[0].texel())].texel());
    assert_ne!(other.at(3, 1), rates.at(3, 1));
    let stale = with(&other, 21, STALE | VULKAN_RATES[0].texel());
    let shaded = [&rates, &other, &stale];

    let natural = pictures::plane(pictures::ALL[0], shape.image);
    let faded = |contrast: f32| {
        let texel = |x, y| Vec3::splat(0.2) + (natural.at(x, y) - Vec3::splat(0.2)) * contrast;
        Plane::from_fn(width, height, texel)
    };
    // In the last row and column alone, and by little.
    let mut touched = faded(0.65);
    let corner = touched.texels_mut().last_mut().unwrap();
    corner.y *= 1.001;
    let shown = [&natural, &faded(0.65), &touched];
    // Which picture at which rates, how often, and whether the view was another one before.
    let turns = [
        ((0, 0), 3, true),
        ((1, 0), SETTLED + 4, false),
        ((2, 0), 2, false),
        ((1, 0), 3, true),
        ((1, 0), SETTLED + 1, false),
        ((1, 1), SETTLED + 2, false),
        ((1, 2), 2, false),
    ];
    let (mut seen, mut seen_levels) = (Vec::new(), Vec::new());
    let (mut same_view, mut written) = (0, Vec::new());
    for ((index, at), count, has_moved) in turns {
        same_view = if has_moved { 0 } else { same_view };
        let bytes = packed(shaded[at]);
        vulkan.copy(vulkan.staging(&bytes), tiles.rates(), bytes.len());
        vulkan.upload(Layer { image, layer: 0, extent }, &stored(FLOATS, shown[index], &[]).0);
        for _ in 0..count {
            seen.push((shown[index], shaded[at]));
            let known =
                vulkan.read(tiles.contrast(), columns as usize * rows as usize * size_of::<TileContrast>());
            // The light of a tile is written whenever it is analysed, and nothing is made of it there.
            let mut marked: Vec<TileContrast> = numbers(&known);
            marked.iter_mut().for_each(|tile| tile.adaptation_cd_m2 = -1.0);
            let marked: &[u8] = bytemuck::cast_slice(&marked);
            vulkan.copy(vulkan.staging(marked), tiles.contrast(), marked.len());
            vulkan.run(|commands| {
                // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
                let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
                let picture = AnalyzedPicture { target: &target, layout, comparison: same_view };
                analyze.record(&commands, &[picture]);
            });
            same_view += 1;
            let after = vulkan.read(tiles.contrast(), marked.len());
            seen_levels.push(levels_of(&vulkan, &levels));
            let was_written = after != marked;
            written.push(was_written);
            if !was_written {
                vulkan.copy(vulkan.staging(&known), tiles.contrast(), known.len());
            }
        }
    }
    let settled = |count: u32, rest: usize| (0..count as usize + rest).map(move |turn| turn < count as usize);
    // The first of a picture is another one than that before, and those after it are the same; after the view has moved, from the second
    // one on.
    let expected: Vec<bool> = [true; 3]
        .into_iter()
        .chain(settled(SETTLED, 4))
        .chain([true; 2])
        .chain([true; 3])
        .chain(settled(SETTLED - 3, 4))
        .chain(settled(SETTLED, 2))
        .chain([false; 2])
        .collect();
    assert_eq!(written, expected);

    let bytes = vulkan.read(tiles.contrast(), columns as usize * rows as usize * size_of::<TileContrast>());
    let mut gpu = Analyzed { levels: seen_levels, maps: vec![numbers(&bytes)] };
    let mut cpu = Analyzed::on_cpu(&shape, &seen, &gpu.levels);
    cpu.maps.drain(..cpu.maps.len() - 1);
    for of in [&mut gpu, &mut cpu] {
        of.levels.drain(..of.levels.len() - 1);
    }
    assert_matches("a picture that stays", &gpu, &cpu, SAME);
    vulkan.assert_valid();
}

#[test]
fn formats_of_swapchains_match_the_reference() {
    let (vulkan, [analyze, _]) = both();
    for format in [vk::Format::R8G8B8A8_UNORM, vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_SRGB] {
        let decoded = decoded((&vulkan, &analyze), format);
        for picture in &pictures::ALL[..12] {
            let shape = whole([97, 80]);
            let stored = stored(format, &pictures::plane(*picture, shape.image), &decoded);
            compare((&vulkan, &analyze), picture.0, &shape, format, stored, 1e-3);
        }
    }
    vulkan.assert_valid();
}

/// Value that the device reads for each byte of a format: the luminance of grey tiles. lavapipe approximates sRGB.
fn decoded((vulkan, analyze): (&Vulkan, &Analyze), format: vk::Format) -> Vec<f32> {
    let shape = whole([256 * 16, 16]);
    let bytes: Vec<u8> = (0..16).flat_map(|_| (0..256 * 16).flat_map(|x| [(x / 16) as u8; 4])).collect();
    let rates = Plane::filled(256, 1, 0);
    let gpu = Analyzed::on_gpu((vulkan, analyze), &shape, format, &[(&bytes, &rates)]);
    // Black is stored as the darkest luminance.
    let light = |tile: &TileContrast| Some(tile.adaptation_cd_m2).filter(|light| *light > DARKEST_CD_M2);
    let decoded: Vec<f32> =
        gpu.maps[0].iter().map(|tile| light(tile).unwrap_or_default() / WHITE_CD_M2).collect();
    for (byte, decoded) in (0u8..=255).zip(&decoded) {
        let exact = formats::decoded(format, byte);
        assert!((decoded - exact).abs() <= 0.02 * exact + 1e-4, "{format:?}, {byte}: {decoded} {exact}");
    }
    decoded
}

#[test]
fn tiles_of_any_size_and_place_match_the_reference() {
    let (vulkan, both) = both();
    let natural = pictures::ALL[0];
    for texel in [[8, 8], [16, 8], [32, 32], [64, 64], [16, 32]] {
        for (image, offset, extent) in [
            ([1, 1], [0, 0], [1, 1]),
            ([3, 130], [0, 0], [3, 130]),
            ([131, 117], [0, 0], [131, 117]),
            ([256, 128], [89, 13], [120, 101]),
            ([256, 128], [128, 0], [128, 128]),
        ] {
            for (aggregation, analyze) in [Aggregation::Peak, Aggregation::Mean].into_iter().zip(&both) {
                let shape = Shape { image, offset, extent, texel, aggregation };
                let case = format!("{extent:?} at {offset:?} by {texel:?}, {aggregation:?}");
                let stored = stored(FLOATS, &pictures::plane(natural, image), &[]);
                compare((&vulkan, analyze), &case, &shape, FLOATS, stored, SAME);
            }
        }
    }
    vulkan.assert_valid();
}
