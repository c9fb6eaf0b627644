//! `cargo dev bench break-even`: the cheapest fragment shader at which the layer still gains.
//!
//! An application of one triangle an eye, whose pixels cost a chosen amount, with the layer's rates in every frame and without
//! the layer, by turns. The savings of rates grow with the cost of a pixel, their own cost does not: at the break-even, both
//! are equal.

use crate::HarnessError;
use crate::measure::{Comparison, Effort, Ratio, Row, Samples};
use crate::run::{Application, LayerMode, Run};
use crate::scenario::{Scenario, ScenarioExt};

/// Rates in every frame, whether they pay or not.
pub const WITH_RATES: &str = "preset = \"balanced\"\n[rates]\ngate = \"on\"\n";

/// Rounds of arithmetic for each pixel that are tried.
pub const ITERATIONS: [u32; 8] = [0, 2, 4, 8, 16, 32, 64, 128];

/// Cost of frames at one cost of a pixel.
#[derive(Clone, Debug)]
pub struct Point {
    /// Rounds of arithmetic for each pixel.
    pub iterations: u32,
    /// CPU time of a pixel without the layer, nanoseconds: of a frame, less that of one in which nothing is drawn.
    pub ns: f64,
    /// CPU time of a frame without the layer and with it, milliseconds.
    pub off: Samples,
    /// As above.
    pub on: Samples,
}

impl Point {
    /// The cost of a frame with the layer, in costs without.
    pub fn ratio(&self) -> Ratio {
        self.on.ratio_to(&self.off)
    }
}

/// Cost of a pixel at which the ratio crosses 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BreakEven {
    /// The layer gains from this cost of a pixel on, nanoseconds.
    At(f64),
    /// It gains at the least cost that was measured.
    Below(f64),
    /// It does not gain at the highest.
    Above(f64),
}

/// Measures with each of `iterations`, in ascending order; `config` is the layer's configuration.
///
/// # Errors
/// Errors of the harness, and an application that does not finish.
pub fn points(
    iterations: &[u32],
    effort: Effort,
    config: &str,
    mut progress: impl FnMut(&str),
) -> Result<Vec<Point>, HarnessError> {
    let mut run = |iterations: Option<u32>, layer: LayerMode| -> Result<Vec<f64>, HarnessError> {
        let count = iterations.map_or("no".to_owned(), |count| count.to_string());
        progress(&format!("{count} iterations, layer {}", name(&layer)));
        let application = application(iterations, effort)?;
        let scenario = Scenario::new(effort.length()).sized(effort.size, effort.size);
        let outcome = Run::new(&application, &scenario).layer(layer).finish()?;
        Ok(outcome.expect_frames(effort.length())?.record.cpu_ms_of_frames(effort.run_up))
    };
    let mut nothing = Samples::default();
    let mut pairs = vec![[Samples::default(), Samples::default()]; iterations.len()];
    for turn in 0..effort.turns {
        nothing.push(run(None, LayerMode::Absent)?);
        for (pair, &iterations) in pairs.iter_mut().zip(iterations) {
            // In an order that is reversed from turn to turn, so that a drift falls on neither.
            for side in if turn % 2 == 0 { [0, 1] } else { [1, 0] } {
                let layer = if side == 0 { LayerMode::Absent } else { LayerMode::On(config.to_owned()) };
                pair[side].push(run(Some(iterations), layer)?);
            }
        }
    }
    let pixels = 2.0 * f64::from(effort.size) * f64::from(effort.size);
    let point = |([off, on], &iterations): ([Samples; 2], &u32)| Point {
        iterations,
        ns: (off.median() - nothing.median()) * 1e6 / pixels,
        off,
        on,
    };
    Ok(pairs.into_iter().zip(iterations).map(point).collect())
}

/// A measured workload: so many rounds of arithmetic for each pixel, or no draws.
///
/// # Errors
/// [`HarnessError::NotBuilt`].
pub fn application(iterations: Option<u32>, effort: Effort) -> Result<Application, HarnessError> {
    let (size, frames) = (effort.size.to_string(), effort.length().to_string());
    let count = iterations.map(|count| count.to_string());
    let style = ["--style", "dynamic-rendering"];
    let mut arguments = vec!["shade", style[0], style[1], "--size", &size, "--frames", &frames];
    arguments.extend(count.iter().flat_map(|count| ["--iterations", count.as_str()]));
    Application::ours("parafovea-overhead", &arguments)
}

fn name(layer: &LayerMode) -> &'static str {
    if *layer == LayerMode::Absent { "off" } else { "on" }
}

/// The cost from which on the layer gains at every point; between two points by a line through the ratios over the
/// logarithm of the cost. None without points.
pub fn break_even(points: &[Point]) -> Option<BreakEven> {
    let points: Vec<_> = points.iter().map(|point| (point.ns, point.ratio().value)).collect();
    crossing(&points)
}

fn crossing(points: &[(f64, f64)]) -> Option<BreakEven> {
    let (first, last) = (points.first()?, points.last()?);
    let Some(at) = points.iter().rposition(|&(_, ratio)| ratio >= 1.0) else {
        return Some(BreakEven::Below(first.0));
    };
    let ((cheap, above), Some(&(dear, below))) = (points[at], points.get(at + 1)) else {
        return Some(BreakEven::Above(last.0));
    };
    let part = (above - 1.0) / (above - below);
    Some(BreakEven::At((cheap.ln() * (1.0 - part) + dear.ln() * part).exp()))
}

/// The figures of all points, and the break-even where there is one.
pub fn rows(points: &[Point]) -> Vec<Row> {
    let row = |case: String, metric: &str, value, unit| Row {
        bench: "break-even",
        app: "shade".to_owned(),
        case,
        metric: metric.to_owned(),
        value,
        unit,
        comparison: None,
    };
    let of_point = |point: &Point| {
        let case = format!("{} iterations", point.iterations);
        let ratio = point.ratio();
        let (on, baseline) = (point.on.median(), point.off.median());
        let comparison = Some(Comparison { baseline, ratio: ratio.value, spread: Some(ratio.spread) });
        [row(case.clone(), "pixel", point.ns, "ns"), Row { comparison, ..row(case, "cpu_median", on, "ms") }]
    };
    let mut rows: Vec<Row> = points.iter().flat_map(of_point).collect();
    if let Some(BreakEven::At(ns)) = break_even(points) {
        rows.push(row("on".to_owned(), "break_even", ns, "ns"));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crossing_is_between_its_neighbours() {
        let at = |points: &[(f64, f64)]| crossing(points).unwrap();
        assert_eq!(at(&[(1.0, 1.2), (4.0, 0.8)]), BreakEven::At(2.0));
        let BreakEven::At(ns) = at(&[(1.0, 1.4), (2.0, 1.1), (8.0, 0.9), (9.0, 0.5)]) else {
            panic!("no crossing")
        };
        assert!((ns - 4.0).abs() < 1e-9);
        // A ratio below 1 by noise alone, before a more expensive pixel at which the layer costs time, is not a gain.
        let BreakEven::At(ns) = at(&[(1.0, 0.99), (2.0, 1.1), (8.0, 0.9)]) else { panic!("no crossing") };
        assert!((ns - 4.0).abs() < 1e-9);
        assert_eq!(at(&[(1.0, 0.9), (2.0, 0.8)]), BreakEven::Below(1.0));
        assert_eq!(at(&[(1.0, 1.3), (2.0, 1.0)]), BreakEven::Above(2.0));
        assert_eq!(crossing(&[]), None);
    }
}
