use super::*;
use proptest::prelude::*;

proptest! {
    #[test]
    fn within_bounds_whatever_comes_in(rgb in any::<[f32; 3]>(), white in any::<f32>()) {
        for matrix in [Matrix::Bt709, Matrix::Bt601, Matrix::Bt2020] {
            let luminance = luminance(rgb.into(), white, matrix);
            prop_assert!((0.0..=BRIGHTEST_CD_M2).contains(&luminance));
        }
    }

    #[test]
    fn any_bits_become_a_luminance(bits in any::<u32>()) {
        let value = f32::from_bits(bits);
        let luminance = as_luminance(value);
        prop_assert!((0.0..=BRIGHTEST_CD_M2).contains(&luminance));
        if (0.0..=BRIGHTEST_CD_M2).contains(&value) {
            prop_assert_eq!(luminance, value);
        }
    }
}

#[test]
fn white_is_white() {
    for matrix in [Matrix::Bt709, Matrix::Bt601, Matrix::Bt2020] {
        assert!((luminance(Vec3::ONE, 250.0, matrix) - 250.0).abs() < 1e-4);
        assert_eq!(luminance(Vec3::ZERO, 250.0, matrix), 0.0);
    }
    assert!((luminance(Vec3::Y, 100.0, Matrix::Bt709) - 71.52).abs() < 1e-4);
}

#[test]
fn unusable_numbers_are_replaced() {
    let of = |rgb: [f32; 3]| luminance(rgb.into(), 100.0, Matrix::Bt709);
    assert_eq!(of([f32::NAN, 1.0, 0.0]), of([0.0, 1.0, 0.0]));
    assert_eq!(of([f32::INFINITY; 3]), BRIGHTEST_CD_M2);
    assert_eq!(of([f32::INFINITY, f32::NEG_INFINITY, f32::NAN]), 0.0);
    assert_eq!(of([-1.0; 3]), 0.0);
    // Colours outside of the gamut have negative components, and a luminance.
    assert!((of([1.0, -0.1, 0.0]) - (21.26 - 7.152)).abs() < 1e-4);
    for white in [0.0, -5.0, f32::NAN, f32::INFINITY] {
        assert_eq!(luminance(Vec3::ONE, white, Matrix::Bt709), of([1.0; 3]));
    }
    assert_eq!(as_luminance(-0.0).to_bits(), 0);
    assert_eq!(as_luminance(f32::INFINITY), BRIGHTEST_CD_M2);
    assert_eq!(as_luminance(f32::from_bits(0x7f80_0001)), 0.0);
}

#[test]
fn planes_as_pixels() {
    let colors = Plane::from_fn(5, 3, |x, y| Vec3::new(x as f32, y as f32, f32::NAN));
    let mut out = Plane::filled(1, 1, 7.0);
    luminance_plane(&colors, 80.0, Matrix::Bt2020, &mut out);
    let expected = Plane::from_fn(5, 3, |x, y| luminance(colors.at(x, y), 80.0, Matrix::Bt2020));
    assert_eq!(out, expected);
}
