use super::*;

fn gain_of(kernel: &Kernel, hz: f64) -> f64 {
    let taps: Vec<f64> = kernel.taps.iter().map(|&tap| f64::from(tap)).collect();
    gain(&taps, hz / 90.0)
}

/// castleCSF's published responses, written independently: exp(-w^1.3314 / 10.5795) and
/// exp(-(w^0.1898 - w0^0.1898)^2 / 0.0844836) with w0 = 4.7036 + 2.41482 log10 L.
#[test]
fn filters_have_the_gains_of_castle_csf() {
    let responses = Responses::new(90.0, 30.0);
    let peak = 4.7036 + 2.41482 * 30f64.log10();
    assert!((f64::from(responses.peak_hz) - peak).abs() < 0.07, "{} {peak}", responses.peak_hz);
    for hz in [0.0_f64, 2.0, 4.0, 8.0, 15.0, 25.0, 40.0] {
        let sustained = (-hz.powf(1.3314) / 10.5795).exp();
        let transient = (-(hz.powf(0.1898) - peak.powf(0.1898)).powi(2) / 0.0844836).exp();
        assert!((gain_of(&responses.sustained, hz) - sustained).abs() < 0.1, "sustained at {hz} Hz");
        assert!((gain_of(&responses.transient, hz) - transient).abs() < 0.03, "transient at {hz} Hz");
    }
    assert!(gain_of(&responses.transient, 0.0).abs() < 1e-6);
}

#[test]
fn ends_go_on_for_ever() {
    let responses = Responses::new(90.0, 30.0);
    let frames = [[3.0_f32]; 4];
    let mut sum = [0.0];
    responses.sustained.filter(4, 1, &mut sum, |frame| &frames[frame]);
    assert!((sum[0] - 3.0).abs() < 1e-5);
    responses.transient.filter(4, 3, &mut sum, |frame| &frames[frame]);
    assert!(sum[0].abs() < 1e-5);
}
