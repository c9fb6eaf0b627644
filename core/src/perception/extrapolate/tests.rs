use super::*;
use proptest::prelude::*;

const MEASURED: TileContrast = TileContrast { bands: [0.9, 0.1, 0.3, 0.2], adaptation_cd_m2: 50.0 };

#[test]
fn lost_octaves_take_the_finest_that_survives() {
    for (rate, bands) in [
        (ShadingRate::R1X1, [0.9, 0.1, 0.3, 0.2]),
        // Lost in one direction: what the other direction shows counts if it is more.
        (ShadingRate::R2X1, [0.9, 0.1, 0.3, 0.2]),
        (ShadingRate::R1X2, [0.9, 0.1, 0.3, 0.2]),
        (ShadingRate::R2X2, [0.1, 0.1, 0.3, 0.2]),
        (ShadingRate::R4X2, [0.3, 0.3, 0.3, 0.2]),
        (ShadingRate::R2X4, [0.3, 0.3, 0.3, 0.2]),
        (ShadingRate::R4X4, [0.3, 0.3, 0.3, 0.2]),
    ] {
        assert_eq!(extrapolate(MEASURED, rate), TileContrast { bands, ..MEASURED }, "{rate:?}");
    }
}

proptest! {
    #[test]
    fn what_the_block_cannot_show_does_not_matter(fine in any::<[f32; 2]>(), rest in prop::array::uniform2(0.0..9.0f32)) {
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
