//! Lines of results, for people and for programs.

use super::Timing;
use serde::Serialize;

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// `frame`.
    pub bench: &'static str,
    /// The subject.
    pub app: String,
    /// The technique.
    pub case: String,
    /// What was measured.
    pub metric: &'static str,
    /// How much of it.
    pub value: f64,
    /// The unit of `value` and `baseline`.
    pub unit: &'static str,
    /// That of the first technique, from the same turns.
    pub baseline: f64,
    /// `value` / `baseline`; of times the median of the turns' ratios.
    pub ratio: f64,
    /// Half of the interquartile range of the turns' ratios, where there are turns.
    pub spread: Option<f64>,
}

/// The figures of one subject; the first of `timings` is the baseline.
pub fn rows(app: &str, timings: &[Timing]) -> Vec<Row> {
    let Some(baseline) = timings.first() else { return Vec::new() };
    timings.iter().flat_map(|timing| rows_of(app, timing, baseline)).collect()
}

fn rows_of(app: &str, timing: &Timing, baseline: &Timing) -> Vec<Row> {
    let row = |metric, unit, value: f64, baseline: f64| Row {
        bench: "frame",
        app: app.to_owned(),
        case: timing.technique.clone(),
        metric,
        value,
        unit,
        baseline,
        ratio: value / baseline,
        spread: None,
    };
    let (cpu, cpu_off) = (&timing.cpu_ms, &baseline.cpu_ms);
    let ratio = cpu.ratio_to(cpu_off);
    let mut rows = vec![
        Row {
            ratio: ratio.value,
            spread: Some(ratio.spread),
            ..row("cpu_median", "ms", cpu.median(), cpu_off.median())
        },
        row("cpu_p99", "ms", cpu.quantile(0.99), cpu_off.quantile(0.99)),
        row("cpu_worst", "ms", cpu.worst(), cpu_off.worst()),
        row("fragments", "invocations", timing.fragments as f64, baseline.fragments as f64),
    ];
    // Where the application shades as much as without the layer, all the difference is the layer's.
    if timing.with_layer && timing.fragments == baseline.fragments {
        rows.push(row("layer_cpu_median", "ms", cpu.median() - cpu_off.median(), cpu_off.median()));
    }
    rows
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

/// Aligned, with the ratios.
pub fn print_table(rows: &[Row]) {
    for row in rows {
        let spread = row.spread.map_or_else(String::new, |spread| format!(" +- {spread:.3}"));
        println!(
            "{:<12} {:<24} {:<18} {:>13.3} {:<12} x {:.3}{spread}",
            row.app, row.case, row.metric, row.value, row.unit, row.ratio
        );
    }
}
