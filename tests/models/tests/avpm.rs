//! The audio-visual perception model against paper A's Table 1 and against double precision.

use parafovea_core::audio::{self, AudioSettings, mel_of_hz};
use parafovea_core::avpm::{Budget, BudgetSettings, PAPER};
use parafovea_core::frco;
use parafovea_core::rate::VULKAN_RATES;
use parafovea_models::avpm::fit::fit;
use parafovea_models::avpm::least_squares::non_negative;
use parafovea_models::avpm::study::Entry;
use parafovea_models::checks::{Tuple, checks};
use parafovea_models::reference::avpm as reference;
use proptest::prelude::*;

/// Number of rows of Table 1 for each condition: L1-C2, L1-C3, L2-C1, L2-C2, L3-C1.
const CONDITIONS: [usize; 5] = [16, 8, 11, 6, 5];

fn gamma_ld(lufs: f32) -> f32 {
    audio::gamma_ld(lufs, &AudioSettings::default())
}

fn gamma_fq_kilomel(hz: f32) -> f32 {
    audio::gamma_fq(Some(mel_of_hz(hz.into())))
}

fn table() -> Vec<Tuple> {
    checks().audio_visual.table1
}

/// Root mean square of the differences and coefficient of determination.
fn quality(table: &[Tuple], predicted: &[f64]) -> (f64, f64) {
    let count = table.len() as f64;
    let mean = table.iter().map(|tuple| tuple.mu).sum::<f64>() / count;
    let spread: f64 = table.iter().map(|tuple| (tuple.mu - mean).powi(2)).sum();
    let left: f64 = table.iter().zip(predicted).map(|(tuple, score)| (tuple.mu - score).powi(2)).sum();
    ((left / count).sqrt(), 1.0 - left / spread)
}

fn near(got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "{got}, expected {expected}");
}

#[test]
fn table_1_is_reproduced() {
    let table = table();
    assert_eq!(table.len(), 46);
    for tuple in table {
        let (ld, fq) = (gamma_ld(tuple.lufs as f32), gamma_fq_kilomel(1000.0 * tuple.khz as f32));
        near(ld.into(), tuple.gld, 1e-4);
        near(fq.into(), tuple.gfq, 1e-4);
        near(PAPER.score(ld, fq, 0.0).into(), tuple.avpm0, 1e-4);
        near(f64::from(PAPER.alpha(ld, fq)) / tuple.alpha, 1.0, 1e-4);
        // The reference, to the vectors' last digits.
        let (ld, fq) = (reference::gamma_ld(tuple.lufs, -35.0), reference::mel(1000.0 * tuple.khz) / 1000.0);
        near(reference::score(reference::PAPER, ld, fq, 0.0), tuple.avpm0, 1e-12);
        near(reference::alpha(reference::PAPER, 3.63, ld, fq) / tuple.alpha, 1.0, 1e-12);
    }
}

#[test]
fn the_papers_own_scores_are_near() {
    for (lufs, khz, computed, printed) in
        [(-18.54, 5.42, 4.637, 4.65), (-18.32, 5.32, 4.650, 4.63), (-31.46, 5.05, 3.997, 3.98)]
    {
        let score = f64::from(PAPER.score(gamma_ld(lufs), gamma_fq_kilomel(1000.0 * khz), 0.0));
        near(score, computed, 5e-4);
        near(score, printed, 0.021);
    }
}

/// Test of the units that the paper leaves open: `ITU_min` and the unit of gamma_fq.
#[test]
fn the_units_are_those_that_stay_on_the_scale_of_scores() {
    let table = table();
    let hz = |tuple: &Tuple| 1000.0 * tuple.khz;
    type Unit = fn(f64) -> f64;
    let units: [(&str, Unit); 4] = [
        ("Hz", |hz| hz),
        ("mel", reference::mel),
        ("kilo-mel", |hz| reference::mel(hz) / 1000.0),
        ("kHz", |hz| hz / 1000.0),
    ];
    // RMSE, R^2, and by how much the 15 quiet and well liked items are liked better than predicted, which visual loss
    // (negative: there is some) would have to explain.
    let expected = [
        (
            -70.0,
            [
                (2.651, -15.91, -1.646),
                (2.651, -15.91, -1.646),
                (2.873, -18.87, -1.865),
                (2.787, -17.70, -1.773),
            ],
        ),
        (
            -35.0,
            [
                (1.111, -1.972, 0.104),
                (1.111, -1.972, 0.104),
                (1.287, -2.986, -0.115),
                (1.218, -2.572, -0.023),
            ],
        ),
    ];
    for (itu_min, by_unit) in expected {
        for ((unit, convert), (rmse, r_squared, bias)) in units.iter().zip(by_unit) {
            let score = |tuple: &Tuple| {
                let ld = reference::gamma_ld(tuple.lufs, itu_min);
                reference::score(reference::PAPER, ld, convert(hz(tuple)), 0.0)
            };
            let predicted: Vec<f64> = table.iter().map(score).collect();
            let (found_rmse, found_r_squared) = quality(&table, &predicted);
            near(found_rmse, rmse, 6e-4);
            near(found_r_squared, r_squared, 6e-3);
            let rests = table.iter().zip(&predicted).map(|(tuple, score)| (tuple, tuple.mu - score));
            let quiet: Vec<f64> = rests
                .filter(|(tuple, _)| tuple.lufs < -17.5 && tuple.mu > 3.9)
                .map(|(_, rest)| rest)
                .collect();
            assert_eq!(quiet.len(), 15);
            near(quiet.iter().sum::<f64>() / 15.0, bias, 6e-4);
            let greatest = predicted.iter().fold(0.0, |a: f64, b| a.max(*b));
            // Five points is the most that a participant could give; Table 1 itself reaches 4.65.
            assert_eq!(greatest > 5.2, itu_min == -70.0, "{unit}");
        }
    }
}

