//! Rows of tables: cost and loss of a technique in a scene, or in the mean of all.

use crate::points::Sweep;
use crate::results::{PointResults, Results, SceneResults, mean};
use parafovea_models::errors::RINGS;

/// One technique in a scene, or in the mean of several.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its sweep.
    pub sweep: Sweep,
    /// Its name.
    pub technique: String,
    /// Fragment shader invocations relative to the application alone.
    pub fragments: f64,
    /// Samples that passed the depth test, likewise.
    pub samples: Option<f64>,
    /// Time of a frame, milliseconds.
    pub ms: Option<f64>,
    /// The same relative to the application alone.
    pub ratio: Option<f64>,
    /// The 99th percentile of a frame, milliseconds.
    pub p99_ms: Option<f64>,
    /// Change of contrast that stays, JND, by ring.
    pub sustained: [Option<f64>; RINGS],
    /// Contrast loss over the whole view, JND.
    pub loss: f64,
    /// Its detected change, JND.
    pub detected: f64,
    /// RMS contrast at 8 to 30 Hz.
    pub flicker: Option<f64>,
    /// Change of colour contrast, JND.
    pub chroma: Option<f64>,
    /// JOD by FovVideoVDP.
    pub jod: Option<f64>,
}

/// The rows of a scene.
pub fn scene_rows(scene: &SceneResults) -> Vec<Row> {
    let Some(off) = scene.off() else { return Vec::new() };
    scene.points.iter().map(|point| row(point, off)).collect()
}

fn row(point: &PointResults, off: &PointResults) -> Row {
    let (cost, errors) = (point.cost.as_ref(), point.errors.as_ref());
    Row {
        sweep: point.sweep,
        technique: point.technique.clone(),
        fragments: point.fragments as f64 / off.fragments as f64,
        samples: point.samples.zip(off.samples).map(|(own, off)| own as f64 / off as f64),
        ms: cost.map(|cost| cost.median_ms),
        ratio: cost.map(|cost| cost.ratio),
        p99_ms: cost.map(|cost| cost.p99_ms),
        sustained: errors.map_or([None; RINGS], |errors| errors.sustained),
        loss: point.loss(),
        detected: point.detected(),
        flicker: errors.and_then(|errors| errors.flicker),
        chroma: errors.and_then(|errors| errors.chroma),
        jod: point.jod(),
    }
}

/// The means over the scenes: of ratios the geometric one, of all else the arithmetic one.
pub fn mean_rows(results: &Results) -> Vec<Row> {
    let scenes: Vec<Vec<Row>> = results.scenes.iter().map(scene_rows).collect();
    let techniques = results.techniques();
    let of = |technique: &str| -> Vec<&Row> {
        scenes.iter().flatten().filter(|row| row.technique == technique).collect()
    };
    techniques.into_iter().map(|(sweep, technique)| mean_row(sweep, technique, &of(technique))).collect()
}

fn mean_row(sweep: Sweep, technique: &str, rows: &[&Row]) -> Row {
    let arithmetic = |value: fn(&Row) -> Option<f64>| mean(rows.iter().filter_map(|row| value(row)));
    let geometric = |value: fn(&Row) -> Option<f64>| {
        mean(rows.iter().filter_map(|row| value(row)).map(f64::ln)).map(f64::exp)
    };
    Row {
        sweep,
        technique: technique.to_owned(),
        fragments: geometric(|row| Some(row.fragments)).unwrap_or(f64::NAN),
        samples: geometric(|row| row.samples),
        ms: arithmetic(|row| row.ms),
        ratio: geometric(|row| row.ratio),
        p99_ms: arithmetic(|row| row.p99_ms),
        sustained: std::array::from_fn(|ring| mean(rows.iter().filter_map(|row| row.sustained[ring]))),
        loss: arithmetic(|row| Some(row.loss)).unwrap_or(f64::NAN),
        detected: arithmetic(|row| Some(row.detected)).unwrap_or(f64::NAN),
        flicker: arithmetic(|row| row.flicker),
        chroma: arithmetic(|row| row.chroma),
        jod: arithmetic(|row| row.jod),
    }
}
