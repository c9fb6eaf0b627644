//! Reports of the layers: a line of JSON for each device, appended to the file named by a variable.

use serde::Serialize;
use std::fs::OpenOptions;
use std::io::Write;

/// Appends a line to the file that `variable` names; without it nothing is reported. A report that cannot be
/// written ends the process, because a test that finds none would not know why.
pub(crate) fn append(variable: &str, what: &impl Serialize) {
    let Some(path) = std::env::var_os(variable) else { return };
    let written = serde_json::to_string(what)
        .map_err(std::io::Error::from)
        .and_then(|line| writeln!(OpenOptions::new().create(true).append(true).open(&path)?, "{line}"));
    if let Err(error) = written {
        panic!("{variable}={}: {error}", path.display());
    }
}
