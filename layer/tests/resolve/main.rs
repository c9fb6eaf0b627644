//! The passes `resolve` and `mask` on a Vulkan device, under the validation layers where they are installed, compared with their
//! CPU references. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

#[path = "../compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use parafovea::backend::mask::{DepthWork, Eligible, MaskKernels, MaskMap, mask_views, resolve_mask};
use parafovea::gpu::AppCommands;
use parafovea::kernels::analyze::{ViewTiles, rate_row_bytes};
use parafovea::kernels::mask::MaskPass;
use parafovea::kernels::resolve::{RateMapTable, RateMapTexels, Resolve};
use parafovea::pass_detection::{Eyes, Orientation, Part};
use parafovea::rate_map::{DeviceRates, EyeMap, RateImage, rate_map_table};
use parafovea_core::image::Plane;
use parafovea_core::kernels::resolve::resolve;
use parafovea_core::mask::{BLOCK, DepthFormat, Mask, TemplateDepths, write_template};
use parafovea_core::rate::VULKAN_RATES;
use parafovea_core::reuse::STALE;
use std::collections::BTreeSet;
use std::sync::Arc;
use vulkan::Vulkan;

const TEXEL: [u32; 2] = [16, 16];

/// Rates of the tiles of a picture: runs of one rate, and single ones; some are stale where that is asked for.
fn rates([columns, rows]: [u32; 2], seed: u32, with_stale: bool) -> Plane<u8> {
    let hash = |x: u32, y: u32| {
        let mixed =
            x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae35);
        (mixed ^ mixed >> 15).wrapping_mul(0x27d4_eb2f) >> 8
    };
    Plane::from_fn(columns, rows, |x, y| {
        let rate = match hash(x / 5, y / 4) % 3 {
            0 => hash(x, y) % 7,
            _ => hash(x / 5, y / 4 + 99) % 7,
        };
        let is_stale = with_stale && hash(x / 3, y / 3 + 7) % 4 == 0;
        VULKAN_RATES[rate as usize].texel() | if is_stale { STALE } else { 0 }
    })
}

fn eye_map(extent: [u32; 2], rates: &Plane<u8>) -> EyeMap {
    let mut map = EyeMap::default();
    map.set(extent, TEXEL, [rates.width(), rates.height()], rates.texels());
    map
}

fn part(eyes: Eyes, layer: u32, rect: [f32; 4], orientation: Orientation) -> Part {
    Part { eyes, layer, rect, orientation }
}

/// The drawn parts, and the two eyes.
struct Case {
    parts: Vec<Part>,
    image: RateImage,
    eye: [u32; 2],
    with_stale: bool,
}

fn cases() -> Vec<Case> {
    let whole = [0.0, 0.0, 1.0, 1.0];
    let image = |area: [u32; 4], layers| RateImage {
        area,
        texel: TEXEL,
        tiles: [(area[0] + area[2]).div_ceil(16), (area[1] + area[3]).div_ceil(16)],
        layers,
    };
    let upright = Orientation::Upright;
    [false, true]
        .into_iter()
        .flat_map(|with_stale| {
            [
                (vec![part(Eyes::Left, 0, whole, upright)], image([0, 0, 320, 256], 1), [320, 256]),
                (
                    vec![part(Eyes::Left, 0, whole, upright), part(Eyes::Right, 1, whole, upright)],
                    image([0, 0, 300, 212], 2),
                    [320, 256],
                ),
                (
                    vec![
                        part(Eyes::Left, 0, [0.0, 0.0, 0.5, 1.0], upright),
                        part(Eyes::Right, 0, [0.5, 0.0, 0.5, 1.0], Orientation::UpsideDown),
                    ],
                    image([16, 32, 424, 208], 1),
                    [212, 208],
                ),
                (
                    vec![part(Eyes::Finer, 0, [0.1, 0.1, 0.8, 0.7], Orientation::Unknown)],
                    image([0, 0, 256, 200], 1),
                    [512, 400],
                ),
            ]
            .map(|(parts, image, eye)| Case { parts, image, eye, with_stale })
        })
        .collect()
}

/// A device with the rates of two eyes on it.
struct Bed {
    vulkan: Vulkan,
    resolve: Resolve,
}

impl Bed {
    fn new() -> Self {
        let vulkan = Vulkan::at(vk::API_VERSION_1_1);
        Self { resolve: Resolve::new(&vulkan.gpu).unwrap(), vulkan }
    }

    fn target(
        &self,
        table: &RateMapTable,
        eyes: [&Plane<u8>; 2],
        available: [u8; 16],
        leaves_out: bool,
    ) -> RateMapTexels {
        let tiles = eyes.map(|rates| {
            let tiles = Arc::new(ViewTiles::new(&self.vulkan.gpu, [rates.width(), rates.height()]).unwrap());
            let row = rate_row_bytes(rates.width()) as usize;
            let mut bytes = vec![0; row * rates.height() as usize];
            for (y, bytes) in (0..).zip(bytes.chunks_mut(row)) {
                bytes[..rates.width() as usize].copy_from_slice(rates.row(y));
            }
            self.vulkan.copy(self.vulkan.staging(&bytes), tiles.rates(), bytes.len());
            tiles
        });
        self.resolve.target(table, tiles.each_ref(), available, leaves_out).unwrap()
    }
}

