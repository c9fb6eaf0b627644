//! Lines of results, for programs.

use super::{Samples, Timing};
use parafovea_models::errors::Report;
use serde::Serialize;

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// `frame`, `break-even`, `gpu`, `report` or `status`.
    pub bench: &'static str,
    /// The scene.
    pub app: String,
    /// The technique.
    pub case: String,
    /// The metric; of errors also the ring, degrees from the true gaze.
    pub metric: String,
    /// Value of the metric.
    pub value: f64,
    /// The unit of `value` and `baseline`.
    pub unit: &'static str,
    /// Comparison with the first technique, if there is one.
    #[serde(flatten)]
    pub comparison: Option<Comparison>,
}

/// A figure beside that of the first technique, from the same turns.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Comparison {
    /// That of the first technique.
    pub baseline: f64,
    /// `value` / `baseline`; of times as [`Samples::ratio_to`] has it.
    pub ratio: f64,
    /// Half of the interquartile range of the turns' ratios, where there are turns.
    pub spread: Option<f64>,
}

/// Cost of a subject; the first of `timings` is the baseline.
pub fn rows(app: &str, timings: &[Timing]) -> Vec<Row> {
    let Some(baseline) = timings.first() else { return Vec::new() };
    timings.iter().flat_map(|timing| rows_of(app, timing, baseline)).collect()
}

/// Comparison of the layer of this build with that of another, whose timings have the same name followed by `@ other`.
pub fn against_rows(app: &str, other: &str, timings: &[Timing]) -> Vec<Row> {
    let pairs = timings.iter().filter_map(|timing| {
        let name = format!("{} @ {other}", timing.technique);
        Some((timing, timings.iter().find(|timing| timing.technique == name)?))
    });
    let is_of_both = |row: &Row| row.metric != "layer_cpu_median";
    pairs.flat_map(|(timing, other)| rows_of(app, timing, other)).filter(is_of_both).collect()
}

fn rows_of(app: &str, timing: &Timing, baseline: &Timing) -> Vec<Row> {
    let row = |metric: &str, unit, value: f64, baseline: f64| Row {
        bench: "frame",
        app: app.to_owned(),
        case: timing.technique.clone(),
        metric: metric.to_owned(),
        value,
        unit,
        comparison: Some(Comparison { baseline, ratio: value / baseline, spread: None }),
    };
    let median = |metric, own: &Samples, off: &Samples| {
        let ratio = own.ratio_to(off);
        let within_turns =
            Comparison { baseline: off.median(), ratio: ratio.value, spread: Some(ratio.spread) };
        Row { comparison: Some(within_turns), ..row(metric, "ms", own.median(), off.median()) }
    };
    let (cpu, cpu_off) = (&timing.cpu_ms, &baseline.cpu_ms);
    let mut rows = vec![
        median("cpu_median", cpu, cpu_off),
        row("cpu_p99", "ms", cpu.quantile(0.99), cpu_off.quantile(0.99)),
        row("cpu_worst", "ms", cpu.worst(), cpu_off.worst()),
        row("fragments", "invocations", timing.fragments as f64, baseline.fragments as f64),
    ];
    if !timing.gpu_ms.is_empty() {
        let (gpu, gpu_off) = (&timing.gpu_ms, &baseline.gpu_ms);
        rows.push(median("gpu_ms", gpu, gpu_off));
        rows.push(row("gpu_p99", "ms", gpu.quantile(0.99), gpu_off.quantile(0.99)));
        rows.push(row("gpu_worst", "ms", gpu.worst(), gpu_off.worst()));
    }
    if let (Some(samples), Some(baseline)) = (timing.samples, baseline.samples) {
        rows.push(row("samples", "samples", samples as f64, baseline as f64));
    }
    // Where the application shades as much as without the layer, all the difference is the layer's.
    if timing.with_layer && timing.fragments == baseline.fragments {
        let own = cpu.median() - cpu_off.median();
        rows.push(Row { comparison: None, ..row("layer_cpu_median", "ms", own, 0.0) });
    }
    rows
}

/// Errors of a technique; rings and metrics without a value are left out.
pub fn error_rows(app: &str, technique: &str, report: &Report) -> Vec<Row> {
    let row = |metric: String, unit, value| Row {
        bench: "frame",
        app: app.to_owned(),
        case: technique.to_owned(),
        metric,
        value,
        unit,
        comparison: None,
    };
    let both = report.rows.iter().flat_map(|error| {
        let name = |kind| format!("{} {kind} {}", error.metric.name(), error.ring);
        let mean = error.mean.map(|mean| row(name("mean"), error.unit, mean));
        let worst = error.worst_tile.map(|worst| row(name("worst tile"), error.unit, worst.value));
        [mean, worst]
    });
    both.flatten().collect()
}

/// One object a line.
pub fn print_json(rows: &[Row]) {
    for row in rows {
        match serde_json::to_string(row) {
            Ok(line) => println!("{line}"),
            Err(error) => eprintln!("{error}"),
        }
    }
}
