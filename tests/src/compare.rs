//! Differences of two images of the same frame: the three figures of the demo's table, and the tests' figures.
//!
//! All pictures are as stored: sRGB code values. `selected` chooses the pixels that count, by column and row.

use crate::picture::Picture;
use glam::DVec3;
use parafovea_core::color::{Matrix, srgb_to_linear};

/// Largest difference between two pictures, in code values (0..=255), over all four channels.
pub fn max_difference(a: &Picture, b: &Picture, selected: impl Fn(u32, u32) -> bool) -> u8 {
    pairs(a, b, selected)
        .flat_map(|(a, b)| a.into_iter().zip(b))
        .map(|(a, b)| a.abs_diff(b))
        .max()
        .unwrap_or(0)
}

/// Peak signal-to-noise ratio over the colour channels' code values, in dB; infinite if nothing differs.
///
/// 10 log10(255^2 / mean squared error).
pub fn psnr_db(a: &Picture, b: &Picture, selected: impl Fn(u32, u32) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (a, b) in pairs(a, b, selected) {
        for channel in 0..3 {
            sum += f64::from(a[channel].abs_diff(b[channel])).powi(2);
            count += 1.0;
        }
    }
    if sum == 0.0 { f64::INFINITY } else { 10.0 * (255.0_f64.powi(2) * count / sum).log10() }
}

/// Share of the chroma of `before` that `after` keeps: 1 for all of it, 0 for grey.
///
/// The sum of chroma magnitudes after over that before. A pixel's chroma magnitude is sqrt(Cb^2 + Cr^2) in
/// linear-light YCbCr with the weights of ITU-R BT.709; the attenuation scales this magnitude. The share is 1 if
/// `before` has no colour.
pub fn chroma_kept(before: &Picture, after: &Picture, selected: impl Fn(u32, u32) -> bool) -> f64 {
    let (mut had, mut has) = (0.0, 0.0);
    for (before, after) in pairs(before, after, selected) {
        had += chroma_magnitude(before);
        has += chroma_magnitude(after);
    }
    if had == 0.0 { 1.0 } else { has / had }
}

/// The difference between two pictures, times eight so that it can be seen; opaque.
pub fn difference_times_8(a: &Picture, b: &Picture) -> Picture {
    Picture::from_fn(a.width, a.height, |x, y| {
        let (a, b) = (a.at(x, y), b.at(x, y));
        let channel = |i: usize| a[i].abs_diff(b[i]).saturating_mul(8);
        [channel(0), channel(1), channel(2), 255]
    })
}

/// Linear-light luminance of a stored colour, by ITU-R BT.709, in 0..=1.
pub fn luminance(pixel: [u8; 4]) -> f64 {
    let weights = Matrix::Bt709.weights().as_dvec3();
    weights.dot(linear(pixel))
}

fn chroma_magnitude(pixel: [u8; 4]) -> f64 {
    let (weights, color, y) = (Matrix::Bt709.weights().as_dvec3(), linear(pixel), luminance(pixel));
    // BT.709-6, item 3.3: the divisors bring Cb and Cr to -0.5..=0.5.
    ((color.z - y) / (2.0 * (1.0 - weights.z))).hypot((color.x - y) / (2.0 * (1.0 - weights.x)))
}

fn linear(pixel: [u8; 4]) -> DVec3 {
    let channel = |i: usize| f64::from(srgb_to_linear(f32::from(pixel[i]) / 255.0));
    DVec3::new(channel(0), channel(1), channel(2))
}

fn pairs<'a>(
    a: &'a Picture,
    b: &'a Picture,
    selected: impl Fn(u32, u32) -> bool + 'a,
) -> impl Iterator<Item = ([u8; 4], [u8; 4])> + 'a {
    assert_eq!((a.width, a.height), (b.width, b.height), "pictures of one size can be compared");
    a.enumerate().filter(move |(x, y, _)| selected(*x, *y)).map(|(x, y, pixel)| (pixel, b.at(x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parafovea_core::color::linear_to_srgb;

    fn plain(pixel: [u8; 4]) -> Picture {
        Picture::from_fn(4, 4, |_, _| pixel)
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let red = plain([255, 0, 0, 255]);
        assert_eq!(max_difference(&red, &red, |_, _| true), 0);
        assert_eq!(psnr_db(&red, &red, |_, _| true), f64::INFINITY);
        assert_eq!(chroma_kept(&red, &red, |_, _| true), 1.0);
    }

    #[test]
    fn only_selected_pixels_count() {
        let before = plain([10, 20, 30, 255]);
        let after = Picture::from_fn(4, 4, |x, _| if x == 3 { [10, 29, 30, 250] } else { [10, 20, 30, 255] });
        assert_eq!(max_difference(&before, &after, |x, _| x < 3), 0);
        assert_eq!(max_difference(&before, &after, |x, _| x == 3), 9);
        // One channel of three differs by 9: mean squared error 27.
        let psnr = psnr_db(&before, &after, |x, _| x == 3);
        assert!((psnr - 10.0 * (255.0_f64 * 255.0 / 27.0).log10()).abs() < 1e-9, "{psnr}");
    }

    #[test]
    fn grey_keeps_no_chroma() {
        let (red, grey) = (plain([255, 0, 0, 255]), plain([127, 127, 127, 255]));
        assert!(chroma_kept(&red, &grey, |_, _| true) < 1e-6);
        assert_eq!(chroma_kept(&grey, &red, |_, _| false), 1.0);
    }

    #[test]
    fn half_the_linear_chroma_is_one_half() {
        // Red at half saturation around the same luminance, in linear light.
        let y = Matrix::Bt709.weights().x;
        let code = |linear: f32| (linear_to_srgb(linear) * 255.0).round() as u8;
        let half = plain([code((1.0 + y) / 2.0), code(y / 2.0), code(y / 2.0), 255]);
        let kept = chroma_kept(&plain([255, 0, 0, 255]), &half, |_, _| true);
        assert!((kept - 0.5).abs() < 0.005, "{kept}");
    }
}
