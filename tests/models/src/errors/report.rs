//! Results of [`crate::errors::judge()`], as rows for programs and as a table for people.

use crate::errors::clip::Viewing;
use crate::errors::field::{Field, RING_NAMES, RINGS};
use crate::errors::metrics::Metric;
use crate::errors::pool::{Pool, WorstTile};
use serde::Serialize;
use std::fmt;

/// One metric in one ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The metric.
    pub metric: Metric,
    /// Its unit.
    pub unit: &'static str,
    /// Angle to the true gaze, degrees, such as "5-10".
    pub ring: &'static str,
    /// Mean over the ring's pixels, all frames, both eyes. `None` where no picture shows the ring, or where the metric
    /// cannot be had (one eye alone, too few frames, ages not given, nothing to match).
    pub mean: Option<f64>,
    /// The worst tile of any frame and eye. A tile's value is the mean of its pixels in the ring, of which it must
    /// have a quarter of a tile, or where none has so many, as many as any.
    pub worst_tile: Option<WorstTile>,
    /// Pixels that the mean was taken over.
    pub pixels: u64,
}

/// One eye buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EyeSummary {
    /// Columns and rows.
    pub extent: [u32; 2],
    /// Angles of the left, right, upper and lower edge in the first frame, degrees.
    pub fov_deg: [f32; 4],
    /// Pixels per degree at the picture's centre in the first frame.
    pub pixels_per_degree: f32,
    /// Mean luminance of the reference, cd/m^2.
    pub reference_cd_m2: f64,
    /// Mean luminance of the test, cd/m^2.
    pub test_cd_m2: f64,
}

/// Errors of a clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Viewing conditions of the pictures.
    pub viewing: Viewing,
    /// Number of frames.
    pub frames: usize,
    /// Left and right.
    pub eyes: [Option<EyeSummary>; 2],
    /// Each metric in each ring, in the order of [`Metric::ALL`] and outwards.
    pub rows: Vec<Row>,
    /// Each metric frame by frame, in the order of [`Metric::ALL`]: the mean over the whole view of both eyes. Empty for
    /// metrics of the whole clip, such as flicker.
    pub frame_means: Vec<Vec<Option<f64>>>,
    /// Likewise, the detected change: values add up over the view of both eyes by probability summation (a mean of powers of 3.5), so that
    /// a change far above the threshold counts, wherever it is, and many far below do not. For metrics in JND.
    pub frame_detected: Vec<Vec<Option<f64>>>,
}

impl Report {
    /// A metric frame by frame, over the whole view.
    pub fn by_frame(&self, metric: Metric) -> &[Option<f64>] {
        &self.frame_means[metric as usize]
    }

    /// Detected change of a metric, frame by frame: [`Self::frame_detected`].
    pub fn detected_by_frame(&self, metric: Metric) -> &[Option<f64>] {
        &self.frame_detected[metric as usize]
    }

    /// Lost contrast frame by frame, JND, over the whole view: of things that stay, and of things that come and go.
    pub fn loss_by_frame(&self) -> Vec<f64> {
        sums(self.by_frame(Metric::Sustained), self.by_frame(Metric::Transient))
    }

    /// Likewise, as detected: [`Self::frame_detected`].
    pub fn detected_loss_by_frame(&self) -> Vec<f64> {
        sums(self.detected_by_frame(Metric::Sustained), self.detected_by_frame(Metric::Transient))
    }

    /// The row of a metric and ring (index into [`RING_NAMES`]).
    pub fn row(&self, metric: Metric, ring: usize) -> &Row {
        &self.rows[metric as usize * RINGS + ring]
    }
}

fn sums(one: &[Option<f64>], other: &[Option<f64>]) -> Vec<f64> {
    one.iter().zip(other).map(|(one, other)| one.unwrap_or(0.0) + other.unwrap_or(0.0)).collect()
}

pub(crate) fn rows(metric: Metric, pool: &Pool) -> impl Iterator<Item = Row> + '_ {
    // RMS over a ring is the root of its mean power, as it is in a tile.
    let of_mean = if metric.is_root_mean_square() { f64::sqrt } else { |mean| mean };
    (0..RINGS).map(move |ring| Row {
        metric,
        unit: metric.unit(),
        ring: RING_NAMES[ring],
        mean: pool.mean(ring).map(of_mean),
        worst_tile: pool.worst(ring),
        pixels: pool.pixels(ring),
    })
}

impl EyeSummary {
    pub(crate) fn new(field: &Field) -> Self {
        let fov = field.fov;
        Self {
            extent: field.extent,
            fov_deg: [fov.left, fov.right, fov.up, fov.down].map(f32::to_degrees),
            pixels_per_degree: field.central_pixels_per_degree(),
            reference_cd_m2: 0.0,
            test_cd_m2: 0.0,
        }
    }

    /// Takes in the mean luminances of reference and test in one more frame.
    pub(crate) fn add_means(&mut self, frames_before: usize, [reference, test]: [f64; 2]) {
        let share = 1.0 / (frames_before + 1) as f64;
        self.reference_cd_m2 += share * (reference - self.reference_cd_m2);
        self.test_cd_m2 += share * (test - self.test_cd_m2);
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Viewing { white_cd_m2, contrast, refresh_hz } = self.viewing;
        writeln!(
            f,
            "{} frames at {refresh_hz} Hz, white {white_cd_m2} cd/m^2, contrast {contrast}:1",
            self.frames
        )?;
        for (name, eye) in ["left", "right"].iter().zip(&self.eyes) {
            let Some(eye) = eye else { continue };
            let [left, right, up, down] = eye.fov_deg;
            writeln!(
                f,
                "{name}: {} x {}, {left:.1}..{right:.1} x {down:.1}..{up:.1} degrees, {:.2} pixels per degree at the \
                 centre, mean {:.2} cd/m^2 (reference {:.2})",
                eye.extent[0], eye.extent[1], eye.pixels_per_degree, eye.test_cd_m2, eye.reference_cd_m2
            )?;
        }
        write!(f, "{:<22}{:<10}{:<6}", "", "unit", "")?;
        RING_NAMES.iter().try_for_each(|ring| write!(f, "{ring:>11}"))?;
        writeln!(f, "  degrees from the gaze")?;
        for rows in self.rows.chunks_exact(RINGS) {
            let worst = rows.iter().map(|row| row.worst_tile.map(|worst| worst.value));
            line(f, rows[0].metric.name(), rows[0].unit, "mean", rows.iter().map(|row| row.mean))?;
            line(f, "", "", "worst", worst)?;
            if rows[0].metric == Metric::Squared {
                let psnr = |mse: f64| -10.0 * mse.log10();
                line(f, "  as PSNR", "dB", "mean", rows.iter().map(|row| row.mean.map(psnr)))?;
            }
        }
        Ok(())
    }
}

fn line(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    unit: &str,
    kind: &str,
    values: impl Iterator<Item = Option<f64>>,
) -> fmt::Result {
    write!(f, "{name:<22}{unit:<10}{kind:<6}")?;
    for value in values {
        match value {
            None => write!(f, "{:>11}", "-")?,
            Some(value) if value == 0.0 || (0.01..1e4).contains(&value.abs()) => write!(f, "{value:>11.4}")?,
            Some(value) => write!(f, "{value:>11.2e}")?,
        }
    }
    writeln!(f)
}
