//! The errors as a table for people and as rows.

use super::before::before;
use super::errors::{DELAYS_MS, Frames, Predictor, RATES_HZ, SEEDS, measure};
use std::fmt::Write;

/// Errors with one tracker, degrees.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Samples a second.
    pub rate_hz: f64,
    /// From the eye to the image, milliseconds.
    pub delay_ms: f64,
    /// Mean error of the newest sample around saccades.
    pub newest_sample_deg: f64,
    /// Mean errors of the tracker, in the order of [`Frames::ALL`].
    pub tracker_deg: [f64; 4],
    /// The same as the committed table has them of the tracker before; NaN where it has none, or of other eye movements.
    pub before_deg: [f64; 4],
}

const HEAD: &str = "\
Mean angle from the gaze of a frame to where the eyes look when it is shown, degrees, at 90 frames a second, by a tracker that scatters
by 0.3 degrees and says when its samples were taken: of its newest sample, of the tracker before and of the tracker now. Around saccades:
from their beginning until 100 ms after landing; told: those of them for which a sample is known from 10 ms or more after the beginning.

| Hz | late, ms | saccades: sample | before | now | ratio | told: before | now | ratio | fixations: before | now | ratio | pursuits: before | now | ratio |
|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|
";

/// All errors.
pub fn rows() -> Vec<Row> {
    RATES_HZ.into_iter().flat_map(|rate_hz| DELAYS_MS.map(|delay_ms| row(rate_hz, delay_ms))).collect()
}

fn row(rate_hz: f64, delay_ms: f64) -> Row {
    let of = |predictor| measure(predictor, rate_hz, delay_ms, &SEEDS);
    let newest_sample_deg = of(Predictor::NewestSample).mean_deg(Frames::Saccades);
    let tracker = of(Predictor::Tracker);
    let before = before(rate_hz, delay_ms)
        .filter(|before| (before.newest_sample_deg - newest_sample_deg).abs() < 0.001);
    Row {
        rate_hz,
        delay_ms,
        newest_sample_deg,
        tracker_deg: Frames::ALL.map(|frames| tracker.mean_deg(frames)),
        before_deg: before.map_or([f64::NAN; 4], |before| before.tracker_deg),
    }
}

/// The rows as a table, in Markdown.
pub fn table(rows: &[Row]) -> String {
    let mut out = HEAD.to_owned();
    for row in rows {
        // Writing to a String cannot fail.
        let _ = write!(out, "| {} | {} | {:.3} |", row.rate_hz, row.delay_ms, row.newest_sample_deg);
        for (now, before) in row.tracker_deg.into_iter().zip(row.before_deg) {
            let _ = write!(out, " {before:.3} | {now:.3} | {:.2} |", now / before);
        }
        out.push('\n');
    }
    out
}
