//! The result of the last trial.

use super::estimate::{Estimate, Verdict};

/// Results of trials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    estimate: Option<Estimate>,
    verdict: Verdict,
}

impl Evidence {
    pub(super) fn new(estimate: Option<Estimate>, verdict: Verdict) -> Self {
        Self { estimate, verdict }
    }

    /// Whether no trial had a result yet.
    pub fn is_empty(&self) -> bool {
        self.estimate.is_none()
    }

    /// The verdict.
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Cost of a frame with the technique in costs without it, and its 95 % confidence interval; at changing resolutions the end with the
    /// smaller saving. `None` before the end of the first trial.
    pub fn ratio(&self) -> Option<(f64, [f64; 2])> {
        self.estimate.map(|estimate| estimate.ratio())
    }
}
