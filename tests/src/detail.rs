//! Differences of images with coarse shading from those without: around a gaze, and for maps that a rule changes.

use crate::HarnessError;
use crate::picture::Picture;
use glam::{Quat, Vec3};
use parafovea_core::geometry::{Fov, eccentricity};
use parafovea_core::image::Plane;
use parafovea_core::rate::ShadingRate;
use parafovea_models::errors::{Eye, Picture as Seen, Viewing, seen_of_stills};
use std::f32::consts::FRAC_PI_4;
use std::path::Path;

/// The view of the mock runtime's eyes.
const FOV: Fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };

/// The difference of two images of an eye of the mock runtime, 90 by 90 degrees, for a gaze in one direction.
pub struct View {
    pixels: Vec<Pixel>,
}

#[derive(Clone, Copy)]
struct Pixel {
    /// Angle from the gaze, degrees.
    eccentricity_deg: f32,
    /// Visibility of the change, just-noticeable differences.
    jnd: f32,
    /// The squared difference, in the mean of the colours, code values.
    squared: f32,
}

impl View {
    /// Compares a picture with its reference, for a gaze in degrees to the left and upwards.
    ///
    /// # Errors
    /// [`HarnessError::Format`] for pictures that cannot be compared.
    pub fn compare(reference: &Picture, test: &Picture, [left, up]: [f32; 2]) -> Result<Self, HarnessError> {
        let failed = |reason: String| HarnessError::format(Path::new("a pair of pictures"), reason);
        let seen = |picture: &Picture| {
            Seen::from_srgb8(picture.width, picture.height, &picture.pixels)
                .ok_or_else(|| failed("no pixels".to_owned()))
        };
        let turn = Quat::from_rotation_y(left.to_radians()) * Quat::from_rotation_x(up.to_radians());
        let gaze = turn * Vec3::NEG_Z;
        let eye = Eye { picture: seen(reference)?, fov: FOV, gaze, age: None };
        let jnd: Plane = seen_of_stills(&eye, &seen(test)?, &Viewing::default())
            .map_err(|error| failed(error.to_string()))?;
        let plane = FOV.tangents().plane([reference.width, reference.height]);
        let pixels = reference.enumerate().zip(&test.pixels).zip(jnd.texels());
        let pixels = pixels.map(|(((x, y, was), is), &jnd)| {
            let direction = plane.direction(glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
            let squares = was[..3].iter().zip(&is[..3]).map(|(was, is)| f32::from(was.abs_diff(*is)).powi(2));
            Pixel {
                eccentricity_deg: eccentricity(direction, gaze).to_degrees(),
                jnd,
                squared: squares.sum::<f32>() / 3.0,
            }
        });
        Ok(Self { pixels: pixels.collect() })
    }

    /// Its part within so many degrees of the gaze.
    #[must_use]
    pub fn within(mut self, degrees: f32) -> Self {
        self.pixels.retain(|pixel| pixel.eccentricity_deg <= degrees);
        self
    }

    /// Just noticeable differences, the mean over all pixels.
    pub fn mean_jnd(&self) -> f64 {
        self.mean(|pixel| pixel.jnd)
    }

    /// Just noticeable differences that so small a share of the pixels exceeds.
    pub fn greatest_jnd(&self, share: f64) -> f32 {
        let mut all: Vec<f32> = self.pixels.iter().map(|pixel| pixel.jnd).collect();
        all.sort_by(f32::total_cmp);
        let index = (all.len() as f64 * (1.0 - share)) as usize;
        all.get(index.min(all.len().saturating_sub(1))).copied().unwrap_or_default()
    }

    /// The root of the mean squared difference, code values.
    pub fn root_mean_square(&self) -> f64 {
        self.mean(|pixel| pixel.squared).sqrt()
    }

    fn mean(&self, of: impl Fn(&Pixel) -> f32) -> f64 {
        self.pixels.iter().map(|pixel| f64::from(of(pixel))).sum::<f64>() / self.pixels.len().max(1) as f64
    }
}

/// Rates of a map, two hexadecimal digits a texel as in the layer's passes' file, each finer by one step along each axis.
pub fn finer(digits: &str) -> String {
    texels(digits)
        .map(|texel| {
            let finer = |log2: u8| log2.saturating_sub(1);
            format!("{:02x}", finer(texel >> 2) << 2 | finer(texel & 3))
        })
        .collect()
}

/// The share of the pixels that such a map shades.
pub fn shaded(digits: &str) -> f64 {
    let fraction = |texel: u8| ShadingRate::from_texel(texel).map_or(1.0, |rate| f64::from(rate.fraction()));
    let (sum, count) =
        texels(digits).fold((0.0, 0_u32), |(sum, count), texel| (sum + fraction(texel), count + 1));
    sum / f64::from(count.max(1))
}

fn texels(digits: &str) -> impl Iterator<Item = u8> + '_ {
    let pairs = digits.as_bytes().chunks(2);
    pairs.map(|pair| {
        pair.iter().fold(0, |texel, &digit| texel << 4 | char::from(digit).to_digit(16).unwrap_or(0) as u8)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(square: [u32; 2]) -> Picture {
        Picture::from_fn(128, 128, |x, y| {
            let is_in = x.abs_diff(square[0]) < 4 && y.abs_diff(square[1]) < 4;
            let value = if is_in { 200 } else { 90 };
            [value, value, value, 255]
        })
    }

    #[test]
    fn a_change_counts_where_it_is_and_more_where_the_eyes_look() {
        let (reference, test) = (picture([64, 64]), picture([200, 200]));
        let at = |gaze| View::compare(&reference, &test, gaze).unwrap();
        assert!(at([0.0, 0.0]).mean_jnd() > 1.2 * at([35.0, 0.0]).mean_jnd());
        assert_eq!(at([35.0, 0.0]).within(10.0).root_mean_square(), 0.0);
        assert!(at([0.0, 0.0]).within(10.0).root_mean_square() > 10.0);
        assert!(at([0.0, 0.0]).greatest_jnd(0.001) > at([0.0, 0.0]).greatest_jnd(0.5));
    }

    #[test]
    fn the_gaze_is_to_the_left_and_upwards() {
        let (reference, test) = (picture([20, 20]), picture([200, 200]));
        let near = |gaze| View::compare(&reference, &test, gaze).unwrap().within(10.0).root_mean_square();
        assert!(near([34.0, 30.0]) > 10.0);
        assert_eq!(near([-34.0, -30.0]), 0.0);
    }

    #[test]
    fn maps_become_finer_along_each_axis_and_shade_more() {
        // 4x4, 2x2, 1x1, 4x2.
        assert_eq!(finer("0a050009"), "05000004");
        assert_eq!(shaded("0a050009"), (1.0 / 16.0 + 1.0 / 4.0 + 1.0 + 1.0 / 8.0) / 4.0);
    }
}
