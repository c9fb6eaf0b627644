//! The bench `overhead` runs, and prints its figures.

use parafovea_tests::overhead::{Effort, Figure, hello_xr, recording};

fn assert_complete(figures: &[Figure]) {
    let cases: Vec<&str> = figures.iter().map(|figure| figure.case).collect();
    assert_eq!(cases, ["none", "pass_through", "inert", "on"]);
    for figure in figures {
        assert!(figure.value > 0.0 && figure.ratio > 0.0, "{figure:?}");
        assert_eq!(figure.baseline, figures[0].value);
    }
}

#[test]
fn of_a_frame_of_hello_xr() {
    assert_complete(&hello_xr(Effort::LEAST).unwrap());
}

#[test]
fn of_ten_thousand_draws_in_fifty_passes() {
    let figures = recording(Effort::LEAST).unwrap();
    // Recording and submit, of two styles, with and without OpenXR.
    assert_eq!(figures.len(), 2 * 2 * 2 * 4);
    figures.chunks(4).for_each(assert_complete);
}
