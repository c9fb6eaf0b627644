//! The figures of one subject as a table in Markdown.

use super::Timing;
use parafovea_models::errors::{Metric, RING_NAMES, RINGS, Report};
use std::fmt::{self, Display};

/// Costs of techniques on one subject, and their errors.
pub struct Summary<'a> {
    /// The subject.
    pub app: &'a str,
    /// The first is the baseline.
    pub timings: &'a [Timing],
    /// Of the techniques behind the first; empty where nothing was judged.
    pub judged: &'a [Report],
}

/// Costs of the layer's techniques on a style of the zoo: rows of one table, a technique each.
pub struct StyleRows<'a> {
    /// The style.
    pub style: &'a str,
    /// The first is the baseline.
    pub timings: &'a [Timing],
}

impl StyleRows<'_> {
    /// Beginning of the table.
    pub const HEAD: &'static str = "| style | technique | CPU ms, off | x off | fragments x off | samples x off |\n|---|---|---:|---:|---:|---:|";
}

impl Display for StyleRows<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((off, others)) = self.timings.split_first() else { return Ok(()) };
        for (index, timing) in others.iter().enumerate() {
            let ratio = timing.cpu_ms.ratio_to(&off.cpu_ms);
            let fragments = timing.fragments as f64 / off.fragments as f64;
            let samples = timing.samples.zip(off.samples).map(|(own, off)| own as f64 / off as f64);
            let samples = samples.map_or("-".to_owned(), |ratio| format!("{ratio:.3}"));
            let (style, name, cpu_ms) = (self.style, &timing.technique, off.cpu_ms.median());
            let end = if index > 0 { "\n" } else { "" };
            write!(
                f,
                "{end}| {style} | {name} | {cpu_ms:.1} | {:.3} ± {:.3} | {fragments:.3} | {samples} |",
                ratio.value, ratio.spread
            )?;
        }
        Ok(())
    }
}

/// Printed metrics of each ring.
const BY_RING: Metric = Metric::Sustained;

/// Printed metrics of the rings from 10 degrees on alone, if techniques differ in them.
const PERIPHERAL: [Metric; 2] = [Metric::Transient, Metric::Flicker];

impl Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(off) = self.timings.first() else { return Ok(()) };
        write!(
            f,
            "\n### {}\n\n| technique | CPU ms | x off | p99 x off | fragments x off | samples x off |",
            self.app
        )?;
        let on_gpu = !off.gpu_ms.is_empty();
        if on_gpu {
            write!(f, " GPU ms | x off |")?;
        }
        let judged = !self.judged.is_empty();
        if judged {
            write!(f, " FLIP |")?;
            RING_NAMES.iter().try_for_each(|ring| write!(f, " {} {ring} |", BY_RING.name()))?;
            PERIPHERAL.iter().try_for_each(|metric| write!(f, " {} 10-20 |", metric.name()))?;
        }
        let timed = if on_gpu { 8 } else { 6 };
        let columns = if judged { timed + 1 + RINGS + PERIPHERAL.len() } else { timed };
        writeln!(f, "\n|---|{}", "---:|".repeat(columns - 1))?;
        for (index, timing) in self.timings.iter().enumerate() {
            let ratio = timing.cpu_ms.ratio_to(&off.cpu_ms);
            let p99 = timing.cpu_ms.quantile(0.99) / off.cpu_ms.quantile(0.99);
            let fragments = timing.fragments as f64 / off.fragments as f64;
            let samples = timing.samples.zip(off.samples).map(|(own, off)| own as f64 / off as f64);
            let samples = samples.map_or("-".to_owned(), |ratio| format!("{ratio:.3}"));
            let (name, cpu_ms) = (&timing.technique, timing.cpu_ms.median());
            write!(
                f,
                "| {name} | {cpu_ms:.1} | {:.3} ± {:.3} | {p99:.3} | {fragments:.3} | {samples} |",
                ratio.value, ratio.spread
            )?;
            if on_gpu {
                let ratio = timing.gpu_ms.ratio_to(&off.gpu_ms);
                write!(f, " {:.3} | {:.3} ± {:.3} |", timing.gpu_ms.median(), ratio.value, ratio.spread)?;
            }
            match index.checked_sub(1).and_then(|index| self.judged.get(index)) {
                Some(report) => errors(f, report)?,
                None if judged => write!(f, "{}", " |".repeat(columns - timed))?,
                None => {}
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

fn errors(f: &mut fmt::Formatter<'_>, report: &Report) -> fmt::Result {
    // FLIP knows nothing of gaze: of the whole picture.
    let flip = (0..RINGS).map(|ring| report.row(Metric::Flip, ring));
    let (sum, pixels) = flip.fold((0.0, 0), |(sum, pixels), row| {
        (sum + row.mean.unwrap_or(0.0) * row.pixels as f64, pixels + row.pixels)
    });
    write!(f, " {:.3} |", sum / pixels.max(1) as f64)?;
    let mean = |metric, ring| report.row(metric, ring).mean;
    let rings = (0..RINGS).map(|ring| mean(BY_RING, ring));
    let ring_of_10 = RING_NAMES.iter().position(|name| name.starts_with("10")).unwrap_or(RINGS - 1);
    let peripheral = PERIPHERAL.map(|metric| mean(metric, ring_of_10));
    for value in rings.chain(peripheral) {
        match value {
            Some(value) => write!(f, " {value:.2} |")?,
            None => write!(f, " - |")?,
        }
    }
    Ok(())
}