#[test]
fn texels_match_the_reference() {
    let bed = Bed::new();
    for (number, case) in (0u32..).zip(cases()) {
        for offered in [&VULKAN_RATES[..], &VULKAN_RATES[3..5], &[]] {
            let Case { parts, image, eye, with_stale } = &case;
            let eyes =
                [0, 1].map(|index| rates(eye.map(|side| side.div_ceil(16)), 2 * number + index, *with_stale));
            let maps = eyes.each_ref().map(|rates| eye_map(*eye, rates));
            let table = rate_map_table(maps.each_ref(), parts, image).unwrap();
            let available = DeviceRates::new(offered.iter().copied()).available();
            for leaves_out in [false, true] {
                let target = bed.target(&table, eyes.each_ref(), available, leaves_out);
                bed.vulkan.run(|commands| {
                    // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                    let commands = unsafe { AppCommands::new(&bed.vulkan.gpu, commands) };
                    bed.resolve.record(&commands, &target);
                });
                let params = table.params(eyes.each_ref().map(Plane::width), available, leaves_out);
                let expected = resolve(&params, &table, eyes.each_ref());
                let got = bed.vulkan.read(target.texels(), target.len());
                assert!(got == expected, "case {number}, {} rates, leaves out: {leaves_out}", offered.len());
                assert!(leaves_out || expected.iter().all(|texel| texel & STALE == 0));
            }
        }
    }
    bed.vulkan.assert_valid();
}

/// The skipped blocks with their sources; their order does not matter.
fn skipped(words: &[u32]) -> BTreeSet<[u32; 2]> {
    let count = words[3] as usize;
    words[4..4 + 2 * count].chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

#[test]
fn masks_match_the_reference() {
    let bed = Bed::new();
    let gpu = &bed.vulkan.gpu;
    let (kernels, pass) = (Arc::new(MaskKernels::new(gpu).unwrap()), MaskPass::new(gpu).unwrap());
    let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
    let mut all_skipped = 0;
    for (number, case) in (0u32..).zip(cases()) {
        let Case { parts, image, eye, with_stale } = &case;
        let eyes =
            [0, 1].map(|index| rates(eye.map(|side| side.div_ceil(16)), 2 * number + index, *with_stale));
        let maps = eyes.each_ref().map(|rates| eye_map(*eye, rates));
        let table = rate_map_table(maps.each_ref(), parts, image).unwrap();
        let available = DeviceRates::new(VULKAN_RATES.into_iter()).available();
        let target = Arc::new(bed.target(&table, eyes.each_ref(), available, true));
        let [x, y, width, height] = image.area;
        let extent = [x + width, y + height];
        for format in [DepthFormat::Unorm16, DepthFormat::Float32, DepthFormat::Blocks] {
            let eligible = Eligible { format, depths, drawn: None, work: DepthWork::default() };
            let map = Arc::new(MaskMap::new(gpu, &kernels, eligible, extent, image.layers).unwrap());
            let views = mask_views(parts, image);
            let masked =
                pass.target(map.clone(), &target, (image.texel, image.tiles, image.layers), &views).unwrap();
            // Twice: the earlier entries of the list must be gone.
            for _ in 0..2 {
                bed.vulkan.run(|commands| {
                    // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
                    let commands = unsafe { AppCommands::new(gpu, commands) };
                    bed.resolve.record(&commands, &target);
                    pass.record(&commands, &masked);
                });
            }
            let texels = bed.vulkan.read(target.texels(), target.len());
            let mut mask = Mask::new(extent, image.layers);
            resolve_mask(&mut mask, parts, image, &texels);
            let words = mask.list().words();
            let got = bed.vulkan.read(map.list(), (words.len() + 2) * 4);
            let got: Vec<u32> = got.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect();
            assert_eq!(got[..4], words[..4], "case {number}: the dispatch");
            assert!(skipped(&got) == skipped(words), "case {number}, {format:?}: other blocks are filled");
            all_skipped += words[3];
            let size = 4 * format.words(extent).unwrap().layer as usize;
            let got = bed.vulkan.read(map.template().unwrap(), size * image.layers as usize);
            for layer in 0..image.layers {
                let mut expected = vec![0; size];
                write_template(&mask, layer, format, depths, &mut expected);
                let got = &got[layer as usize * size..][..size];
                assert!(got == expected, "case {number}, {format:?}, layer {layer}: another template");
            }
        }
    }
    assert!(all_skipped > 10_000, "hardly anything is skipped: {all_skipped}");
    bed.vulkan.assert_valid();
}

#[test]
fn unsupported_tables_are_refused() {
    let bed = Bed::new();
    let gpu = &bed.vulkan.gpu;
    let (kernels, pass) = (Arc::new(MaskKernels::new(gpu).unwrap()), MaskPass::new(gpu).unwrap());
    let tiles = rates([4, 4], 1, false);
    let map = eye_map([64, 64], &tiles);
    let image = RateImage { area: [0, 0, 64, 64], texel: TEXEL, tiles: [4, 4], layers: 1 };
    let parts = [part(Eyes::Left, 0, [0.0, 0.0, 1.0, 1.0], Orientation::Upright)];
    let table = rate_map_table([&map, &map], &parts, &image).unwrap();
    let target = Arc::new(bed.target(&table, [&tiles, &tiles], [0; 16], false));
    let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
    let views = mask_views(&parts, &image);
    let made = |extent: [u32; 2], texel: [u32; 2]| {
        let eligible =
            Eligible { format: DepthFormat::Unorm16, depths, drawn: None, work: DepthWork::default() };
        let map = Arc::new(MaskMap::new(gpu, &kernels, eligible, extent, 1).unwrap());
        pass.target(map.clone(), &target, (texel, [4, 4], 1), &views).is_ok()
    };
    assert!(made([64, 64], TEXEL));
    assert!(!made([63, 64], TEXEL), "a row that does not begin with a word");
    assert!(!made([64, 64], [16, BLOCK + 1]), "tiles that are no whole blocks");
    bed.vulkan.assert_valid();
}
