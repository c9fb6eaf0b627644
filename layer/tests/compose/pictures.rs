//! Pictures, regions of them, and how a result is compared with the reference.

use crate::vulkan::Vulkan;
use ash::vk;
use glam::Vec3;
use parafovea::kernels::compose::{ComposeParams, ComposeRegion, stores_unit_range};
use parafovea_core::chroma::{ChromaSettings, Matrix};
use parafovea_core::color::{linear_to_srgb, srgb_to_linear};
use parafovea_core::geometry::Fov;
use parafovea_core::kernels::compose::{PixelFormat, compose_image};
use std::cell::OnceCell;

/// A wide, asymmetric view, canted a little.
pub const FOV: Fov = Fov { left: -0.95, right: 0.8, up: 0.7, down: -0.9 };

/// Smooth gradients, every pure colour, and noise, in thirds from top to bottom; alpha is anything.
pub fn picture(width: u32, height: u32, seed: u32) -> Vec<u8> {
    let noise = |i: u32| (i.wrapping_add(seed).wrapping_mul(2_654_435_761) >> 13) as u8;
    let texel = |x: u32, y: u32| {
        let i = y * width + x;
        let alpha = noise(i.wrapping_mul(5));
        match y * 3 / height {
            0 => [(x * 255 / width) as u8, (y * 765 / height) as u8, ((x + seed) * 3) as u8, alpha],
            1 => {
                let bit = |n: u32| if (x / 2 + seed) & n != 0 { 255 } else { 0 };
                [bit(1), bit(2), bit(4), alpha]
            }
            _ => [noise(i), noise(i ^ 0x5555), noise(i ^ 0xaaaa), alpha],
        }
    };
    (0..height).flat_map(|y| (0..width).flat_map(move |x| texel(x, y))).collect()
}

/// The rectangle (x, y, width, height) of a layer, with its own gaze.
pub fn region(
    array_layer: u32,
    [x, y, width, height]: [u32; 4],
    gaze: Vec3,
    format: vk::Format,
    settings: &ChromaSettings,
) -> ComposeRegion {
    let unit = stores_unit_range(format);
    ComposeRegion {
        array_layer,
        rect: vk::Rect2D {
            offset: vk::Offset2D { x: x as i32, y: y as i32 },
            extent: vk::Extent2D { width, height },
        },
        params: ComposeParams::new([x, y], [width, height], FOV, gaze, settings, unit),
    }
}

/// The reference's picture of one layer.
pub fn reference(
    before: &[u8],
    width: u32,
    format: vk::Format,
    layer: u32,
    regions: &[ComposeRegion],
) -> Vec<u8> {
    let mut pixels = before.to_vec();
    for region in regions.iter().filter(|region| region.array_layer == layer) {
        compose_image(&mut pixels, width, pixel_format(format), &region.params);
    }
    pixels
}

pub fn pixel_format(format: vk::Format) -> PixelFormat {
    match format {
        vk::Format::R8G8B8A8_SRGB => PixelFormat::Rgba8Srgb,
        vk::Format::B8G8R8A8_SRGB => PixelFormat::Bgra8Srgb,
        vk::Format::R8G8B8A8_UNORM => PixelFormat::Rgba8Unorm,
        vk::Format::B8G8R8A8_UNORM => PixelFormat::Bgra8Unorm,
        other => panic!("no reference for {other:?}"),
    }
}

/// Asserts a difference of at most one code value a channel between a result and `reference` of the picture before; none in `untouched`
/// pixels (in the plateau, or outside of the regions), and none in alpha.
///
/// GPUs read texels of sRGB formats to within half a code value (Direct3D 11.3 functional specification, "sRGB to FLOAT32"). An error
/// of red grows tenfold in saturated blue, so results of GPUs have a further tolerance: half of the change by one code value.
pub fn assert_matches(
    vulkan: &Vulkan,
    before: &[u8],
    reference: impl Fn(&[u8]) -> Vec<u8>,
    result: &[u8],
    untouched: impl Fn(usize) -> bool,
) {
    let expected = reference(before);
    let around = OnceCell::new();
    let added = |byte: usize| -> u8 {
        if vulkan.is_cpu() {
            return 0;
        }
        let around = around.get_or_init(|| neighbours(before).map(|picture| reference(&picture)));
        let changes = around.iter().map(|picture| picture[byte].abs_diff(expected[byte]));
        changes.max().unwrap_or(0).div_ceil(2)
    };
    let texels = before.chunks(4).zip(expected.chunks(4)).zip(result.chunks(4));
    for (index, ((before, expected), result)) in texels.enumerate() {
        assert_eq!(before[3], result[3], "alpha of texel {index}");
        if untouched(index) {
            assert_eq!(before, result, "texel {index} in the plateau or outside of the regions");
        }
        for (channel, (expected, result)) in expected.iter().zip(result).enumerate() {
            let difference = expected.abs_diff(*result);
            assert!(
                difference <= 1 || difference <= 1 + added(4 * index + channel),
                "texel {index}: {result} instead of {expected}, from {before:?}"
            );
        }
    }
}

/// The picture with each channel of all texels one code value lower or higher.
fn neighbours(picture: &[u8]) -> [Vec<u8>; 6] {
    std::array::from_fn(|case| {
        let (channel, is_higher) = (case / 2, case % 2 == 1);
        let moved = |value: u8| if is_higher { value.saturating_add(1) } else { value.saturating_sub(1) };
        let texel = |(byte, value): (usize, &u8)| if byte % 4 == channel { moved(*value) } else { *value };
        picture.iter().enumerate().map(texel).collect()
    })
}

/// Greatest change of luminance between two pictures, in code values of the format's own encoding.
pub fn luminance_change(before: &[u8], after: &[u8], format: vk::Format) -> f32 {
    let format = pixel_format(format);
    let is_srgb = matches!(format, PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb);
    let is_bgr = matches!(format, PixelFormat::Bgra8Srgb | PixelFormat::Bgra8Unorm);
    let decode = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        if is_srgb { srgb_to_linear(value) } else { value }
    };
    let code = |texel: &[u8]| {
        let [red, blue] = if is_bgr { [2, 0] } else { [0, 2] };
        let rgb = Vec3::new(decode(texel[red]), decode(texel[1]), decode(texel[blue]));
        let y = Matrix::Bt709.weights().dot(rgb);
        255.0 * if is_srgb { linear_to_srgb(y) } else { y }
    };
    let texels = before.chunks(4).zip(after.chunks(4));
    texels.map(|(before, after)| (code(before) - code(after)).abs()).fold(0.0, f32::max)
}
