//! Errors of the tracker before it predicted the gaze, from the committed table.

/// The table, with the columns of [`super::table`].
const TABLE: &str = include_str!("../../../baselines/gaze.md");

/// A line of it, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Before {
    /// Samples a second.
    pub rate_hz: f64,
    /// From the eye to the image, milliseconds.
    pub delay_ms: f64,
    /// Mean error of the newest sample around saccades: if it differs, so do the eye movements.
    pub newest_sample_deg: f64,
    /// Mean errors of the tracker, in the order of [`super::Frames::ALL`].
    pub tracker_deg: [f64; 4],
}

/// The line of a tracker; `None` where there is none.
pub fn before(rate_hz: f64, delay_ms: f64) -> Option<Before> {
    lines().find(|line| (line.rate_hz, line.delay_ms) == (rate_hz, delay_ms))
}

fn lines() -> impl Iterator<Item = Before> {
    TABLE.lines().filter_map(|line| {
        let cells = line.strip_prefix('|')?.split('|').map(|cell| cell.trim().parse().ok());
        let cells: Vec<Option<f64>> = cells.collect();
        let cell = |index: usize| cells.get(index).copied().flatten();
        Some(Before {
            rate_hz: cell(0)?,
            delay_ms: cell(1)?,
            newest_sample_deg: cell(2)?,
            tracker_deg: [cell(3)?, cell(6)?, cell(9)?, cell(12)?],
        })
    })
}
