//! The figures as a table for people and as rows.

use super::{Case, Eyes, Gaze, Mean, Rates, Score, When, follow};
use crate::eyes::{TrackerErrors, TrackerModel};
use std::fmt::Write;

/// Seeds of the reported runs, and the length of each, seconds.
const SEEDS: [u64; 2] = [7, 19];
const DURATION_S: f64 = 21.0;

/// A case, and its scores.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: Case,
    /// Scores with rates that become coarser only some time after saccades, and with rates that become coarser at once.
    pub scores: [Score; 2],
}

/// The reported cases.
pub fn cases() -> Vec<Case> {
    let none = TrackerErrors::NONE;
    let usual = TrackerErrors::default();
    let poor = TrackerErrors { latency_s: 0.08, jitter_deg: 0.5, ..usual };
    let tracked = |rate_hz, tells_time, errors, depth| Gaze::Tracked {
        model: TrackerModel { rate_hz, tells_time },
        errors,
        depth,
    };
    let case = |name, eyes, gaze| Case { name, eyes, gaze, rates: Rates::Rings };
    let of_contrast = |name, gaze| Case { name, eyes: Eyes::Moving, gaze, rates: Rates::Contrast };
    vec![
        case("resting, true gaze, no safety limits", Eyes::Resting, Gaze::TrueWithoutSafety),
        case("resting, no error, depth known", Eyes::Resting, tracked(360.0, true, none, true)),
        case("resting, 120 Hz", Eyes::Resting, tracked(120.0, true, usual, false)),
        case("moving, true gaze, no safety limits", Eyes::Moving, Gaze::TrueWithoutSafety),
        case("moving, no error", Eyes::Moving, tracked(360.0, true, none, false)),
        case("moving, 120 Hz, depth known", Eyes::Moving, tracked(120.0, true, usual, true)),
        case("moving, 120 Hz", Eyes::Moving, tracked(120.0, true, usual, false)),
        case("moving, 60 Hz", Eyes::Moving, tracked(60.0, true, usual, false)),
        case("moving, 60 Hz, no times", Eyes::Moving, tracked(60.0, false, usual, false)),
        case("moving, 30 Hz, 80 ms, 0.5 degrees", Eyes::Moving, tracked(30.0, true, poor, false)),
        of_contrast("contrast, moving, no error", tracked(360.0, true, none, false)),
        of_contrast("contrast, moving, 120 Hz", tracked(120.0, true, usual, false)),
    ]
}

/// All figures; both ways by the same scripts.
pub fn rows() -> Vec<Row> {
    let scores = |case: &Case| [false, true].map(|at_once| follow(case, at_once, &SEEDS, DURATION_S));
    cases().into_iter().map(|case| Row { scores: scores(&case), case }).collect()
}

const HEAD: &str = "\
What the safety limits cost, and what is lost at the true gaze: views of 1024 pixels and 104 degrees, tiles of 32, rings of paper A's
baseline, uniform contrast; trackers are 50 ms late, 1.1 degrees off in each fixation and scatter by 0.3 unless said otherwise. Each
figure twice: nothing becomes coarser in saccades and for 60 ms after landing > at once. Shaded: invocations for each pixel. Lost: mean
loss of visible contrast within 12 degrees of the true gaze, thousandths of a just noticeable difference, in flight, within 60 ms after landing, and later.

gaze                                  shaded           lost: in flight      landing         later
";

/// The figures as text.
pub fn table(rows: &[Row]) -> String {
    let mut out = HEAD.to_owned();
    for Row { case, scores } in rows {
        let [before, after] = scores.each_ref().map(|score| score.all.share());
        // Writing to a string does not fail.
        let _ = write!(out, "{:<36} {before:>6.3} > {after:.3}", case.name);
        for when in When::ALL {
            let lost = |score: &Score| 1e3 * Mean::central_loss(&score.when[when as usize]);
            let [before, after] = scores.each_ref().map(lost);
            if before.is_nan() {
                let _ = write!(out, "  {:>15}", "-");
            } else {
                let _ = write!(out, "  {before:>6.1} > {after:<6.1}");
            }
        }
        let _ = writeln!(out);
    }
    out
}
