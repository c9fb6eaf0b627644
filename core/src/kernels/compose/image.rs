//! The kernel over a whole image of 8-bit pixels.

use super::{ComposeParams, TILE_SIZE};
use crate::color::{linear_to_srgb, srgb_to_linear};
use glam::{Vec3, Vec3Swizzles};

/// Format of a pixel of four bytes. Alpha is the last of them and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// R, G, B, A; RGB encoded as sRGB.
    Rgba8Srgb,
    /// B, G, R, A; RGB encoded as sRGB.
    Bgra8Srgb,
    /// R, G, B, A; linear.
    Rgba8Unorm,
    /// B, G, R, A; linear.
    Bgra8Unorm,
}

impl PixelFormat {
    const fn is_srgb(self) -> bool {
        matches!(self, Self::Rgba8Srgb | Self::Bgra8Srgb)
    }

    const fn is_bgr(self) -> bool {
        matches!(self, Self::Bgra8Srgb | Self::Bgra8Unorm)
    }

    /// Colour in linear light of a texel of four bytes.
    pub fn decode(self, texel: &[u8]) -> Vec3 {
        let linear = |byte: u8| {
            let value = f32::from(byte) / 255.0;
            if self.is_srgb() { srgb_to_linear(value) } else { value }
        };
        let rgb = Vec3::new(linear(texel[0]), linear(texel[1]), linear(texel[2]));
        if self.is_bgr() { rgb.zyx() } else { rgb }
    }

    pub(in crate::kernels) fn encode(self, rgb: Vec3, texel: &mut [u8]) {
        let stored = if self.is_bgr() { rgb.zyx() } else { rgb };
        for (byte, linear) in texel.iter_mut().zip(stored.to_array()) {
            let value = linear.clamp(0.0, 1.0);
            let value = if self.is_srgb() { linear_to_srgb(value) } else { value };
            *byte = (value * 255.0).round() as u8;
        }
    }
}

/// Processes one region of an image in place: `pixels` holds rows of `width` texels of four bytes.
///
/// The part of the region outside of the image is ignored.
pub fn compose_image(pixels: &mut [u8], width: u32, format: PixelFormat, params: &ComposeParams) {
    let height = (pixels.len() / 4).checked_div(width as usize).unwrap_or(0) as u32;
    let Some(params) = params.clipped([width, height]) else { return };
    let [columns, rows] = params.tile_grid();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        if params.tile_has_work([column, row]) {
            compose_tile(pixels, width, format, &params, [column, row]);
        }
    }
}

fn compose_tile(
    pixels: &mut [u8],
    width: u32,
    format: PixelFormat,
    params: &ComposeParams,
    [column, row]: [u32; 2],
) {
    let last = |tile: u32, side: u32| ((tile + 1) * TILE_SIZE).min(side);
    for y in row * TILE_SIZE..last(row, params.rect_extent[1]) {
        for x in column * TILE_SIZE..last(column, params.rect_extent[0]) {
            let index =
                (params.rect_offset[1] + y) as usize * width as usize + (params.rect_offset[0] + x) as usize;
            let texel = &mut pixels[index * 4..][..4];
            if let Some(rgb) = params.pixel(x, y, format.decode(texel)) {
                format.encode(rgb, &mut texel[..3]);
            }
        }
    }
}
