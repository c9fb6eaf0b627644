mod moved;

use super::*;
use crate::chroma::Matrix;
use crate::layout::Uniform;
use proptest::prelude::*;
use std::f32::consts::FRAC_PI_4;

const FOV: Fov = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };

fn params(offset: [u32; 2], extent: [u32; 2], gaze: Vec3) -> ComposeParams {
    ComposeParams::new(offset, extent, FOV, gaze, &ChromaSettings::default(), true)
}

/// A picture of every byte value in changing combinations.
fn picture(width: u32, height: u32) -> Vec<u8> {
    (0..width * height).flat_map(|i| [i, i / 3, i * 7, i * 5].map(|v| (v % 256) as u8)).collect()
}

fn luminance(texel: &[u8]) -> f32 {
    let linear = |byte: u8| crate::color::srgb_to_linear(f32::from(byte) / 255.0);
    Matrix::Bt709.weights().dot(Vec3::new(linear(texel[0]), linear(texel[1]), linear(texel[2])))
}

#[test]
fn parameters_fill_whole_uniform_slots() {
    // WGSL rounds a uniform struct up to 16 bytes; without padding at the end both sides agree on the size.
    assert_eq!(size_of::<ComposeParams>() % 16, 0);
    let fields: usize = ComposeParams::FIELDS.iter().map(|field| field.size).sum();
    assert_eq!(fields, size_of::<ComposeParams>());
}

#[test]
fn plateau_alpha_and_the_outside_are_untouched() {
    let (width, height) = (37, 53);
    let before = picture(width, height);
    let mut after = before.clone();
    let region = params([5, 7], [30, 40], Vec3::NEG_Z);
    compose_image(&mut after, width, PixelFormat::Rgba8Srgb, &region);
    let (mut changed, mut plateau) = (0, 0);
    for (index, (old, new)) in before.chunks(4).zip(after.chunks(4)).enumerate() {
        let (x, y) = (index as u32 % width, index as u32 / width);
        assert_eq!(old[3], new[3], "alpha at {x}, {y}");
        let inside = (5..35).contains(&x) && (7..47).contains(&y);
        let angle = |x: u32, y: u32| {
            eccentricity(region.plane().direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)), Vec3::NEG_Z)
        };
        if !inside {
            assert_eq!(old, new, "outside at {x}, {y}");
        } else if angle(x - 5, y - 7) <= region.plateau {
            assert_eq!(old, new, "plateau at {x}, {y}");
            plateau += 1;
        } else if old != new {
            changed += 1;
        }
    }
    assert!(plateau > 5 && changed > 900, "{plateau} in the plateau, {changed} changed");
}

#[test]
fn luminance_moves_by_one_code_value_at_most() {
    let (width, height) = (256, 64);
    let before = picture(width, height);
    let mut after = before.clone();
    compose_image(&mut after, width, PixelFormat::Rgba8Srgb, &params([0, 0], [width, height], Vec3::NEG_Z));
    let code = |texel: &[u8]| 255.0 * crate::color::linear_to_srgb(luminance(texel));
    for (old, new) in before.chunks(4).zip(after.chunks(4)) {
        assert!((code(old) - code(new)).abs() <= 1.0, "{old:?} became {new:?}");
    }
}

#[test]
fn bgra_is_rgba_with_red_and_blue_exchanged() {
    let swap = |pixels: &[u8]| -> Vec<u8> {
        pixels.chunks(4).flat_map(|texel| [texel[2], texel[1], texel[0], texel[3]]).collect()
    };
    for (rgba, bgra) in
        [(PixelFormat::Rgba8Srgb, PixelFormat::Bgra8Srgb), (PixelFormat::Rgba8Unorm, PixelFormat::Bgra8Unorm)]
    {
        let mut straight = picture(32, 32);
        let mut swapped = swap(&straight);
        let region = params([0, 0], [32, 32], Vec3::new(0.5, 0.0, -1.0));
        compose_image(&mut straight, 32, rgba, &region);
        compose_image(&mut swapped, 32, bgra, &region);
        assert_eq!(swap(&swapped), straight);
    }
}

#[test]
fn no_gaze_no_work() {
    for gaze in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let region = params([0, 0], [64, 64], gaze);
        assert!(!region.has_work());
        assert_eq!(region.pixel(0, 0, Vec3::X), None);
    }
}

#[test]
fn a_wider_focus_and_less_strength_keep_more_colour() {
    let chroma = |focus: Focus| {
        let rgb = params([0, 0], [64, 64], Vec3::NEG_Z).following(focus).pixel(0, 32, Vec3::X);
        rgb.map_or(1.0, |rgb| rgb.x - rgb.z)
    };
    let straight = Focus::at(Vec3::NEG_Z);
    let plain = chroma(straight);
    assert!(plain < 0.8, "{plain}");
    assert!(chroma(Focus { radius: 0.3, ..straight }) > plain + 0.1);
    assert!((chroma(Focus { strength: 0.5, ..straight }) - (1.0 + plain) / 2.0).abs() < 1e-6);
    assert_eq!(chroma(Focus { strength: 0.0, ..straight }), 1.0);
    assert_eq!(chroma(Focus { radius: 1.0, ..straight }), 1.0);
}

#[test]
fn regions_beyond_the_image_are_clipped() {
    let before = picture(20, 20);
    let mut after = before.clone();
    let far = params([15, 15], [u32::MAX, 100], Vec3::NEG_Z);
    compose_image(&mut after, 20, PixelFormat::Rgba8Unorm, &far);
    assert_ne!(before, after);
    assert_eq!(params([20, 0], [1, 1], Vec3::NEG_Z).clipped([20, 20]), None);
    assert_eq!(params([0, 0], [0, 5], Vec3::NEG_Z).clipped([20, 20]), None);
    assert_eq!(far.clipped([20, 20]).map(|region| region.rect_extent), Some([5, 5]));
}

proptest! {
    #[test]
    fn tiles_without_work_hold_plateau_pixels_only(
        x in -1.5f32..1.5, y in -1.5f32..1.5, width in 1u32..200, height in 1u32..200,
        radius in prop_oneof![Just(0.0f32), 0.0f32..3.2], strength in prop_oneof![Just(1.0f32), Just(0.0), 0.0f32..1.0],
    ) {
        let focus = Focus { direction: Vec3::new(x, y, -1.0), radius, strength };
        let region = params([0, 0], [width, height], Vec3::NEG_Z).following(focus);
        let [columns, rows] = region.tile_grid();
        let mut any = false;
        for tile in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
            let mut inside = (0..TILE_SIZE * TILE_SIZE)
                .map(|i| (tile[0] * TILE_SIZE + i % TILE_SIZE, tile[1] * TILE_SIZE + i / TILE_SIZE))
                .filter(|&(x, y)| x < width && y < height);
            let touched = inside.any(|(x, y)| region.pixel(x, y, Vec3::X).is_some());
            prop_assert!(region.tile_has_work(tile) || !touched, "{tile:?}");
            any |= region.tile_has_work(tile);
        }
        prop_assert_eq!(region.has_work(), any);
    }
}
