//! Figures against computations of others, and of the simplest kind.

use crate::scene::{SIDE, clip, noisy, ring};
use nv_flip::FlipImageRgb8;
use parafovea_core::geometry::Fov;
use parafovea_models::errors::{Clip, Metric, RINGS, Viewing, judge};

fn noisy_pair() -> [Clip; 2] {
    let reference = clip(1, 0);
    let test = noisy(&reference, 0.1);
    [reference, test]
}

/// Mean over the whole image, from the rings' means.
fn whole(report: &parafovea_models::errors::Report, metric: Metric) -> f64 {
    let rows = || (0..RINGS).map(|ring| report.row(metric, ring));
    let pixels: u64 = rows().map(|row| row.pixels).sum();
    rows().map(|row| row.mean.unwrap_or(0.0) * row.pixels as f64).sum::<f64>() / pixels as f64
}

/// Angle with the tangent 0.1, radians.
const EDGE: f32 = 0.099_668_65;

#[test]
fn flip_is_nvidias_own() {
    let mut pair = noisy_pair();
    for clip in &mut pair {
        // A tenth of the width of the tests' usual view, so that the filters are wider than a pixel.
        clip.frames[0].eyes[0].as_mut().unwrap().fov =
            Fov { left: -EDGE, right: EDGE, up: EDGE, down: -EDGE };
    }
    let [reference, test] = pair;
    let report = judge(&reference, &test, &Viewing::default()).unwrap();
    let image = |clip: &Clip| {
        let codes = clip.frames[0].eyes[0].as_ref().unwrap().picture.codes();
        FlipImageRgb8::with_data(SIDE, SIDE, codes.as_flattened())
    };
    // 1280 pixels are a radian at the centre.
    let errors = nv_flip::flip(image(&reference), image(&test), 1280.0_f32.to_radians());
    let mean = errors.to_vec().iter().map(|&error| f64::from(error)).sum::<f64>() / f64::from(SIDE * SIDE);
    assert!((whole(&report, Metric::Flip) - mean).abs() < 1e-6 && mean > 0.01, "{mean}");
    let pooled = nv_flip::FlipPool::from_image(&errors).mean();
    assert!((whole(&report, Metric::Flip) - f64::from(pooled)).abs() < 1e-4, "{pooled}");
}

#[test]
fn squared_error_is_that_of_the_codes() {
    let [reference, test] = noisy_pair();
    let report = judge(&reference, &test, &Viewing::default()).unwrap();
    let codes = |clip: &Clip| clip.frames[0].eyes[0].as_ref().unwrap().picture.codes().to_vec();
    let (mut sums, mut counts) = ([0.0; RINGS], [0_u64; RINGS]);
    for (at, (a, b)) in (0..SIDE * SIDE).zip(codes(&reference).iter().zip(&codes(&test))) {
        let ring = ring(at % SIDE, at / SIDE);
        sums[ring] +=
            (0..3).map(|c| ((f64::from(a[c]) - f64::from(b[c])) / 255.0).powi(2)).sum::<f64>() / 3.0;
        counts[ring] += 1;
    }
    for ring in 0..RINGS {
        let row = report.row(Metric::Squared, ring);
        assert_eq!(row.pixels, counts[ring], "ring {ring}");
        let expected = sums[ring] / counts[ring] as f64;
        assert!((row.mean.unwrap() / expected - 1.0).abs() < 1e-5, "ring {ring}: {row:?} {expected}");
        assert!(row.worst_tile.unwrap().value >= 0.99 * expected);
    }
}

/// A ring's solid angle on this picture, by counting: 2 degrees are pi 4.47^2 = 63 pixels.
#[test]
fn rings_are_around_the_true_gaze() {
    let mut reference = clip(1, 0);
    let report = judge(&reference, &reference, &Viewing::default()).unwrap();
    let pixels = report.row(Metric::Squared, 0).pixels;
    assert!((60..=68).contains(&pixels), "{pixels}");
    // Looking 30 degrees aside, the pixel there is where the innermost ring is.
    let eye = reference.frames[0].eyes[0].as_mut().unwrap();
    eye.gaze = glam::Vec3::new(0.57735, 0.0, -1.0);
    let aside = 128 + (128.0 * 0.57735) as u32;
    let mut test = reference.clone();
    let codes = test.frames[0].eyes[0].as_ref().unwrap().picture.codes();
    let mut pixels: Vec<[u8; 4]> = codes.iter().map(|&[r, g, b]| [r, g, b, 255]).collect();
    pixels[(128 * SIDE + aside) as usize][1] ^= 64;
    test.frames[0].eyes[0].as_mut().unwrap().picture =
        parafovea_models::errors::Picture::from_srgb8(SIDE, SIDE, &pixels).unwrap();
    let report = judge(&reference, &test, &Viewing::default()).unwrap();
    let means: Vec<f64> = (0..RINGS).map(|ring| report.row(Metric::Squared, ring).mean.unwrap()).collect();
    assert!(means[0] > 0.0 && means[1..] == [0.0; RINGS - 1], "{means:?}");
}
