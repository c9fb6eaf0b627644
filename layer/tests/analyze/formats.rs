//! Colours as an image holds them.

use ash::vk;
use glam::Vec3;
use half::f16;
use parafovea_core::color::{linear_to_srgb, srgb_to_linear};
use parafovea_core::image::Plane;

/// The bytes of a picture in a format, and the colours that are read from them; `decoded` has the value of each byte.
pub fn stored(format: vk::Format, colors: &Plane<Vec3>, decoded: &[f32]) -> (Vec<u8>, Plane<Vec3>) {
    let mut bytes = Vec::new();
    let mut read = colors.clone();
    for color in read.texels_mut() {
        let rgb = color.to_array();
        *color = match format {
            vk::Format::R32G32B32A32_SFLOAT => {
                bytes.extend([rgb[0], rgb[1], rgb[2], 1.0].map(f32::to_ne_bytes).concat());
                *color
            }
            vk::Format::R16G16B16A16_SFLOAT => {
                let halves = rgb.map(f16::from_f32);
                bytes.extend([halves[0], halves[1], halves[2], f16::ONE].map(f16::to_ne_bytes).concat());
                halves.map(f16::to_f32).into()
            }
            _ => {
                let [r, g, b] =
                    rgb.map(|value| (encoded(format, value.clamp(0.0, 1.0)) * 255.0).round() as u8);
                let is_bgr = format == vk::Format::B8G8R8A8_SRGB;
                bytes.extend(if is_bgr { [b, g, r, 255] } else { [r, g, b, 255] });
                [r, g, b].map(|byte| decoded[usize::from(byte)]).into()
            }
        };
    }
    (bytes, read)
}

fn is_srgb(format: vk::Format) -> bool {
    matches!(format, vk::Format::R8G8B8A8_SRGB | vk::Format::B8G8R8A8_SRGB)
}

fn encoded(format: vk::Format, value: f32) -> f32 {
    if is_srgb(format) { linear_to_srgb(value) } else { value }
}

/// Value of a byte of a format, 0..=1.
pub fn decoded(format: vk::Format, byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if is_srgb(format) { srgb_to_linear(value) } else { value }
}
