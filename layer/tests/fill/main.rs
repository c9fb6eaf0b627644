//! The pass `fill` on a Vulkan device, under the validation layers where they are installed, compared with its CPU
//! reference. Without a Vulkan device the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a failed step is a failed test")]

mod picture;
#[path = "../compose/transfer.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod transfer;
#[path = "../compose/vulkan.rs"]
#[allow(dead_code, reason = "shared with the tests of compose")]
mod vulkan;

use ash::vk;
use parafovea::gpu::{AppCommands, ImagePart};
use parafovea::kernels::fill::{Fill, SkipBuffer, USAGE, fill_format};
use parafovea_core::image::Plane;
use parafovea_core::kernels::fill::FillFormat;
use parafovea_core::mask::{Mask, MaskView, SkipList, TileRates, predict};
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};
use picture::{assert_matches, picture};
use transfer::Layer;
use vulkan::Vulkan;

const FORMATS: [vk::Format; 7] = [
    vk::Format::R8G8B8A8_SRGB,
    vk::Format::B8G8R8A8_SRGB,
    vk::Format::R8G8B8A8_UNORM,
    vk::Format::B8G8R8A8_UNORM,
    vk::Format::A2B10G10R10_UNORM_PACK32,
    vk::Format::B10G11R11_UFLOAT_PACK32,
    vk::Format::R16G16B16A16_SFLOAT,
];

/// A picture of the application's, as the layer has it created.
struct Picture {
    image: vk::Image,
    format: vk::Format,
    extent: vk::Extent2D,
    layers: u32,
}

impl Picture {
    fn new(vulkan: &Vulkan, format: vk::Format, extent: [u32; 2], layers: u32) -> Self {
        let [width, height] = extent;
        let extent = vk::Extent2D { width, height };
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | USAGE;
        let image = vulkan.image(vk::ImageCreateFlags::empty(), format, extent, layers, usage);
        Self { image, format, extent, layers }
    }

    /// Fills the picture by the list of a mask; returns its layers.
    fn filled(&self, vulkan: &Vulkan, fill: &Fill, list: &SkipList, layers: &[Vec<u8>]) -> Vec<Vec<u8>> {
        let at = |layer: usize| Layer { image: self.image, layer: layer as u32, extent: self.extent };
        for (number, pixels) in layers.iter().enumerate() {
            vulkan.upload(at(number), pixels);
        }
        let blocks = list.len();
        let buffer = SkipBuffer::new(&vulkan.gpu, blocks, list).unwrap();
        assert_eq!(buffer.capacity_words(), list.words().len());
        let extent = [self.extent.width, self.extent.height];
        let target = fill.target(self.format, extent, self.layers, &buffer).unwrap();
        let aspects = vk::ImageAspectFlags::COLOR;
        let part = ImagePart { image: self.image, aspects, level: 0, first_layer: 0, layers: self.layers };
        vulkan.run(|commands| {
            // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
            let commands = unsafe { AppCommands::new(&vulkan.gpu, commands) };
            fill.record(&commands, &target, &buffer, part, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL);
        });
        let (format, _) = fill_format(self.format).unwrap();
        let result = (0..layers.len()).map(|layer| vulkan.download(at(layer), format.texel_size())).collect();
        drop(target);
        result
    }
}

/// Rings of all rates, around a point that differs by layer.
fn rings(extent: [u32; 2], layers: u32, texel: u32) -> Mask {
    let tiles = extent.map(|side| side.div_ceil(texel));
    let rates: Vec<_> = (0..layers)
        .map(|layer| {
            Plane::from_fn(tiles[0], tiles[1], |x, y| {
                let away = x.abs_diff(tiles[0] / 3 + layer) + y.abs_diff(tiles[1] / 2);
                VULKAN_RATES[6usize.saturating_sub(away as usize / 2)].texel()
            })
        })
        .collect();
    let mut mask = Mask::new(extent, layers);
    let views: Vec<_> = (0..)
        .zip(&rates)
        .map(|(layer, rates)| {
            let (columns, rates) = (rates.width(), rates.texels());
            let tiles = TileRates { texel: [texel; 2], first: [0; 2], columns, rates };
            MaskView { layer, offset: [0; 2], extent, tiles }
        })
        .collect();
    mask.resolve(&views);
    mask
}

