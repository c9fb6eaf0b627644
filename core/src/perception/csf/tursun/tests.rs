use super::*;
use proptest::prelude::*;

proptest! {
    #[test]
    fn finite_whatever_comes_in(f in any::<f32>(), e in any::<f32>(), l in any::<f32>()) {
        for fit in [Fit::QUARTER, Fit::FULL] {
            let sensitivity = fit.sensitivity(f, e, l);
            prop_assert!(sensitivity.is_finite() && sensitivity >= 0.0);
        }
    }

    #[test]
    fn falls_with_eccentricity(f in 0.1..60.0f32, e in 0.0..100.0f32, l in 0.1..1e3f32) {
        for fit in [Fit::QUARTER, Fit::FULL] {
            let near = fit.sensitivity(f, e, l);
            let far = fit.sensitivity(f, e + 1.0, l);
            prop_assert!(far < near || near < 1.2e-38);
        }
    }
}

#[test]
fn passes_through_its_knots() {
    for fit in [Fit::QUARTER, Fit::FULL] {
        for (log10, frequency) in fit.log10_foveal.into_iter().zip([4.0, 8.0, 16.0, 32.0]) {
            assert_eq!(fit.log10_foveal(frequency), log10);
        }
        assert!((fit.log10_foveal(64.0) - LOG10_UNSEEN).abs() < 1e-4);
        assert_eq!(fit.log10_foveal(0.0), fit.log10_foveal[0]);
    }
}

#[test]
fn without_a_number_nothing_is_hidden() {
    assert_eq!(sensitivity(f32::NAN, f32::NAN, f32::NAN), sensitivity(4.0, 0.0, 100.0));
    assert!(sensitivity(0.0, 120.0, 0.0) > 1e4);
}
