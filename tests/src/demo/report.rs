//! The demo's findings for people and for programs.

use super::Finding;
use crate::HarnessError;

/// Prints a table, one application a row.
pub fn print_table(findings: &[Finding]) {
    println!(
        "{:<16} {:>6}  {:>9} {:>9} {:>6}  {:>11} {:>11}  {:>11} {:>12} {:>11}",
        "",
        "frames",
        "CPU ms",
        "CPU ms",
        "",
        "fragments",
        "fragments",
        "fovea max",
        "outside PSNR",
        "chroma kept"
    );
    println!(
        "{:<16} {:>6}  {:>9} {:>9} {:>6}  {:>11} {:>11}  {:>11} {:>12} {:>11}",
        "application", "", "off", "on", "ratio", "off", "on", "error /255", "dB", "outside"
    );
    for finding in findings {
        println!(
            "{:<16} {:>6}  {:>9.2} {:>9.2} {:>6.2}  {:>11} {:>11}  {:>11} {:>12.1} {:>11.2}",
            finding.app,
            finding.frames,
            finding.off.cpu_ms,
            finding.on.cpu_ms,
            finding.on.cpu_ms / finding.off.cpu_ms,
            finding.off.fragments,
            finding.on.fragments,
            finding.fovea_max_error,
            finding.outside_psnr_db,
            finding.chroma_kept,
        );
    }
    println!("CPU time and fragments are those of one frame with both eyes.");
}

/// Prints one JSON object a line, one application each.
///
/// # Errors
/// [`HarnessError::Format`], which plain figures do not cause.
pub fn print_json(findings: &[Finding]) -> Result<(), HarnessError> {
    for finding in findings {
        let line = serde_json::to_string(finding)
            .map_err(|error| HarnessError::format(std::path::Path::new("standard output"), error))?;
        println!("{line}");
    }
    Ok(())
}
