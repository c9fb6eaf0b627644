//! The tables, as Markdown, CSV and lines of JSON; the page has the same cells.

use crate::equal_loss::{EqualLoss, at_equal_loss};
use crate::estimates;
use crate::page::contests;
use crate::results::{PointResults, Results, mean};
use crate::summary::{Row, mean_rows, scene_rows};
use crate::verdict::{Tally, tallies};
use parafovea_models::errors::RING_NAMES;
use parafovea_tests::measure::{Comparison, Row as JsonRow};

/// The titles of the main table's columns.
pub fn titles(results: &Results) -> Vec<String> {
    let unit = if results.conditions.device_is_cpu { "CPU ms" } else { "GPU ms" };
    let mut titles: Vec<String> = ["technique", "fragments x off", "samples x off"].map(str::to_owned).into();
    titles.extend([
        format!("{unit} ({})", results.conditions.backend),
        "x off".to_owned(),
        "p99 ms".to_owned(),
    ]);
    titles.push("GPU ms x off".to_owned());
    titles.push("own kernels, GPU ms (estimate)".to_owned());
    titles.extend(RING_NAMES.map(|ring| format!("JND {ring}°")));
    titles.extend(["contrast loss, JND", "detected, JND", "flicker", "chroma JND"].map(str::to_owned));
    titles.extend(has_jod(results).then(|| "JOD".to_owned()));
    titles
}

/// Whether FovVideoVDP judged too.
pub fn has_jod(results: &Results) -> bool {
    results.conditions.fvvdp.is_some()
}

/// The cells of a row under [`titles`]; `gpu` are the rows of committed results of a GPU.
pub fn cells(results: &Results, row: &Row, gpu: &[Row]) -> Vec<String> {
    let number =
        |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |value| format!("{value:.digits$}"));
    let on_gpu = gpu.iter().find(|other| other.technique == row.technique);
    let mut cells = vec![row.technique.clone(), number(Some(row.fragments), 2), number(row.samples, 2)];
    cells.extend([number(row.ms, 1), number(row.ratio, 2), number(row.p99_ms, 1)]);
    cells.push(match on_gpu {
        Some(row) => format!("{} ({})", number(row.ms, 2), number(row.ratio, 2)),
        None => "none yet".to_owned(),
    });
    cells.push(estimates::cell(row.sweep));
    cells.extend(row.sustained.map(|value| number(value, 2)));
    cells.extend([
        number(Some(row.loss), 3),
        number(Some(row.detected), 2),
        number(row.flicker, 3),
        number(row.chroma, 2),
    ]);
    cells.extend(has_jod(results).then(|| number(row.jod, 2)));
    cells
}

/// The main table, over all scenes, and one for each scene.
pub fn markdown(results: &Results, gpu: &[Row]) -> String {
    let mut text = hardware_markdown(results);
    text += &format!("### Mean of {} scenes\n\n", results.scenes.len());
    text += &table(results, &mean_rows(results), gpu);
    for scene in &results.scenes {
        text += &format!("\n### {}\n\n", scene.scene);
        text += &table(results, &scene_rows(scene), &[]);
    }
    text
}

/// The titles of the table of maps.
pub fn hardware_titles(results: &Results) -> Vec<&'static str> {
    let mut titles =
        vec!["technique", "shaded", "contrast loss, JND", "detected, JND", "detected in saccades, JND"];
    titles.extend(has_jod(results).then_some("JOD"));
    titles
}