#[test]
fn the_visual_loss_that_fits_each_condition_best_leaves_half_unexplained() {
    let table = table();
    let mut predicted: Vec<f64> = table.iter().map(|tuple| tuple.avpm0).collect();
    let mut start = 0;
    let best = [2.77e4, 8.11e4, 2.03e4, 1.05e5, 9.98e4];
    for (count, best) in CONDITIONS.into_iter().zip(best) {
        let rows = start..start + count;
        let excess: f64 = rows.clone().map(|row| predicted[row] - table[row].mu).sum::<f64>() / count as f64;
        near(excess * 1e4 / 0.19 / best, 1.0, 5e-3);
        rows.for_each(|row| predicted[row] -= excess);
        start += count;
    }
    let (rmse, r_squared) = quality(&table, &predicted);
    near(rmse, 0.445, 5e-4);
    near(r_squared, 0.52, 5e-3);
}

/// No coefficients reproduce the paper's result from Table 1: even with an offset for each condition, frequency has no weight, and R^2
/// stays below the 0.80 that the paper has for its whole study.
#[test]
fn no_refit_of_table_1_explains_it() {
    let table = table();
    // Free offsets amount to centring each condition on its own means.
    let mut rows = Vec::new();
    let mut scores = Vec::new();
    let mut rest = &table[..];
    for count in CONDITIONS {
        let (condition, others) = rest.split_at(count);
        rest = others;
        let mean = |value: &dyn Fn(&Tuple) -> f64| condition.iter().map(value).sum::<f64>() / count as f64;
        let (ld, fq, mu) = (mean(&|t| t.gld), mean(&|t| 1.0 / t.gfq), mean(&|t| t.mu));
        rows.extend(condition.iter().map(|t| [t.gld - ld, 1.0 / t.gfq - fq]));
        scores.extend(condition.iter().map(|t| t.mu - mu));
    }
    assert!(rest.is_empty());
    let solution = non_negative(&rows, &scores).unwrap();
    let mean = table.iter().map(|tuple| tuple.mu).sum::<f64>() / 46.0;
    let spread: f64 = table.iter().map(|tuple| (tuple.mu - mean).powi(2)).sum();
    assert_eq!(solution.x[1], 0.0);
    near(1.0 - solution.residual / spread, 0.60, 5e-3);
}

/// Table 1 as a study, with the visual loss of each condition that fits it best.
fn study_of_table_1() -> Vec<Entry> {
    let visual_loss = [2.77e4, 8.11e4, 2.03e4, 1.05e5, 9.98e4];
    let conditions =
        visual_loss.into_iter().zip(CONDITIONS).flat_map(|(loss, n)| std::iter::repeat_n(loss, n));
    let entry = |(tuple, gamma_vis): (Tuple, f32)| Entry {
        gamma_ld: gamma_ld(tuple.lufs as f32),
        gamma_fq_kilomel: gamma_fq_kilomel(tuple.khz as f32 * 1000.0),
        gamma_vis,
        mu: tuple.mu as f32,
    };
    table().into_iter().zip(conditions).map(entry).collect()
}

#[test]
fn a_study_is_fitted_as_the_reference_does() {
    let entries = study_of_table_1();
    assert_eq!(entries.len(), 46);
    let fit = fit(&entries).unwrap();
    let (rows, scores): (Vec<_>, Vec<_>) = entries.iter().map(row).unzip();
    let expected = reference::non_negative_least_squares(&rows, &scores);
    let c = fit.coefficients;
    for (found, expected) in [c.a, c.b, c.c, c.d].into_iter().zip(expected) {
        near(found.into(), expected, 1e-5 * expected.max(1.0));
    }
    let predicted: Vec<f64> = entries
        .iter()
        .map(|e| reference::score(expected, e.gamma_ld.into(), e.gamma_fq_kilomel.into(), e.gamma_vis.into()))
        .collect();
    let (rmse, r_squared) = quality(&table(), &predicted);
    near(fit.rmse.into(), rmse, 1e-5);
    near(fit.r_squared.into(), r_squared, 1e-5);
}

/// A row of Eq. 13's X, and its score.
fn row(entry: &Entry) -> ([f64; 4], f64) {
    let visual_loss = f64::from(entry.gamma_vis) / 1e4;
    let row = [entry.gamma_ld.into(), 1.0 / f64::from(entry.gamma_fq_kilomel), -visual_loss, 1.0];
    (row, entry.mu.into())
}

proptest! {
    #[test]
    fn the_budget_equals_double_precision(lufs in -35.0f32..-10.0, hz in 1001.0f32..5999.0) {
        let Budget::Alpha(alpha) = BudgetSettings::PAPER.budget(gamma_ld(lufs), gamma_fq_kilomel(hz), false) else {
            return Err(TestCaseError::fail("sound gives a budget"));
        };
        let (ld, fq) = (reference::gamma_ld(lufs.into(), -35.0), reference::mel(hz.into()) / 1000.0);
        let expected = reference::alpha(reference::PAPER, 3.63, ld, fq);
        prop_assert!((f64::from(alpha) / expected - 1.0).abs() < 1e-6, "{} {}", alpha, expected);
    }

    #[test]
    fn loss_equals_double_precision(bands in prop::array::uniform4(0.0f32..1e6)) {
        for rate in VULKAN_RATES {
            let expected = reference::loss(&bands.map(f64::from), rate.fraction().into());
            let loss = f64::from(frco::loss(bands, rate));
            prop_assert!((loss - expected).abs() <= 1e-7 * expected, "{:?}: {} {}", rate, loss, expected);
        }
    }
}
