//! Texel formats of the kernel.

use glam::{Vec3, Vec4};
use half::f16;

/// The formats of pictures that can be filled. Which of red and blue comes first does not matter: all components but
/// alpha are treated alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FillFormat {
    /// R8G8B8A8 or B8G8R8A8, UNORM.
    Unorm8,
    /// R8G8B8A8 or B8G8R8A8, sRGB. Interpolated as squares of the stored values: linear light to within the difference
    /// between the sRGB curve and a power of 2, at a multiplication and a square root.
    Srgb8,
    /// A2B10G10R10 or A2R10G10B10, UNORM, packed into 32 bits with alpha in the highest two.
    Unorm10,
    /// B10G11R11, unsigned floating point packed into 32 bits; no alpha.
    Float11,
    /// R16G16B16A16, floating point.
    Float16,
}

impl FillFormat {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Unorm8, Self::Srgb8, Self::Unorm10, Self::Float11, Self::Float16];

    /// Bytes of a texel.
    pub const fn texel_size(self) -> usize {
        match self {
            Self::Unorm8 | Self::Srgb8 | Self::Unorm10 | Self::Float11 => 4,
            Self::Float16 => 8,
        }
    }

    /// The colour of a texel of [`Self::texel_size`] bytes, in the space in which the kernel interpolates.
    pub fn decode(self, texel: &[u8]) -> Vec4 {
        match self {
            Self::Unorm8 => unorm8(texel),
            Self::Srgb8 => {
                let stored = unorm8(texel);
                (stored * stored).truncate().extend(stored.w)
            }
            Self::Unorm10 => {
                let bits = word(texel);
                let ten = |shift: u32| (bits >> shift & 0x3ff) as f32 / 1023.0;
                Vec4::new(ten(0), ten(10), ten(20), (bits >> 30) as f32 / 3.0)
            }
            Self::Float11 => {
                let bits = word(texel);
                // As half floats: the same exponent, fewer bits of mantissa, no sign.
                let half = |bits: u32| f16::from_bits(bits as u16).to_f32();
                Vec4::new(
                    half((bits & 0x7ff) << 4),
                    half((bits >> 11 & 0x7ff) << 4),
                    half((bits >> 22) << 5),
                    1.0,
                )
            }
            Self::Float16 => {
                let half = |at: usize| f16::from_le_bytes([texel[at], texel[at + 1]]).to_f32();
                Vec4::new(half(0), half(2), half(4), half(6))
            }
        }
    }

    /// Stores a colour in a texel.
    pub fn encode(self, color: Vec4, texel: &mut [u8]) {
        match self {
            Self::Unorm8 => store_unorm8(color, texel),
            Self::Srgb8 => {
                let rgb = color.truncate().max(Vec3::ZERO);
                store_unorm8(rgb.map(f32::sqrt).extend(color.w), texel);
            }
            Self::Unorm10 => {
                let code = |value: f32, steps: f32| (value.clamp(0.0, 1.0) * steps).round() as u32;
                let rgb = code(color.x, 1023.0) | code(color.y, 1023.0) << 10 | code(color.z, 1023.0) << 20;
                texel.copy_from_slice(&(rgb | code(color.w, 3.0) << 30).to_le_bytes());
            }
            Self::Float11 => {
                let [red, green, blue] = color.truncate().max(Vec3::ZERO).to_array();
                // A half float without its lowest bits, rounded.
                let cut = |value: f32, bits: u32| {
                    (u32::from(f16::from_f32(value).to_bits()) + (1 << (bits - 1))) >> bits
                };
                let packed = cut(red, 4) | cut(green, 4) << 11 | cut(blue, 5) << 22;
                texel.copy_from_slice(&packed.to_le_bytes());
            }
            Self::Float16 => {
                for (bytes, value) in texel.chunks_exact_mut(2).zip(color.to_array()) {
                    bytes.copy_from_slice(&f16::from_f32(value).to_le_bytes());
                }
            }
        }
    }
}

fn word(texel: &[u8]) -> u32 {
    u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]])
}

fn unorm8(texel: &[u8]) -> Vec4 {
    Vec4::new(f32::from(texel[0]), f32::from(texel[1]), f32::from(texel[2]), f32::from(texel[3])) / 255.0
}

fn store_unorm8(color: Vec4, texel: &mut [u8]) {
    for (byte, value) in texel.iter_mut().zip(color.to_array()) {
        *byte = (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    }
}
