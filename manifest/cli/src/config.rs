//! `parafovea config`.

use parafovea_manifest::{config, options};
use std::path::Path;
use std::process::ExitCode;

/// Prints a line for each error of `file`.
pub fn validate(file: &Path) -> ExitCode {
    match config::load(file) {
        Ok(_) => {
            crate::print(&format!("{}: valid\n", file.display()));
            ExitCode::SUCCESS
        }
        Err(errors) => {
            complain!("{errors}");
            ExitCode::FAILURE
        }
    }
}

/// Prints the commented default file.
pub fn default() -> ExitCode {
    crate::print(&options::default_file());
    ExitCode::SUCCESS
}
