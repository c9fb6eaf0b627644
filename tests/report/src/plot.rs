//! Cost against contrast loss, as SVG.

use crate::points::Sweep;
use crate::results::{Results, SceneResults};
use crate::statistics::{CostAndLoss, front};
use crate::summary::mean_rows;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::RGBColor;

/// The sweeps that have a line, and its colour, safe for the colour-blind (Okabe and Ito).
const SWEEPS: [(Sweep, RGBColor); 11] = [
    (Sweep::RenderScale, RGBColor(86, 86, 86)),
    (Sweep::FixedFoveation, RGBColor(230, 159, 0)),
    (Sweep::FilledFoveation, RGBColor(150, 100, 0)),
    (Sweep::OpenXrToolkit, RGBColor(213, 94, 0)),
    (Sweep::Uniform, RGBColor(170, 170, 170)),
    (Sweep::Rates, RGBColor(0, 114, 178)),
    (Sweep::Contrast, RGBColor(86, 180, 233)),
    (Sweep::Sound, RGBColor(0, 0, 0)),
    (Sweep::Reuse, RGBColor(204, 121, 167)),
    (Sweep::RatesAndReuse, RGBColor(240, 228, 66)),
    (Sweep::Everything, RGBColor(0, 158, 115)),
];

/// All scenes: each sweep has a thin line a scene, and a thick one with dots for their mean.
///
/// # Errors
/// A text; none is known to happen.
pub fn overview(results: &Results) -> Result<String, String> {
    let rows = mean_rows(results);
    let of_mean = |sweep: Sweep| -> Vec<CostAndLoss> {
        let rows = rows.iter().filter(|row| row.sweep == sweep || row.sweep == Sweep::Off);
        sorted(rows.filter_map(|row| row.ratio.map(|cost| CostAndLoss { cost, loss: row.loss })).collect())
    };
    let scenes: Vec<_> = results.scenes.iter().collect();
    let thin = |sweep: Sweep| scenes.iter().map(|scene| line_of(scene, sweep)).collect();
    let lines =
        SWEEPS.map(|(sweep, colour)| Lines { sweep, colour, thin: thin(sweep), thick: of_mean(sweep) });
    draw((860, 480), &lines, &[], &axis(results))
}

/// One scene: a line with dots a sweep, and the Pareto front of all.
///
/// # Errors
/// As [`overview`].
pub fn of_scene(results: &Results, scene: &SceneResults) -> Result<String, String> {
    let lines =
        SWEEPS.map(|(sweep, colour)| Lines { sweep, colour, thin: Vec::new(), thick: line_of(scene, sweep) });
    let points: Vec<CostAndLoss> = scene.points.iter().filter_map(|point| point.cost_and_loss()).collect();
    let best: Vec<CostAndLoss> = front(&points).into_iter().map(|index| points[index]).collect();
    draw((640, 360), &lines, &best, &axis(results))
}

fn axis(results: &Results) -> String {
    match results.conditions.device_is_cpu {
        true => {
            "CPU time of a frame x off, by the fallback on a software device: not a user's speed".to_owned()
        }
        false => format!("GPU time of a frame x off, {}", results.conditions.device),
    }
}

/// A sweep's lines.
struct Lines {
    sweep: Sweep,
    colour: RGBColor,
    thin: Vec<Vec<CostAndLoss>>,
    thick: Vec<CostAndLoss>,
}

fn line_of(scene: &SceneResults, sweep: Sweep) -> Vec<CostAndLoss> {
    sorted(scene.sweep(sweep).into_iter().filter_map(|point| point.cost_and_loss()).collect())
}

fn sorted(mut points: Vec<CostAndLoss>) -> Vec<CostAndLoss> {
    points.retain(|point| point.cost > 0.0 && point.cost.is_finite() && point.loss.is_finite());
    points.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    points
}

fn draw(size: (u32, u32), lines: &[Lines], best: &[CostAndLoss], axis: &str) -> Result<String, String> {
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    draw_into(&area, lines, best, axis).map_err(|error| error.to_string())?;
    drop(area);
    Ok(svg)
}

fn draw_into(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    lines: &[Lines],
    best: &[CostAndLoss],
    axis: &str,
) -> Result<(), Box<dyn std::error::Error>> {
    area.fill(&WHITE)?;
    let all = || lines.iter().flat_map(|lines| lines.thin.iter().flatten().chain(&lines.thick));
    let costs = all().map(|point| point.cost.log2());
    let (least, most) =
        costs.fold((-1.0_f64, 0.0_f64), |(least, most), cost| (least.min(cost), most.max(cost)));
    let worst = all().fold(0.1_f64, |worst, point| worst.max(point.loss));
    // The axis is the logarithm, and its labels are the costs themselves.
    let at = |point: &CostAndLoss| (point.cost.log2(), point.loss);
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(52)
        .build_cartesian_2d(least - 0.1..most + 0.1, 0.0..worst * 1.05)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_labels(9)
        .x_label_formatter(&|cost| format!("{:.2}", cost.exp2()))
        .x_desc(axis)
        .y_desc("contrast loss at the true gaze, JND")
        .draw()?;
    for Lines { sweep, colour, thin, thick } in lines {
        for line in thin {
            chart.draw_series(LineSeries::new(line.iter().map(at), colour.mix(0.35)))?;
        }
        // The application alone is in every sweep: a sweep that was not measured has nothing else.
        if thick.len() < 2 {
            continue;
        }
        let colour = *colour;
        chart
            .draw_series(LineSeries::new(thick.iter().map(at), colour.stroke_width(3)))?
            .label(sweep.title())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
        chart.draw_series(thick.iter().map(|point| Circle::new(at(point), 4, colour.filled())))?;
    }
    if !best.is_empty() {
        chart
            .draw_series(DashedLineSeries::new(best.iter().map(at), 5, 4, BLACK.stroke_width(1)))?
            .label("Pareto front")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    area.present()?;
    Ok(())
}
