//! The log with the layer's decisions: Proton swallows standard error, so this is the only place.

use super::{Finding, Surroundings};
use std::fs;
use std::path::Path;

pub(super) fn examine(surroundings: &Surroundings) -> Vec<Finding> {
    let Some(state) = surroundings.environment.state_home() else {
        return vec![
            Finding::warning(
                "no-log",
                "neither XDG_STATE_HOME nor HOME is set",
                "There is no folder for logs, so the layer's decisions are not recorded.",
            )
            .advise("set HOME"),
        ];
    };
    let folder = state.join("parafovea");
    match is_writable(&folder) {
        Ok(()) => vec![Finding::good("log", format!("logs: {}", folder.display()))],
        Err(error) => vec![
            Finding::warning(
                "no-log",
                format!("{} cannot be written to: {error}", folder.display()),
                "The layer works, but its decisions are not recorded.",
            )
            .advise(format!("make {} a writable folder", folder.display())),
        ],
    }
}

/// Tries to write to the folder, or to the nearest existing one above it.
fn is_writable(folder: &Path) -> std::io::Result<()> {
    let there = folder.ancestors().find(|path| fs::symlink_metadata(path).is_ok()).unwrap_or(folder);
    tempfile::tempfile_in(there).map(drop)
}
