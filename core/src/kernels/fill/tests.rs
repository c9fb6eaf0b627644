use super::*;
use crate::image::Plane;
use crate::mask::{Mask, MaskView, TileRates, predict};
use crate::rate::{ShadingRate, VULKAN_RATES};
use proptest::prelude::*;

const SIDE: u32 = 64;

fn mask(rate: ShadingRate) -> Mask {
    let rates = Plane::filled(8, 8, rate.texel());
    let mut mask = Mask::new([SIDE; 2], 1);
    let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 8, rates: rates.texels() };
    mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent: [SIDE; 2], tiles }]);
    mask
}

fn picture(format: FillFormat, color: impl Fn(u32, u32) -> Vec4) -> Vec<u8> {
    let mut pixels = vec![0; (SIDE * SIDE) as usize * format.texel_size()];
    for (index, texel) in pixels.chunks_exact_mut(format.texel_size()).enumerate() {
        format.encode(color(index as u32 % SIDE, index as u32 / SIDE), texel);
    }
    pixels
}

fn texel(pixels: &[u8], format: FillFormat, x: u32, y: u32) -> Vec4 {
    format.decode(&pixels[(y * SIDE + x) as usize * format.texel_size()..][..format.texel_size()])
}

#[test]
fn stored_colours_are_read_back() {
    for format in FillFormat::ALL {
        for step in 0..=1023u32 {
            let level = step as f32 / 1023.0;
            let mut once = [0; 8];
            format
                .encode(Vec4::new(level, 1.0 - level, level * level, 1.0), &mut once[..format.texel_size()]);
            let mut twice = [0; 8];
            format.encode(format.decode(&once), &mut twice[..format.texel_size()]);
            assert_eq!(once, twice, "{format:?} at {level}");
        }
    }
}

#[test]
fn packed_formats_have_their_components_in_place() {
    // Vulkan specification, "Identification of Formats": the first named component is in the highest bits.
    let decoded = |format: FillFormat, word: u32| format.decode(&word.to_le_bytes());
    assert_eq!(decoded(FillFormat::Unorm10, 0x3ff), Vec4::new(1.0, 0.0, 0.0, 0.0));
    assert_eq!(decoded(FillFormat::Unorm10, 0xc000_0000), Vec4::W);
    // Exponent 15 is 2^0: red in bits 0 to 10, green to 21, blue to 31.
    assert_eq!(decoded(FillFormat::Float11, 15 << 6), Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(decoded(FillFormat::Float11, 15 << 17), Vec4::new(0.0, 1.0, 0.0, 1.0));
    assert_eq!(decoded(FillFormat::Float11, 15 << 27), Vec4::new(0.0, 0.0, 1.0, 1.0));
    assert_eq!(decoded(FillFormat::Unorm8, 0xff), Vec4::X);
    // Half of the stored range is a quarter of the light.
    assert!((decoded(FillFormat::Srgb8, 0x80).x - 0.252).abs() < 1e-3);
}

#[test]
fn even_areas_stay_as_they_are() {
    for format in FillFormat::ALL {
        for rate in VULKAN_RATES {
            let before = picture(format, |_, _| Vec4::new(0.2, 0.9, 0.004, 1.0));
            let mut after = before.clone();
            predict(&mut after, format, &mask(rate), 0);
            assert_eq!(before, after, "{format:?} {rate:?}");
        }
    }
}

#[test]
fn shaded_blocks_and_other_layers_are_untouched() {
    let mask = mask(ShadingRate::R2X2);
    let noise = |x: u32, y: u32| {
        Vec4::splat((x * 7919 + y * 104_729).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32)
    };
    for format in FillFormat::ALL {
        let before = picture(format, noise);
        let mut after = before.clone();
        predict(&mut after, format, &mask, 1);
        assert_eq!(before, after);
        predict(&mut after, format, &mask, 0);
        let size = format.texel_size();
        let mut changed = 0;
        for (index, (old, new)) in before.chunks_exact(size).zip(after.chunks_exact(size)).enumerate() {
            let pixel = [index as u32 % SIDE, index as u32 / SIDE];
            assert!(old == new || mask.skips(0, pixel), "{format:?} {pixel:?}");
            changed += u32::from(old != new);
        }
        assert!(changed > SIDE * SIDE / 2, "{format:?}: {changed}");
    }
}

/// A straight edge through blocks of a checkerboard is followed: by distance alone, 0.15 of its other side would come across.
#[test]
fn edges_are_followed() {
    let upright = |x: u32, _: u32| if x < 34 { Vec4::ZERO } else { Vec4::ONE };
    let mut after = picture(FillFormat::Unorm8, upright);
    predict(&mut after, FillFormat::Unorm8, &mask(ShadingRate::R2X1), 0);
    for (x, y) in (8..56).flat_map(|y| (8..56).map(move |x| (x, y))) {
        let (is, was) = (texel(&after, FillFormat::Unorm8, x, y).x, upright(x, y).x);
        assert!((is - was).abs() < 0.05, "{is} instead of {was} at {x}, {y}");
    }
}

#[test]
fn values_that_are_not_finite_do_not_spread() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mask = mask(ShadingRate::R4X4);
        let format = FillFormat::Float16;
        let before =
            picture(format, |x, y| if (x / 4, y / 4) == (8, 8) { Vec4::splat(bad) } else { Vec4::ONE });
        assert!(!mask.skips(0, [32, 32]));
        let mut after = before;
        predict(&mut after, format, &mask, 0);
        let pixels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
        for (x, y) in pixels.filter(|&(x, y)| (x / 4, y / 4) != (8, 8)) {
            assert_eq!(texel(&after, format, x, y), Vec4::ONE, "{x}, {y} of {bad}");
        }
    }
    assert_eq!(blend([Some((Vec4::NAN, 1.0)), None, None, None]), Vec4::ZERO);
}

#[test]
fn lists_of_larger_pictures_are_harmless() {
    let mask = mask(ShadingRate::R4X4);
    let mut pixels = vec![7; 30 * 50 * 4];
    let before = pixels.clone();
    fill_image(&mut pixels, [30, 90], FillFormat::Unorm8, mask.list(), 0);
    assert_eq!(before, pixels);
    fill_image(&mut [], [0, 0], FillFormat::Unorm8, mask.list(), 0);
}

proptest! {
    #[test]
    fn means_lie_between_their_sources(
        colors in proptest::array::uniform4((0.0f32..1.0, -2.0f32..2.0, 0.0f32..60000.0, 0.0f32..1.0)),
        distances in proptest::array::uniform4(1u32..800), there in proptest::array::uniform4(any::<bool>()),
    ) {
        let source = |at: usize| {
            let (x, y, z, w) = colors[at];
            there[at].then_some((Vec4::new(x, y, z, w), distances[at] as f32))
        };
        let sources = [source(0), source(1), source(2), source(3)];
        let mean = blend(sources);
        let present = || sources.iter().flatten().map(|(color, _)| *color);
        if there.contains(&true) {
            let low = present().fold(Vec4::INFINITY, Vec4::min);
            let high = present().fold(Vec4::NEG_INFINITY, Vec4::max);
            let slack = 1e-5 * (1.0 + low.abs().max(high.abs()));
            prop_assert!(mean.cmpge(low - slack).all() && mean.cmple(high + slack).all(), "{mean} of {sources:?}");
        } else {
            prop_assert_eq!(mean, Vec4::ZERO);
        }
    }
}
