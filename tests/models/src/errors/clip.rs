//! A clip to judge: images of both eyes over time, the true gaze of each, and the display's luminance.

use glam::Vec3;
use parafovea_core::color::{Matrix, linear_to_srgb, srgb_to_linear};
use parafovea_core::geometry::Fov;
use parafovea_core::image::Plane;
use parafovea_core::kernels::fill::FillFormat;
use parafovea_core::mask::{Mask, predict};
use parafovea_core::rate::ShadingRate;

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

    /// The image as shown by a device with shading rates: one sample for each block of pixels; `rate` is the block size at a pixel, by column and
    /// row. The sample lies at the block's centre, so it is the mean of the pixels around the centre, in linear light: as many as the block has, up
    /// to four. Devices sample textures at a level that fits the block, and keep edges of triangles sharp; an image cannot show either.
    pub fn shaded_at(&self, rate: impl Fn(u32, u32) -> ShadingRate) -> Self {
        let light = linear_of_code();
        let [last_x, last_y] = [self.width - 1, self.height - 1];
        let around = |from: u32, side: u32, last: u32| {
            let middle = from + side / 2;
            [middle.saturating_sub(u32::from(side > 1)).min(last), middle.min(last)]
        };
        let at = |x: u32, y: u32| self.codes[y as usize * self.width as usize + x as usize];
        let mut shown = self.clone();
        for (index, code) in shown.codes.iter_mut().enumerate() {
            let [x, y] = [index as u32 % self.width, index as u32 / self.width];
            let rate = rate(x, y);
            let [width, height] = [rate.width(), rate.height()];
            if width * height == 1 {
                continue;
            }
            let [left, right] = around(x / width * width, width, last_x);
            let [upper, lower] = around(y / height * height, height, last_y);
            let four = [at(left, upper), at(right, upper), at(left, lower), at(right, lower)];
            *code = [0, 1, 2].map(|channel: usize| {
                let sum: f32 = four.iter().map(|code| light[usize::from(code[channel])]).sum();
                (linear_to_srgb(sum / 4.0) * 255.0).round() as u8
            });
        }
        shown
    }

    /// The image as the layer shows it on a device without shading rates: blocks that the mask skips are filled from shaded ones, in array layer 0.
    /// The mask is of the image's size.
    pub fn filled_by(&self, mask: &Mask) -> Self {
        let mut texels: Vec<u8> = self.codes.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        predict(&mut texels, FillFormat::Srgb8, mask, 0);
        let codes = texels.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        Self { codes, ..*self }
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

/// One eye's view in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Eye {
    /// The picture after the runtime's compositor.
    pub picture: Picture,
    /// The picture's field of view.
    pub fov: Fov,
    /// True gaze direction in view space (+x right, +y up, -z forward), of any length above 0: that of the scene's
    /// script, not that of an eye tracker.
    pub gaze: Vec3,
    /// Number of frames since each part of the picture was rendered; None if unknown. Of any size, spread evenly over
    /// the picture.
    pub age: Option<Plane>,
}

/// Both eyes at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Display time, seconds, from any origin.
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

/// Viewing conditions of the pictures.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(codes: [u8; 8]) -> Picture {
        let rgba: Vec<[u8; 4]> = (0..8).flat_map(|_| codes.map(|code| [code, code, code, 255])).collect();
        Picture::from_srgb8(8, 8, &rgba).unwrap()
    }

    #[test]
    fn a_block_shows_what_is_at_its_centre() {
        let picture = columns([0, 255, 0, 0, 7, 7, 255, 255]);
        assert_eq!(picture.shaded_at(|_, _| ShadingRate::R1X1), picture);
        assert_eq!(picture.shaded_at(|_, _| ShadingRate::R1X2), picture, "rows do not differ");
        // The mean of black and white in linear light.
        let half = (linear_to_srgb(0.5) * 255.0).round() as u8;
        let twos = columns([half, half, 0, 0, 7, 7, 255, 255]);
        assert_eq!(picture.shaded_at(|_, _| ShadingRate::R2X2), twos);
        // Of four pixels the inner two.
        let between = |a: usize, b: usize| {
            let light = linear_of_code();
            (linear_to_srgb(light[a].midpoint(light[b])) * 255.0).round() as u8
        };
        let (left, right) = (between(255, 0), between(7, 255));
        let fours = columns([left, left, left, left, right, right, right, right]);
        assert_eq!(picture.shaded_at(|_, _| ShadingRate::R4X4), fours);
    }

    #[test]
    fn skipped_blocks_are_filled_from_shaded_ones() {
        use parafovea_core::mask::{MaskView, TileRates};
        let noise = |x: u32, y: u32| ((x * 7 + y * 13) % 11) as f32 / 11.0;
        let picture = Picture::from_linear(64, 64, |x, y| [noise(x, y), noise(y, x), 0.5]);
        let of = |rate: ShadingRate| {
            let rates = [rate.texel(); 16];
            let tiles = TileRates { texel: [16; 2], first: [0; 2], columns: 4, rates: &rates };
            let mut mask = Mask::new([64; 2], 1);
            mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent: [64; 2], tiles }]);
            mask
        };
        assert_eq!(picture.filled_by(&of(ShadingRate::R1X1)), picture);
        let mask = of(ShadingRate::R2X2);
        let filled = picture.filled_by(&mask);
        let pixels = (0..64 * 64u32).map(|index| [index % 64, index / 64]);
        let changed = pixels.zip(filled.codes().iter().zip(picture.codes())).filter(|(_, (a, b))| a != b);
        let changed: Vec<_> = changed.map(|(pixel, _)| pixel).collect();
        assert!(changed.iter().all(|pixel| mask.skips(0, *pixel)), "a shaded pixel changed");
        assert!(changed.len() > 1000, "{} pixels changed", changed.len());
    }

    #[test]
    fn each_pixel_has_its_own_rate_and_blocks_at_the_edge_stay_inside() {
        let picture = Picture::from_linear(5, 3, |x, y| [0.1 * x as f32, 0.2 * y as f32, 0.5]);
        let mixed = picture.shaded_at(|x, _| if x < 4 { ShadingRate::R1X1 } else { ShadingRate::R4X4 });
        for (index, (shown, own)) in mixed.codes().iter().zip(picture.codes()).enumerate() {
            assert_eq!(shown[0], own[0], "pixel {index}: nothing lies to the right of the last column");
            assert!(index % 5 == 4 || shown == own, "pixel {index}");
        }
    }
}
