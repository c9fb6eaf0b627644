//! Answers of the models to hard input: one [`Case`] a line, each computed on request.

mod audio;
mod avpm;
mod chroma;
mod gaze;
mod geometry;
mod perception;
mod plan;
mod schedule;

use std::fmt;

/// One hard case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of the model, e.g. "loudness".
    pub model: &'static str,
    /// The difficulty, e.g. "digital silence".
    pub case: String,
    /// Expected answer, in words or numbers.
    pub expected: String,
    /// The answer.
    pub got: String,
    /// Difference from the reference in double precision, in the unit that `expected` names, where there is one.
    pub error: Option<f64>,
    /// Whether `got` meets the expectation, by the code that made the case.
    pub passed: bool,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = self.error.map_or_else(|| "-".to_owned(), |error| format!("{error:.1e}"));
        let verdict = if self.passed { "ok" } else { "WRONG" };
        write!(
            f,
            "{:<12} {:<44} {:<36} {:<28} {error:>8} {verdict}",
            self.model, self.case, self.expected, self.got
        )
    }
}

/// All cases, model by model.
pub fn table() -> Vec<Case> {
    [
        audio::cases(),
        perception::cases(),
        geometry::cases(),
        gaze::cases(),
        schedule::cases(),
        chroma::cases(),
        avpm::cases(),
        plan::cases(),
    ]
    .concat()
}
