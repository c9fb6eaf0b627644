//! Hard cases of `avpm` and `frco`.

use super::Case;
use crate::avpm::fit::{Fit, FitError, fit};
use crate::avpm::study::Entry;
use crate::reference::avpm as reference;
use parafovea_core::audio::{AudioSettings, gamma_ld};
use parafovea_core::avpm::{Budget, BudgetSettings, PAPER, SilenceRule};
use parafovea_core::frco::{coarsest, loss};
use parafovea_core::perception::BANDS;
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};

/// 2x2 loses 8, 4x4 loses 12.
const BAND_SENSITIVITY: [f32; BANDS] = [8.0, 4.0, 2.0, 1.0];

pub(super) fn cases() -> Vec<Case> {
    [rates(), budgets(), studies()].concat()
}

fn case(model: &'static str, case: &str, expected: &str, got: String, error: Option<f64>) -> Case {
    Case { model, case: case.to_owned(), expected: expected.to_owned(), passed: got == expected, got, error }
}

fn rates() -> Vec<Case> {
    let with = |bands: [f32; BANDS], alpha: f32, name: &str, expected: &str| {
        let rate = coarsest(bands, alpha, &VULKAN_RATES);
        let got = format!("{}x{}", rate.width(), rate.height());
        let lost = f64::from(loss(bands, rate));
        let exact = reference::loss(&bands.map(f64::from), rate.fraction().into());
        // A result that is not a number has no error either.
        let error = Some((lost - exact).abs()).filter(|error| error.is_finite());
        case("frco", name, expected, got, error)
    };
    let contrast = BAND_SENSITIVITY;
    let huge = f32::MAX / 4.0;
    vec![
        with(contrast, -1.0, "alpha negative", "1x1"),
        with(contrast, f32::NAN, "alpha NaN", "1x1"),
        with(contrast, f32::INFINITY, "alpha infinite", "1x1"),
        with(contrast, 0.0, "alpha 0", "1x1"),
        with([0.0; BANDS], 0.0, "alpha 0 where there is no contrast", "4x4"),
        with(contrast, 8.0, "alpha tied with the loss of 2x2", "2x2"),
        with(contrast, 8.0f32.next_down(), "alpha one step below that", "2x1"),
        with(contrast, 12.0, "alpha tied with the loss of 4x4", "4x4"),
        with([8.0, f32::NAN, 2.0, 1.0], 1e9, "a band NaN", "1x1"),
        with([8.0, 4.0, 2.0, f32::INFINITY], 1e9, "the coarsest band infinite", "1x1"),
        with([huge; BANDS], huge, "bands and alpha near the end of f32", "2x2"),
        with([1e-40, 1e-40, 0.0, 0.0], 1e-40, "bands and alpha denormal", "2x2"),
        case(
            "frco",
            "no rates to choose from",
            "1x1",
            {
                let rate = coarsest(contrast, 1e9, &[]);
                assert_eq!(rate, ShadingRate::R1X1);
                format!("{}x{}", rate.width(), rate.height())
            },
            None,
        ),
    ]
}

fn budgets() -> Vec<Case> {
    let paper = BudgetSettings::PAPER;
    let default = BudgetSettings::default();
    let with = |settings: BudgetSettings,
                features: (f32, f32, bool),
                name: &str,
                expected: &str,
                exact: Option<f64>| {
        let budget = settings.budget(features.0, features.1, features.2);
        let (got, error) = match budget {
            Budget::Alpha(alpha) => {
                (format!("alpha {alpha:.3e}"), exact.map(|exact| (f64::from(alpha) - exact).abs()))
            }
            Budget::FixedFoveation => ("fixed foveation".to_owned(), None),
        };
        case("avpm", name, expected, got, error)
    };
    let alpha = |gamma_ld, gamma_fq| Some(reference::alpha(reference::PAPER, 3.63, gamma_ld, gamma_fq));
    let own_alpha = BudgetSettings { silence: SilenceRule::Alpha(0.25), ..default };
    let free_loss =
        BudgetSettings { coefficients: parafovea_core::avpm::Coefficients { c: 0.0, ..PAPER }, ..paper };
    let strict = BudgetSettings { threshold: 6.0, ..paper };
    vec![
        with(default, (0.0, 0.0, true), "silence, default rule", "fixed foveation", None),
        with(paper, (0.0, 0.0, true), "silence, strict rule", "alpha 0.000e0", Some(0.0)),
        with(own_alpha, (0.0, 0.0, true), "silence, silence_alpha 0.25", "alpha 2.500e-1", Some(0.25)),
        with(default, (12.0, 0.0, false), "gamma_fq 0", "fixed foveation", None),
        with(default, (f32::NAN, 1.5, false), "gamma_ld NaN", "fixed foveation", None),
        with(default, (12.0, f32::NAN, false), "gamma_fq NaN", "fixed foveation", None),
        with(
            paper,
            (12.0, f32::INFINITY, false),
            "gamma_fq infinite, strict rule",
            "alpha 0.000e0",
            Some(0.0),
        ),
        with(
            paper,
            (f32::MAX, 1.5, false),
            "gamma_ld huge: its upper end",
            "alpha 8.158e4",
            alpha(25.0, 1.5),
        ),
        with(paper, (0.0, 0.0785, false), "a bass of 50 Hz: 1 kilo-mel", "alpha 2.368e4", alpha(0.0, 1.0)),
        with(
            paper,
            (0.0, f32::MAX, false),
            "gamma_fq huge: its upper end",
            "alpha 9.304e3",
            alpha(0.0, 2.5457),
        ),
        with(
            paper,
            (gamma_ld(f32::NEG_INFINITY, &AudioSettings::default()), 1.0, false),
            "-infinity LUFS, not called silent",
            "alpha 2.368e4",
            alpha(0.0, 1.0),
        ),
        with(free_loss, (12.0, 1.5, false), "c = 0", "alpha 0.000e0", Some(0.0)),
        with(
            strict,
            (25.0, 1.0, false),
            "a threshold that nothing reaches",
            "alpha -3.526e4",
            Some(reference::alpha(reference::PAPER, 6.0, 25.0, 1.0)),
        ),
    ]
}

