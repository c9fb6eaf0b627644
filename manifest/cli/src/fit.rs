//! `parafovea fit`.

use parafovea_core::avpm::fit::{Fit, FitError, fit as coefficients};
use parafovea_core::avpm::study::{StudyError, parse};
use std::path::Path;
use std::process::ExitCode;
use std::{fs, io};

/// Why there are no coefficients.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Read(#[from] io::Error),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// Prints the coefficients of the model of sound and vision that describe a study best, and how well they do.
pub fn fit(study: &Path) -> ExitCode {
    match fitted(study) {
        Ok(fit) => {
            crate::print(&text(&fit));
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("parafovea: {}: {failure}", study.display());
            ExitCode::FAILURE
        }
    }
}

fn fitted(study: &Path) -> Result<Fit, Failure> {
    Ok(coefficients(&parse(&fs::read_to_string(study)?)?)?)
}

fn text(fit: &Fit) -> String {
    let found = &fit.coefficients;
    let lines = [
        ("a", found.a, "score per loudness unit"),
        ("b", found.b, "score times kilo-mel"),
        ("c", found.c, "score lost per 10,000 units of visual loss"),
        ("d", found.d, "score of full-rate rendering without sound"),
    ];
    let held = fit.held_at_zero;
    let mut text: String = lines
        .into_iter()
        .zip(held)
        .map(|((name, value, meaning), held)| {
            let held = if held { "; set to 0, because the study suggests the opposite sign" } else { "" };
            format!("{name} = {value:.4}  # {meaning}{held}\n")
        })
        .collect();
    let (rows, rmse, r_squared) = (fit.rows, fit.rmse, fit.r_squared);
    text += &format!("# {rows} rows, root-mean-square error {rmse:.3}, R squared {r_squared:.3}\n");
    text
}
