use super::*;
use parafovea_core::avpm::PAPER;
use proptest::prelude::*;

fn entry(gamma_ld: f32, gamma_fq_kilomel: f32, gamma_vis: f32, mu: f32) -> Entry {
    Entry { gamma_ld, gamma_fq_kilomel, gamma_vis, mu }
}

/// Features that vary independently, with the scores that `score` gives.
fn study(score: impl Fn(f32, f32, f32) -> f32) -> Vec<Entry> {
    let mut entries = Vec::new();
    for gamma_ld in [2.0, 9.0, 23.0] {
        for gamma_fq in [1.0, 1.4, 2.4] {
            for gamma_vis in [0.0, 8_000.0, 25_000.0] {
                entries.push(entry(gamma_ld, gamma_fq, gamma_vis, score(gamma_ld, gamma_fq, gamma_vis)));
            }
        }
    }
    entries
}

#[test]
fn coefficients_are_found_again() {
    let fit = fit(&study(|ld, fq, vis| PAPER.score(ld, fq, vis))).unwrap();
    let [found, expected] = [fit.coefficients, PAPER].map(|c| [c.a, c.b, c.c, c.d]);
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-5, "{found}, not {expected}");
    }
    assert_eq!((fit.held_at_zero, fit.rows), ([false; 4], 27));
    assert!(fit.rmse < 1e-6 && fit.r_squared > 0.999_999, "{fit:?}");
}

#[test]
fn a_study_in_which_higher_sounds_are_liked_has_b_held_at_zero() {
    let fit = fit(&study(|ld, fq, vis| 3.0 + 0.03 * ld + 0.2 * fq - 1e-5 * vis)).unwrap();
    assert_eq!(fit.held_at_zero, [false, true, false, false]);
    assert_eq!(fit.coefficients.b, 0.0);
    assert!((fit.coefficients.a - 0.03).abs() < 1e-5 && (fit.coefficients.c - 0.1).abs() < 1e-5);
    // The mean of 0.2 gamma_fq goes into d, and its spread remains as the error.
    assert!((fit.coefficients.d - 3.32).abs() < 1e-5 && (fit.rmse - 0.117_757).abs() < 1e-5, "{fit:?}");
    assert!(fit.r_squared > 0.5 && fit.r_squared < 1.0);
    // The rest still makes a budget.
    assert!(fit.coefficients.alpha(10.0, 1.0) > 0.0);
}

#[test]
fn a_study_in_which_loss_costs_nothing_gives_no_budget() {
    let fit = fit(&study(|ld, fq, vis| PAPER.score(ld, fq, -vis))).unwrap();
    assert!(fit.held_at_zero[2]);
    assert_eq!(fit.coefficients.alpha(10.0, 1.0), 0.0);
}

#[test]
fn scores_that_do_not_vary_are_not_explained() {
    let fit = fit(&study(|_, _, _| 4.0)).unwrap();
    assert!((fit.coefficients.d - 4.0).abs() < 1e-5 && fit.rmse < 1e-6);
    assert_eq!(fit.r_squared, 0.0);
}

#[test]
fn identical_features_count_once() {
    let once = study(|ld, fq, vis| PAPER.score(ld, fq, vis) + ld * fq * 0.01);
    // The first entry a hundred times, around the same mean.
    let around =
        |i: usize| Entry { mu: once[0].mu + if i.is_multiple_of(2) { 0.5 } else { -0.5 }, ..once[0] };
    let often: Vec<Entry> = once[1..].iter().copied().chain((0..100).map(around)).collect();
    let (once, often) = (fit(&once).unwrap(), fit(&often).unwrap());
    assert_eq!(often.rows, 27);
    assert!((once.coefficients.a - often.coefficients.a).abs() < 1e-6);
    assert!((once.rmse - often.rmse).abs() < 1e-6);
}

#[test]
fn too_few_entries_are_an_error() {
    let three = [entry(1.0, 1.0, 0.0, 3.0), entry(5.0, 1.5, 9.0, 4.0), entry(9.0, 2.0, 1.0, 5.0)];
    assert_eq!(fit(&[]), Err(FitError::TooFewRows { found: 0 }));
    let repeated = [three, three].concat();
    assert_eq!(fit(&repeated), Err(FitError::TooFewRows { found: 3 }));
    assert_eq!(
        fit(&three).unwrap_err().to_string(),
        "3 entries with different features; 4 coefficients need at least as many"
    );
}

#[test]
fn features_that_cannot_be_told_apart_are_named() {
    let silent_loss: Vec<Entry> = study(|ld, fq, _| PAPER.score(ld, fq, 0.0))
        .into_iter()
        .map(|e| Entry { gamma_vis: 0.0, ..e })
        .collect();
    let error = fit(&silent_loss).unwrap_err();
    assert_eq!(error, FitError::Constant { features: vec![Feature::VisualLoss], rank: 3 });
    assert_eq!(
        error.to_string(),
        "visual loss (gamma_vis) never vary, so their weight cannot be determined (rank 3 of 4)"
    );
    let loudness_only: Vec<Entry> =
        (0..9).map(|i| entry(i as f32, 1.5, 700.0, 3.0 + i as f32 * 0.1)).collect();
    assert_eq!(
        fit(&loudness_only),
        Err(FitError::Constant { features: vec![Feature::Frequency, Feature::VisualLoss], rank: 2 })
    );
    let together: Vec<Entry> =
        (1..9).map(|i| entry(i as f32, 1.0 + 0.1 * i as f32, 1000.0 * i as f32, 3.0)).collect();
    assert_eq!(fit(&together), Err(FitError::Dependent { rank: 3 }));
}

#[test]
fn entries_that_are_no_numbers_are_an_error_with_their_index() {
    for bad in [
        entry(f32::NAN, 1.0, 0.0, 3.0),
        entry(1.0, 0.0, 0.0, 3.0),
        entry(1.0, -1.0, 0.0, 3.0),
        entry(1.0, 1.0, f32::INFINITY, 3.0),
        entry(1.0, 1.0, 0.0, f32::NEG_INFINITY),
    ] {
        let entries: Vec<Entry> = study(|_, _, _| 3.0).into_iter().chain([bad]).collect();
        assert_eq!(fit(&entries), Err(FitError::NotFinite { index: 27 }));
    }
}

proptest! {
    #[test]
    fn any_entries_give_an_answer(
        numbers in prop::collection::vec(prop::array::uniform4(prop::num::f32::POSITIVE), 0..12),
    ) {
        let entries: Vec<Entry> = numbers.iter().map(|&[a, b, c, d]| entry(a, b, c, d)).collect();
        if let Ok(fit) = fit(&entries) {
            let Coefficients { a, b, c, d } = fit.coefficients;
            prop_assert!([a, b, c, d].iter().all(|x| *x >= 0.0), "{:?}", fit);
            prop_assert!(!fit.rmse.is_nan() && fit.r_squared <= 1.0);
        }
    }
}
