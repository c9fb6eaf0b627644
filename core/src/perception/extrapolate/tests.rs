use super::*;
use crate::image::Plane;
use crate::kernels::analyze::{Aggregation, Buffers, ContrastSettings, analyze};
use crate::perception::ContrastMap;
use proptest::prelude::*;

const MEASURED: TileContrast = TileContrast { bands: [0.9, 0.1, 0.3, 0.2], adaptation_cd_m2: 50.0 };

#[test]
fn lost_octaves_take_the_finest_that_survives() {
    for (rate, bands) in [
        (ShadingRate::R1X1, [0.9, 0.1, 0.3, 0.2]),
        // Lost in one direction: the contrast in the other direction counts if it is higher.
        (ShadingRate::R2X1, [0.9, 0.1, 0.3, 0.2]),
        (ShadingRate::R1X2, [0.9, 0.1, 0.3, 0.2]),
        (ShadingRate::R2X2, [0.1 * 1.7 / 1.1, 0.1, 0.3, 0.2]),
        (ShadingRate::R4X2, [0.5, 0.33 / 1.02, 0.3, 0.2]),
        (ShadingRate::R2X4, [0.5, 0.33 / 1.02, 0.3, 0.2]),
        (ShadingRate::R4X4, [0.5, 0.33 / 1.02, 0.3, 0.2]),
    ] {
        let got = extrapolate(MEASURED, rate);
        let differs = got.bands.iter().zip(bands).any(|(a, b)| (a - b).abs() > 1e-6);
        assert!(!differs && got.adaptation_cd_m2 == 50.0, "{rate:?}: {got:?}");
    }
}

proptest! {
    #[test]
    fn detail_finer_than_a_block_does_not_matter(fine in any::<[f32; 2]>(), rest in prop::array::uniform2(0.0..9.0f32)) {
        let of = |a, b| extrapolate(TileContrast { bands: [a, b, rest[0], rest[1]], adaptation_cd_m2: 1.0 }, ShadingRate::R4X4);
        prop_assert_eq!(of(fine[0], fine[1]), of(0.0, 0.0));
    }

    #[test]
    fn again_changes_nothing(bands in prop::array::uniform4(0.0..9.0f32), texel in 0u8..16) {
        if let Some(rate) = ShadingRate::from_texel(texel) {
            let once = extrapolate(TileContrast { bands, adaptation_cd_m2: 1.0 }, rate);
            prop_assert_eq!(extrapolate(once, rate), once);
        }
    }
}

/// A picture with equal contrast in every octave, as natural ones have: gratings at random angles and phases whose
/// frequencies are spread evenly over the logarithm.
fn natural(side: u32) -> Plane {
    let gratings: Vec<[f32; 3]> = (0..400u32)
        .map(|i| {
            let unit = |salt: u32| (i.wrapping_mul(salt) >> 8) as f32 / 16_777_216.0;
            let frequency = std::f32::consts::PI * (-7.0 * unit(0x9e37_79b1)).exp2();
            let (sin, cos) = (unit(0x85eb_ca77) * std::f32::consts::TAU).sin_cos();
            [frequency * cos, frequency * sin, unit(0xc2b2_ae35) * std::f32::consts::TAU]
        })
        .collect();
    Plane::from_fn(side, side, |x, y| {
        let sum: f32 = gratings.iter().map(|[u, v, phase]| (u * x as f32 + v * y as f32 + phase).sin()).sum();
        (100.0 + sum).max(0.0)
    })
}

fn mean_of(picture: &Plane, measure: impl Fn(TileContrast) -> TileContrast) -> [f32; BANDS] {
    let settings = ContrastSettings { aggregation: Aggregation::Mean, ..ContrastSettings::default() };
    let mut map = ContrastMap::default();
    analyze(picture, &settings, &mut Buffers::default(), &mut map);
    let tiles = map.tiles.texels();
    std::array::from_fn(|i| {
        tiles.iter().map(|tile| measure(*tile).bands[i]).sum::<f32>() / tiles.len() as f32
    })
}

#[test]
fn a_natural_picture_comes_back() {
    let picture = natural(160);
    let whole = mean_of(&picture, |tile| tile);
    for (rate, lost) in
        [(ShadingRate::R2X2, 1), (ShadingRate::R4X2, 2), (ShadingRate::R2X4, 2), (ShadingRate::R4X4, 2)]
    {
        let [width, height] = [rate.width(), rate.height()];
        // Each block has the value of its middle.
        let coarse = Plane::from_fn(160, 160, |x, y| {
            picture.at(x / width * width + width / 2, y / height * height + height / 2)
        });
        let back = mean_of(&coarse, |tile| extrapolate(tile, rate));
        for band in 0..lost {
            let ratio = back[band] / whole[band];
            assert!((0.85..1.25).contains(&ratio), "{rate:?}, band {band}: {ratio}");
        }
    }
}
