//! Coding of colours: luma weights and the sRGB transfer function.

use glam::Vec3;

/// Primaries that luminance is computed for (`chroma.matrix`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Matrix {
    /// ITU-R BT.709, the primaries of sRGB.
    #[default]
    Bt709,
    /// ITU-R BT.601.
    Bt601,
    /// ITU-R BT.2020 (non-constant luminance).
    Bt2020,
}

impl Matrix {
    /// Weights (Kr, Kg, Kb) of red, green and blue in Y; their sum is 1.
    pub const fn weights(self) -> Vec3 {
        match self {
            Self::Bt709 => Vec3::new(0.2126, 0.7152, 0.0722),
            Self::Bt601 => Vec3::new(0.299, 0.587, 0.114),
            Self::Bt2020 => Vec3::new(0.2627, 0.6780, 0.0593),
        }
    }
}

/// Decodes an sRGB component in 0..=1 to linear light (IEC 61966-2-1).
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Encodes linear light in 0..=1 as an sRGB component (IEC 61966-2-1).
pub fn linear_to_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
