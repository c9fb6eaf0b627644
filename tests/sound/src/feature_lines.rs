//! Sound features in the plans of an application: the lines of its `PARAFOVEA_FEATURES_FILE`.

use serde::Deserialize;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Features of plans from one moment on.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub struct Line {
    unix_ns: u64,
    /// gamma_ld, loudness units; plans took nothing without.
    pub gamma_ld: Option<f32>,
    /// gamma_fq, kilo-mel.
    pub gamma_fq_kilomel: Option<f32>,
    /// Whether there is only silence.
    pub silent: Option<bool>,
    /// Loudness of the newest features, LUFS; none in silence and before the first.
    pub loudness_lufs: Option<f32>,
    /// Age of the newest features, milliseconds.
    pub age_ms: Option<f64>,
    /// Confidence in the features, 0..=1.
    pub confidence: Option<f32>,
}

impl Line {
    /// Time at which it was written.
    pub fn time(&self) -> SystemTime {
        UNIX_EPOCH + Duration::from_nanos(self.unix_ns)
    }

    /// Delay of the line after `time`, seconds; negative before.
    pub fn seconds_after(&self, time: SystemTime) -> f64 {
        match self.time().duration_since(time) {
            Ok(after) => after.as_secs_f64(),
            Err(before) => -before.duration().as_secs_f64(),
        }
    }

    /// Whether sound pays for anything: more than silence.
    pub fn pays(&self) -> bool {
        self.silent == Some(false) && self.gamma_ld.is_some_and(|gamma_ld| gamma_ld > 0.0)
    }
}

/// All lines so far.
///
/// # Panics
/// A line is not one of ours.
pub fn lines(path: &Path) -> Vec<Line> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    // The last line may be half written.
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    whole.lines().map(|line| serde_json::from_str(line).expect(line)).collect()
}
