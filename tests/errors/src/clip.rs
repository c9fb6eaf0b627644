//! What is judged: pictures of both eyes over time, where each eye truly looks, and how bright the display is.

use glam::Vec3;
use parafovea_core::color::{Matrix, linear_to_srgb, srgb_to_linear};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;

/// A picture as a headset shows it, kept as the 8-bit sRGB codes that the runtime's compositor saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    codes: Vec<[u8; 3]>,
}

impl Picture {
    /// From 8-bit sRGB with alpha, row by row from the top; alpha is ignored. `None` unless there are
    /// `width * height` pixels, and at least one.
    pub fn from_srgb8(width: u32, height: u32, rgba: &[[u8; 4]]) -> Option<Self> {
        let fits = !rgba.is_empty() && rgba.len() as u64 == u64::from(width) * u64::from(height);
        fits.then(|| Self { width, height, codes: rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect() })
    }

    /// Computes each pixel from its column and row, in linear light (0..=1, BT.709 primaries), and rounds it to a code.
    pub fn from_linear(width: u32, height: u32, mut pixel: impl FnMut(u32, u32) -> [f32; 3]) -> Self {
        let code = |linear: f32| (linear_to_srgb(linear.clamp(0.0, 1.0)) * 255.0).round() as u8;
        let codes = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self { width, height, codes: codes.map(|(x, y)| pixel(x, y).map(code)).collect() }
    }

    /// Columns and rows.
    pub fn extent(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Red, green and blue codes, row by row from the top.
    pub fn codes(&self) -> &[[u8; 3]] {
        &self.codes
    }

    /// A weighted sum of the three channels in linear light, plus a constant.
    pub(crate) fn weighted(&self, weights: Vec3, constant: f32) -> Plane {
        let light = linear_of_code();
        let table = weights.to_array().map(|weight| light.map(|light| weight * light));
        let mut plane = Plane::filled(self.width, self.height, 0.0);
        for (value, &[r, g, b]) in plane.texels_mut().iter_mut().zip(&self.codes) {
            *value = constant + table[0][r as usize] + table[1][g as usize] + table[2][b as usize];
        }
        plane
    }

    /// Luminance, cd/m^2.
    pub fn luminance(&self, viewing: &Viewing) -> Plane {
        let black = viewing.black_cd_m2();
        self.weighted(Matrix::Bt709.weights() * (viewing.white_cd_m2 - black), black)
    }
}

/// Linear light of each code, 0..=1.
fn linear_of_code() -> [f32; 256] {
    std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0))
}

/// What one eye sees in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Eye {
    /// The picture after the runtime's compositor.
    pub picture: Picture,
    /// The picture's field of view.
    pub fov: Fov,
    /// Where the eye truly looks, in view space (+x right, +y up, -z forward), of any length above 0. This is
    /// what the scene's script says, not what an eye tracker reported.
    pub gaze: Vec3,
    /// How many frames ago each part of the picture was rendered, where that is known; of any size, spread evenly
    /// over the picture.
    pub age: Option<Plane>,
}

/// Both eyes at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// When it is shown, seconds, from any origin.
    pub time_s: f64,
    /// Left and right; one may be absent.
    pub eyes: [Option<Eye>; 2],
}

/// Consecutive frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    /// In order of time.
    pub frames: Vec<Frame>,
}

/// How the pictures are shown.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Viewing {
    /// Luminance of white, cd/m^2, above 0.
    pub white_cd_m2: f32,
    /// Luminance of white over that of black, above 1: stray light in the lenses makes black brighter than the panel's.
    pub contrast: f32,
    /// Frames a second, above 0.
    pub refresh_hz: f32,
}

impl Default for Viewing {
    /// 100 cd/m^2, 1000:1, 90 Hz.
    fn default() -> Self {
        Self { white_cd_m2: 100.0, contrast: 1000.0, refresh_hz: 90.0 }
    }
}

impl Viewing {
    /// Luminance of black, cd/m^2.
    pub fn black_cd_m2(&self) -> f32 {
        self.white_cd_m2 / self.contrast
    }
}