#[test]
fn matches_the_reference() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let fill = Fill::new(&vulkan.gpu).unwrap();
    for format in FORMATS {
        let (kind, _) = fill_format(format).unwrap();
        for (extent, texel, layers) in
            [([256, 192], 8, 2), ([131, 117], 16, 1), ([8, 8], 8, 1), ([1, 1], 8, 1)]
        {
            let mask = rings(extent, layers, texel);
            assert!(!mask.list().is_empty() || extent[0] <= 8);
            let before: Vec<_> = (0..layers).map(|layer| picture(kind, extent, layer)).collect();
            let drawn = Picture::new(&vulkan, format, extent, layers);
            let after = drawn.filled(&vulkan, &fill, mask.list(), &before);
            for (layer, (before, after)) in (0..).zip(before.iter().zip(&after)) {
                let mut expected = before.clone();
                predict(&mut expected, kind, &mask, layer);
                assert_matches(kind, &expected, after, |pixel| mask.skips(layer, pixel), extent);
                assert!(mask.list().is_empty() || before != after, "nothing was done");
            }
        }
    }
    vulkan.assert_valid();
}

#[test]
fn an_empty_list_changes_nothing() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let fill = Fill::new(&vulkan.gpu).unwrap();
    for format in FORMATS {
        let (kind, _) = fill_format(format).unwrap();
        let before = [picture(kind, [64, 64], 0)];
        let drawn = Picture::new(&vulkan, format, [64, 64], 1);
        assert_eq!(drawn.filled(&vulkan, &fill, Mask::new([64, 64], 1).list(), &before), before);
    }
    vulkan.assert_valid();
}

/// More blocks than one row of workgroups holds.
#[test]
fn large_pictures_are_filled_whole() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let fill = Fill::new(&vulkan.gpu).unwrap();
    let extent = [2048, 1536];
    let rates = Plane::filled(32, 24, ShadingRate::R4X4.texel());
    let mut mask = Mask::new(extent, 1);
    let tiles = TileRates { texel: [64; 2], first: [0; 2], columns: 32, rates: rates.texels() };
    mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent, tiles }]);
    assert!(mask.list().words()[1] > 1, "one row");
    let format = FillFormat::Unorm8;
    let before = [picture(format, extent, 0)];
    let drawn = Picture::new(&vulkan, vk::Format::R8G8B8A8_UNORM, extent, 1);
    let after = drawn.filled(&vulkan, &fill, mask.list(), &before);
    let mut expected = before[0].clone();
    predict(&mut expected, format, &mask, 0);
    assert_matches(format, &expected, &after[0], |pixel| mask.skips(0, pixel), extent);
    vulkan.assert_valid();
}

#[test]
fn values_that_are_not_finite_do_not_spread() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let fill = Fill::new(&vulkan.gpu).unwrap();
    let mask = rings([128, 128], 1, 8);
    for (format, bad) in [
        (vk::Format::R16G16B16A16_SFLOAT, vec![0x00, 0x7e, 0x00, 0x7c, 0x00, 0xfc, 0x01, 0x7c]),
        (vk::Format::B10G11R11_UFLOAT_PACK32, vec![0xff, 0xff, 0xff, 0xff]),
    ] {
        let (kind, _) = fill_format(format).unwrap();
        let bad_at = |pixel: [u32; 2]| (pixel[0] / 8 + pixel[1] / 8).is_multiple_of(5);
        let mut before = picture(kind, [128, 128], 0);
        let size = kind.texel_size();
        for (index, texel) in before.chunks_exact_mut(size).enumerate() {
            if bad_at([index as u32 % 128, index as u32 / 128]) {
                texel.copy_from_slice(&bad);
            }
        }
        let drawn = Picture::new(&vulkan, format, [128, 128], 1);
        let after = drawn.filled(&vulkan, &fill, mask.list(), std::slice::from_ref(&before));
        for (index, texel) in after[0].chunks_exact(size).enumerate() {
            let pixel = [index as u32 % 128, index as u32 / 128];
            assert!(!mask.skips(0, pixel) || kind.decode(texel).is_finite(), "{format:?} {pixel:?}");
        }
        let mut expected = before.clone();
        predict(&mut expected, kind, &mask, 0);
        assert_matches(kind, &expected, &after[0], |pixel| mask.skips(0, pixel), [128, 128]);
    }
    vulkan.assert_valid();
}

#[test]
fn other_formats_are_refused() {
    for format in
        [vk::Format::R32_UINT, vk::Format::R8G8B8A8_UINT, vk::Format::D32_SFLOAT, vk::Format::UNDEFINED]
    {
        assert_eq!(fill_format(format), None);
    }
}
