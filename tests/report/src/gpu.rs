//! Results of GPUs, which are kept among the sources, as most machines that make reports have none.

use crate::results::Results;
use std::path::{Path, PathBuf};

/// Folder of the results.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../gpu-results")
}

/// The file of a device.
pub fn path(results: &Results) -> PathBuf {
    let letters = results.conditions.device.split(|letter: char| !letter.is_ascii_alphanumeric());
    let name: Vec<String> = letters.filter(|part| !part.is_empty()).map(str::to_ascii_lowercase).collect();
    folder().join(format!("report-{}.json", name.join("-")))
}

/// All kept results, newest day first; none without the folder.
///
/// # Errors
/// A text with the name of a file that cannot be read as a report.
pub fn kept() -> Result<Vec<Results>, String> {
    let files = std::fs::read_dir(folder()).into_iter().flatten().flatten().map(|file| file.path());
    let is_report = |path: &PathBuf| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        name.starts_with("report-") && name.ends_with(".json")
    };
    let mut all: Vec<Results> =
        files.filter(is_report).map(|path| Results::read(&path)).collect::<Result<_, _>>()?;
    all.sort_by(|a, b| b.conditions.date.cmp(&a.conditions.date));
    Ok(all)
}
