//! Coefficients from a study: constrained least squares, paper A's Eq. 13.
//!
//! The matrix as printed has frequency where loudness belongs and visual loss without its sign; rows here are
//! [gamma_ld, 1/gamma_fq, -gamma_vis/10000, 1], so that their product with [a, b, c, d] is Eq. 12.

use super::least_squares::{non_negative, rank};
use super::study::{Entry, averaged};
use parafovea_core::avpm::{Coefficients, VISUAL_LOSS_SCALE};
use std::fmt;
use thiserror::Error;

/// Unknowns of Eq. 12.
const UNKNOWNS: usize = 4;

/// A feature of Eq. 12.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// gamma_ld, weighted by a.
    Loudness,
    /// gamma_fq, weighted by b.
    Frequency,
    /// gamma_vis, weighted by c.
    VisualLoss,
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Loudness => "loudness (gamma_ld)",
            Self::Frequency => "frequency (gamma_fq)",
            Self::VisualLoss => "visual loss (gamma_vis)",
        })
    }
}

/// Coefficients, and how well they describe the study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// All >= 0.
    pub coefficients: Coefficients,
    /// Whether a, b, c and d were held at 0 by their constraint. If one is held, the study contradicts its rule (paper A,
    /// section 4.1.2): with b held, higher sounds were not liked less.
    pub held_at_zero: [bool; UNKNOWNS],
    /// Root of the mean squared difference between score and prediction, in scores.
    pub rmse: f32,
    /// Coefficient of determination, at most 1; 0 where all scores are the same, negative where their mean would
    /// predict better, which needs d to be held.
    pub r_squared: f32,
    /// Rows that were fitted, after those with identical features were averaged.
    pub rows: usize,
}

/// Reason why a study does not determine the coefficients.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// A feature or score is NaN or infinite, or gamma_fq is not above 0.
    #[error("entry {index} is not finite, or its gamma_fq is not above 0")]
    NotFinite {
        /// Index of the entry.
        index: usize,
    },
    /// Not enough combinations of features.
    #[error("{found} entries with different features; {UNKNOWNS} coefficients need at least as many")]
    TooFewRows {
        /// Entries after averaging.
        found: usize,
    },
    /// Features that are the same in every entry.
    #[error("{} never vary, so their weight cannot be determined (rank {rank} of {UNKNOWNS})", list(.features))]
    Constant {
        /// These features.
        features: Vec<Feature>,
        /// Columns of Eq. 13's X that are independent.
        rank: usize,
    },
    /// Every feature varies, but together with others: one follows from the rest.
    #[error(
        "loudness, 1/frequency and visual loss vary together, so their weights cannot be separated \
         (rank {rank} of {UNKNOWNS})"
    )]
    Dependent {
        /// Columns of Eq. 13's X that are independent.
        rank: usize,
    },
}

fn list(features: &[Feature]) -> String {
    features.iter().map(Feature::to_string).collect::<Vec<_>>().join(", ")
}

/// Eq. 13: the coefficients >= 0 that predict the scores best. Entries with identical features are averaged first
/// (Algorithm 1, line 8), in any order.
///
/// Computed in double precision.
///
/// # Errors
/// Where the entries do not determine all four coefficients, or are not numbers: see [`FitError`].
pub fn fit(entries: &[Entry]) -> Result<Fit, FitError> {
    if let Some(index) = entries.iter().position(|entry| !usable(entry)) {
        return Err(FitError::NotFinite { index });
    }
    let entries = averaged(entries);
    if entries.len() < UNKNOWNS {
        return Err(FitError::TooFewRows { found: entries.len() });
    }
    let rows: Vec<[f64; UNKNOWNS]> = entries.iter().map(row).collect();
    let scores: Vec<f64> = entries.iter().map(|entry| entry.mu.into()).collect();
    let Some(solution) = non_negative(&rows, &scores) else {
        return Err(not_determined(&rows));
    };
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    let spread: f64 = scores.iter().map(|score| (score - mean).powi(2)).sum();
    let r_squared = if spread > 0.0 { 1.0 - solution.residual / spread } else { 0.0 };
    let [a, b, c, d] = solution.x.map(|x| x as f32);
    Ok(Fit {
        coefficients: Coefficients { a, b, c, d },
        held_at_zero: solution.x.map(|x| x == 0.0),
        rmse: (solution.residual / scores.len() as f64).sqrt() as f32,
        r_squared: r_squared as f32,
        rows: scores.len(),
    })
}

fn usable(entry: &Entry) -> bool {
    let numbers = [entry.gamma_ld, entry.gamma_fq_kilomel, entry.gamma_vis, entry.mu];
    numbers.iter().all(|number| number.is_finite()) && entry.gamma_fq_kilomel > 0.0
}

/// A row of X.
fn row(entry: &Entry) -> [f64; UNKNOWNS] {
    let visual_loss = f64::from(entry.gamma_vis) / f64::from(VISUAL_LOSS_SCALE);
    [entry.gamma_ld.into(), 1.0 / f64::from(entry.gamma_fq_kilomel), -visual_loss, 1.0]
}

fn not_determined(rows: &[[f64; UNKNOWNS]]) -> FitError {
    let columns = [Feature::Loudness, Feature::Frequency, Feature::VisualLoss];
    let constant = |index: usize| {
        // With the column of ones, a constant column has rank 1.
        rank(&rows.iter().map(|row| [1.0, row[index]]).collect::<Vec<_>>()) < 2
    };
    let features: Vec<Feature> =
        (0..).zip(columns).filter(|&(index, _)| constant(index)).map(|(_, feature)| feature).collect();
    let rank = rank(rows);
    if features.is_empty() { FitError::Dependent { rank } } else { FitError::Constant { features, rank } }
}

#[cfg(test)]
mod tests;
