use super::*;
use std::f32::consts::TAU;

fn grating(cycles_per_pixel: f32) -> Plane {
    Plane::from_fn(512, 8, |x, _| (TAU * cycles_per_pixel * x as f32).cos())
}

fn amplitudes(picture: &Plane) -> [f32; BANDS] {
    let mut amplitudes = [0.0; BANDS];
    Bands::default().split(picture, |band, values| {
        // The middle, where the edges do not show.
        let middle = &values.row(4)[64..448];
        amplitudes[band] = BAND_GAIN[band] * middle.iter().fold(0.0, |most, value| value.abs().max(most));
    });
    amplitudes
}

#[test]
fn a_grating_at_a_bands_peak_keeps_its_amplitude_there_and_is_less_elsewhere() {
    for band in 1..BANDS - 1 {
        let amplitudes = amplitudes(&grating(BAND_CYCLES_PER_PIXEL[band]));
        assert!((amplitudes[band] - 1.0).abs() < 0.01, "{band}: {amplitudes:?}");
        assert!(amplitudes.iter().enumerate().all(|(at, &amplitude)| at == band || amplitude < 0.85));
    }
    assert!((amplitudes(&grating(0.5))[0] - 1.0).abs() < 1e-5);
}

#[test]
fn bands_add_up_to_the_picture() {
    let picture = Plane::from_fn(70, 50, |x, y| ((x * 7 + y * 13) % 31) as f32);
    let mut sum = Plane::filled(70, 50, 0.0);
    Bands::default().split(&picture, |_, values| {
        sum.texels_mut().iter_mut().zip(values.texels()).for_each(|(sum, value)| *sum += value);
    });
    assert!(sum.texels().iter().zip(picture.texels()).all(|(sum, value)| (sum - value).abs() < 1e-4));
}

#[test]
fn a_change_shows_within_the_support_only() {
    let dot = Plane::from_fn(101, 101, |x, y| if (x, y) == (50, 50) { 1.0 } else { 0.0 });
    let mut farthest = 0;
    Bands::default().split(&dot, |_, values| {
        for y in 0..101_u32 {
            for (x, &value) in (0_u32..).zip(values.row(y)) {
                if value != 0.0 {
                    farthest = farthest.max(x.abs_diff(50)).max(y.abs_diff(50));
                }
            }
        }
    });
    assert_eq!(farthest, BAND_SUPPORT_PX);
}