fn studies() -> Vec<Case> {
    let with = |rows: &[[f32; 4]], name: &str, expected: &str| {
        let entry = |&[gamma_ld, gamma_fq_kilomel, gamma_vis, mu]: &[f32; 4]| Entry {
            gamma_ld,
            gamma_fq_kilomel,
            gamma_vis,
            mu,
        };
        let entries: Vec<Entry> = rows.iter().map(entry).collect();
        let fitted = fit(&entries);
        let got = fitted.as_ref().map_or_else(named, describe);
        let error = fitted.ok().map(|fit| difference(&entries, &fit));
        case("avpm fit", name, expected, got, error)
    };
    let three = [[2.0, 1.2, 0.0, 3.0], [9.0, 1.4, 1e4, 4.0], [20.0, 2.0, 2e4, 4.5]];
    vec![
        with(&[], "no rows", "0 rows"),
        with(&three, "three rows", "3 rows"),
        with(
            &[three[0], three[1], three[2], [20.0, 2.0, 2e4, 4.0]],
            "four rows, two of them alike",
            "3 rows",
        ),
        with(
            &[
                [2.0, 1.2, 0.0, 3.0],
                [9.0, 1.4, 0.0, 4.0],
                [20.0, 2.0, 0.0, 4.5],
                [5.0, 1.7, 0.0, 4.0],
                [6.0, 1.1, 0.0, 4.0],
            ],
            "visual loss never varies",
            "rank 3: visual loss (gamma_vis)",
        ),
        with(
            &[[2.0, 1.5, 0.0, 3.0], [9.0, 1.5, 0.0, 4.0], [20.0, 1.5, 0.0, 4.5], [5.0, 1.5, 0.0, 4.0]],
            "only loudness varies",
            "rank 2: frequency (gamma_fq), visual loss (gamma_vis)",
        ),
        with(
            &[[2.0, 1.2, 2e3, 3.0], [9.0, 1.4, 9e3, 4.0], [20.0, 2.0, 2e4, 4.5], [5.0, 1.1, 5e3, 4.0]],
            "visual loss follows loudness",
            "rank 3",
        ),
        // 3 + 0.05 gamma_ld + 0.4 gamma_fq - gamma_vis / 1e5: higher sounds are liked.
        with(
            &[
                [2.0, 1.0, 0.0, 3.5],
                [2.0, 1.0, 2e4, 3.3],
                [2.0, 2.0, 0.0, 3.9],
                [2.0, 2.0, 2e4, 3.7],
                [20.0, 1.0, 0.0, 4.4],
                [20.0, 1.0, 2e4, 4.2],
                [20.0, 2.0, 0.0, 4.8],
                [20.0, 2.0, 2e4, 4.6],
            ],
            "higher sounds are liked: b held",
            "a .050 b .000 c .100 d 3.600",
        ),
        with(
            &[
                [2.0, 1.0, 0.0, 4.0],
                [9.0, 2.0, 1e4, 4.0],
                [20.0, 1.5, 2e4, 4.0],
                [3.0, 1.2, 5e3, 4.0],
                [5.0, 2.0, 0.0, 4.0],
            ],
            "scores all the same",
            "a .000 b .000 c .000 d 4.000",
        ),
        with(&[[2.0, 1.2, 0.0, f32::NAN]], "a score NaN", "entry 0"),
        with(&[[2.0, 0.0, 0.0, 3.0]], "gamma_fq 0", "entry 0"),
        with(&[[2.0, 1.0, f32::INFINITY, 3.0]], "gamma_vis infinite", "entry 0"),
    ]
}

fn named(error: &FitError) -> String {
    match error {
        FitError::NotFinite { index } => format!("entry {index}"),
        FitError::TooFewRows { found } => format!("{found} rows"),
        FitError::Constant { features, rank } => {
            let names: Vec<String> = features.iter().map(ToString::to_string).collect();
            format!("rank {rank}: {}", names.join(", "))
        }
        FitError::Dependent { rank } => format!("rank {rank}"),
    }
}

fn describe(fit: &Fit) -> String {
    let c = fit.coefficients;
    let short = |value: f32| format!("{value:.3}").replace("0.", ".");
    format!("a {} b {} c {} d {}", short(c.a), short(c.b), short(c.c), short(c.d))
}

/// Greatest difference of a coefficient from the reference's.
fn difference(entries: &[Entry], fit: &Fit) -> f64 {
    let rows: Vec<[f64; 4]> = entries
        .iter()
        .map(|e| [e.gamma_ld.into(), 1.0 / f64::from(e.gamma_fq_kilomel), -f64::from(e.gamma_vis) / 1e4, 1.0])
        .collect();
    let scores: Vec<f64> = entries.iter().map(|entry| entry.mu.into()).collect();
    let expected = reference::non_negative_least_squares(&rows, &scores);
    let c = fit.coefficients;
    let found = [c.a, c.b, c.c, c.d];
    found
        .into_iter()
        .zip(expected)
        .map(|(found, expected)| (f64::from(found) - expected).abs())
        .fold(0.0, f64::max)
}
