//! The scores as a table for people and as rows.

use super::path::DISTANCES_M;
use super::score::Radius::{self, Fixed, Inflated};
use super::score::{Method, follow, foveal_radii_deg};
use super::tracker::TrackerModel;
use super::{DURATION_S, SEEDS};
use std::fmt::Write;

/// One figure.
#[derive(Clone, Debug)]
pub struct Row {
    /// Tracker and method, e.g. "120 Hz, GazeTracker".
    pub case: String,
    /// The metric, e.g. "hits".
    pub metric: String,
    /// The figure.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// The baseline, in the same unit, if there is one.
    pub baseline: Option<f64>,
}

/// Units of the columns: degrees, percent, square degrees, parts, milliseconds.
const HEAD: &str = "\
Gaze with known truth: fixations, saccades of 2 to 30 degrees and pursuit, at things 0.3, 0.5, 1 m and infinitely far away, by a
tracker that is 50 ms late, 1.1 degrees off in each fixation and scatters by 0.3; slower than 60 Hz it is outside of the aims.
error: median, degrees, between the eyes; hits: share of fixation and pursuit in which each eye's gaze is in the region at full rate,
from 50 ms, a sample and a frame after landing on, and from landing on; area: mean, square degrees, of the safety' region (5 + 1.1
degrees, inflated), and as a part of a perfect tracker's with that radius and with 5 degrees; of the least such region with 99 and 99.9 % hits,
inflated and with a fixed radius; late: from landing after 12 degrees or more to the region, ms, median and 95 %.

gaze                               error   hits %   landed   area   ratio (5)     99 %  99.9 %  99 %f 99.9%f  late  95 %
";

/// Rates of trackers that the aims hold for, and slower ones, Hz.
pub const RATES_HZ: [f64; 6] = [120.0, 90.0, 60.0, 45.0, 30.0, 15.0];

/// All figures.
pub fn rows() -> Vec<Row> {
    let models = RATES_HZ.map(|rate_hz| TrackerModel { rate_hz, tells_time: true });
    let without_times = TrackerModel { rate_hz: 60.0, tells_time: false };
    models
        .into_iter()
        .flat_map(|model| rows_of(model, &Method::ALL))
        .chain(rows_of(without_times, &[Method::Tracker]))
        .collect()
}

fn rows_of(model: TrackerModel, methods: &[Method]) -> Vec<Row> {
    let [base, perfect_base] = foveal_radii_deg();
    let scores: Vec<_> =
        methods.iter().map(|method| (method, follow(*method, model, &SEEDS, DURATION_S))).collect();
    let mut rows = Vec::new();
    for (method, score) in scores {
        let mut row = |metric: &str, value: f64, unit: &'static str, baseline: Option<f64>| {
            let times = if model.tells_time { "" } else { ", no times" };
            let case = format!("{} Hz, {}{times}", model.rate_hz, method.name());
            rows.push(Row { case, metric: metric.to_owned(), value, unit, baseline });
        };
        row("median error", score.median_error_deg(), "deg", None);
        row("hits", score.hits(Inflated(base)), "share", None);
        row("hits from landing", score.hits_from_landing(Inflated(base)), "share", None);
        for (number, distance) in DISTANCES_M.into_iter().enumerate() {
            row(&format!("hits at {distance} m"), score.hits_at(Inflated(base), number), "share", None);
        }
        let area = score.area_deg2(Inflated(base));
        row("area", area, "deg^2", Some(score.perfect_area_deg2(base)));
        row("area beside that without error", area, "deg^2", Some(score.perfect_area_deg2(perfect_base)));
        row("refined after landing, median", 1e3 * score.late_s(0.5), "ms", None);
        row("refined after landing, 95 %", 1e3 * score.late_s(0.95), "ms", None);
        for (hits, name) in [(0.99, "99 %"), (0.999, "99.9 %")] {
            let best = |kind: fn(f64) -> Radius| score.area_deg2(score.radius_for(hits, kind));
            row(&format!("area at {name} hits"), best(Inflated), "deg^2", None);
            row(&format!("area at {name} hits, fixed radius"), best(Fixed), "deg^2", None);
        }
    }
    rows
}

/// The rows as a table: a line for each tracker and method.
pub fn table(rows: &[Row]) -> String {
    let mut out = HEAD.to_owned();
    let mut rest = rows;
    while let Some(first) = rest.first() {
        let count = rest.iter().take_while(|row| row.case == first.case).count();
        let (case, others) = rest.split_at(count);
        rest = others;
        let row = |metric: &str| case.iter().find(|row| row.metric == metric);
        let value = |metric: &str| row(metric).map_or(f64::NAN, |row| row.value);
        let ratio =
            |metric: &str| row(metric).and_then(|row| Some(row.value / row.baseline?)).unwrap_or(f64::NAN);
        let line = format!(
            "{:<34} {:>5.2} {:>8.3} {:>8.3} {:>6.0} {:>5.2} {:>5.2} {:>6.0} {:>6.0} {:>6.0} {:>6.0} {:>5.0} {:>5.0}",
            first.case,
            value("median error"),
            100.0 * value("hits"),
            100.0 * value("hits from landing"),
            value("area"),
            ratio("area"),
            ratio("area beside that without error"),
            value("area at 99 % hits"),
            value("area at 99.9 % hits"),
            value("area at 99 % hits, fixed radius"),
            value("area at 99.9 % hits, fixed radius"),
            value("refined after landing, median"),
            value("refined after landing, 95 %"),
        );
        let _ = writeln!(out, "{line}");
    }
    out
}
