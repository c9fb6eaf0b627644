//! Luminance as the levels keep it: half floats, eleven bits of a number.

use crate::image::Plane;
use crate::perception::luminance::{BRIGHTEST_CD_M2, as_luminance};

/// Black, and all darker luminances, cd/m^2: the least normal half float, as devices may flush smaller ones to zero.
pub const DARKEST_CD_M2: f32 = 1.0 / 16384.0;

/// Rounds a luminance to the nearest half float, the greater of two; within 1 / 2048 of it. Negative numbers and NaN count as black.
///
/// By its bits, because devices round as they like: a number of eleven bits they keep.
pub fn half(luminance_cd_m2: f32) -> f32 {
    let bounded = as_luminance(luminance_cd_m2).clamp(DARKEST_CD_M2, BRIGHTEST_CD_M2);
    f32::from_bits((bounded.to_bits() + 0x1000) & !0x1fff)
}

/// [`half()`] of each texel of `luminance`, into `out`, which takes its size.
pub fn half_plane(luminance: &Plane, out: &mut Plane) {
    out.resize(luminance.width(), luminance.height());
    for (out, value) in out.texels_mut().iter_mut().zip(luminance.texels()) {
        *out = half(*value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ends_are_kept() {
        for (value, kept) in [
            (0.0, DARKEST_CD_M2),
            (-1.0, DARKEST_CD_M2),
            (f32::NAN, DARKEST_CD_M2),
            (1e-40, DARKEST_CD_M2),
            (DARKEST_CD_M2, DARKEST_CD_M2),
            (BRIGHTEST_CD_M2, BRIGHTEST_CD_M2),
            (f32::INFINITY, BRIGHTEST_CD_M2),
            // Between two half floats, and less.
            (2049.0, 2050.0),
            (2048.9, 2048.0),
        ] {
            assert_eq!(half(value), kept, "{value}");
        }
    }

    proptest! {
        #[test]
        fn within_a_part_of_2048(value in DARKEST_CD_M2..=BRIGHTEST_CD_M2) {
            let kept = half(value);
            prop_assert!((kept - value).abs() <= value / 2048.0, "{} {}", value, kept);
            prop_assert_eq!(half(kept), kept);
        }
    }
}