/// Its rows: means over scenes and gaze scripts.
pub fn hardware_rows(results: &Results) -> Vec<Vec<String>> {
    let techniques = results.hardware.first().into_iter().flat_map(|scene| &scene.points);
    let mean_of = |name: &str, digits: usize, value: fn(&PointResults) -> Option<f64>| {
        mean(results.hardware.iter().filter_map(|scene| value(scene.point(name)?)))
            .map_or("-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let row = |name: &str| {
        let mut row = vec![
            name.to_owned(),
            mean_of(name, 3, |point| point.cost.as_ref().map(|cost| cost.ratio)),
            mean_of(name, 3, |point| Some(point.loss())),
            mean_of(name, 2, |point| Some(point.detected())),
            mean_of(name, 2, PointResults::detected_in_flight),
        ];
        row.extend(has_jod(results).then(|| mean_of(name, 2, PointResults::jod)));
        row
    };
    techniques.map(|point| row(&point.technique)).collect()
}

/// The titles of the table of shares at equal loss.
pub fn equal_loss_titles() -> [&'static str; 4] {
    ["pixels of FR of the paper at equal loss", "measure", "x ours, geometric mean", "least of the scenes"]
}

/// Its rows.
pub fn equal_loss_rows(results: &Results) -> Vec<[String; 4]> {
    let row = |EqualLoss { technique, measure, ratio, least }: EqualLoss| {
        [technique, measure.text().to_owned(), format!("{ratio:.2}"), format!("{least:.2}")]
    };
    at_equal_loss(&results.hardware).into_iter().map(row).collect()
}

/// The same as Markdown, with the number of scenes won at an equal share of shaded pixels.
fn hardware_markdown(results: &Results) -> String {
    if results.hardware.is_empty() {
        return String::new();
    }
    let mut text =
        format!("### Maps {}, mean of {} scenes\n\n", results.conditions.look.text(), results.hardware.len());
    let titles = hardware_titles(results);
    text += &format!("| {} |\n|---|{}\n", titles.join(" | "), "---:|".repeat(titles.len() - 1));
    for row in hardware_rows(results) {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text += "\n| at equal share | than | measure | scenes |\n|---|---|---|---|\n";
    for tally in tallies(&contests(&results.hardware)) {
        let Tally { technique, rival, measure, .. } = &tally;
        text += &format!("| {technique} | {} | {} | {} |\n", rival.title(), measure.text(), tally.text());
    }
    let titles = equal_loss_titles();
    text += &format!("\n| {} |\n|---|---|---:|---:|\n", titles.join(" | "));
    for row in equal_loss_rows(results) {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text + "\n"
}

fn table(results: &Results, rows: &[Row], gpu: &[Row]) -> String {
    let titles = titles(results);
    let mut text = format!("| {} |\n|---|{}\n", titles.join(" | "), "---:|".repeat(titles.len() - 1));
    for row in rows {
        text += &format!("| {} |\n", cells(results, row, gpu).join(" | "));
    }
    text
}

/// The columns of the CSV file behind scene, sweep and technique.
const FIGURES: [&str; 10] = [
    "fragments_x_off",
    "samples_x_off",
    "ms",
    "x_off",
    "p99_ms",
    "contrast_loss_jnd",
    "detected_jnd",
    "flicker",
    "chroma_jnd",
    "spread_of_x_off",
];

/// All scenes, a line for each technique; unknown values are empty.
///
/// # Errors
/// Errors of writing into memory, which do not happen.
pub fn csv(results: &Results) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let rings = RING_NAMES.map(|ring| format!("sustained_jnd_{ring}"));
    let names = ["scene", "sweep", "technique"].into_iter().chain(FIGURES);
    let jod = has_jod(results).then(|| "jod".to_owned());
    writer.write_record(names.map(str::to_owned).chain(rings).chain(jod))?;
    for scene in &results.scenes {
        for (row, point) in scene_rows(scene).iter().zip(&scene.points) {
            let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
            let spread = point.cost.as_ref().map(|cost| cost.spread);
            let mut record = vec![scene.scene.clone(), row.sweep.title().to_owned(), row.technique.clone()];
            let figures = [
                Some(row.fragments),
                row.samples,
                row.ms,
                row.ratio,
                row.p99_ms,
                Some(row.loss),
                Some(row.detected),
                row.flicker,
                row.chroma,
                spread,
            ];
            let jod = has_jod(results).then_some(row.jod);
            record.extend(figures.into_iter().chain(row.sustained).chain(jod).map(text));
            writer.write_record(record)?;
        }
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// One object a figure, for programs.
pub fn json_rows(results: &Results) -> Vec<JsonRow> {
    let unit = if results.conditions.device_is_cpu { "cpu_ms" } else { "gpu_ms" };
    let mut all = Vec::new();
    for scene in &results.scenes {
        for (row, point) in scene_rows(scene).into_iter().zip(&scene.points) {
            let mut add = |metric: &str, unit, value: Option<f64>, comparison| {
                let Some(value) = value else { return };
                all.push(JsonRow {
                    bench: "report",
                    app: scene.scene.clone(),
                    case: row.technique.clone(),
                    metric: metric.to_owned(),
                    value,
                    unit,
                    comparison,
                });
            };
            let off_ms = scene.off().and_then(|off| off.cost.as_ref()).map(|cost| cost.median_ms);
            let ratio = point.cost.as_ref().zip(off_ms);
            let beside = ratio.map(|(cost, baseline)| Comparison {
                baseline,
                ratio: cost.ratio,
                spread: Some(cost.spread),
            });
            add(unit, "ms", row.ms, beside);
            add("p99", "ms", row.p99_ms, None);
            add("fragments", "x off", Some(row.fragments), None);
            add("samples", "x off", row.samples, None);
            add("contrast_loss", "JND", Some(row.loss), None);
            add("detected", "JND", Some(row.detected), None);
            add("flicker", "contrast", row.flicker, None);
            add("chroma", "JND", row.chroma, None);
            add("jod", "JOD", row.jod, None);
            for (ring, value) in RING_NAMES.into_iter().zip(row.sustained) {
                add(&format!("sustained {ring}"), "JND", value, None);
            }
        }
        for bits in &scene.bits {
            for (metric, value) in [("total", bits.total), ("chroma", bits.chroma)] {
                all.push(JsonRow {
                    bench: "report",
                    app: scene.scene.clone(),
                    case: bits.technique.clone(),
                    metric: format!("bd_rate {} {metric}", bits.codec),
                    value,
                    unit: "1",
                    comparison: None,
                });
            }
        }
    }
    all
}
