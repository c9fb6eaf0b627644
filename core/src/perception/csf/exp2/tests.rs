use super::exp2;

#[test]
fn close_to_double_precision_over_all_exponents() {
    let worst = (-125_999..=126_999)
        .map(|i| i as f32 * 1e-3)
        .map(|x| (f64::from(exp2(x)) / f64::from(x).exp2() - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(worst < 3e-7, "{worst:e}");
}

#[test]
fn bounded_outside_of_its_domain() {
    for (x, expected) in [
        (-126.0, -126),
        (f32::MIN, -126),
        (f32::NEG_INFINITY, -126),
        (f32::NAN, -126),
        (127.0, 127),
        (f32::MAX, 127),
        (f32::INFINITY, 127),
    ] {
        assert!((f64::from(exp2(x)) / f64::powi(2.0, expected) - 1.0).abs() < 3e-7, "{x}");
    }
}
