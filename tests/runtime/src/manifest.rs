//! The file through which the OpenXR loader finds the runtime.

use std::io;
use std::path::{Path, PathBuf};

/// Writes a runtime manifest, `parafovea_mock_runtime.json`, that names the shared library `so_path`, into the folder
/// `dir`. Its path, which is returned, is for the environment variable `XR_RUNTIME_JSON`.
///
/// # Errors
/// Errors of reading the working directory (a relative `so_path`) and of writing the file.
pub fn write_runtime_manifest(dir: &Path, so_path: &Path) -> io::Result<PathBuf> {
    let manifest = serde_json::json!({
        "file_format_version": "1.0.0",
        "runtime": { "name": "Parafovea mock runtime", "library_path": std::path::absolute(so_path)? },
    });
    let path = dir.join("parafovea_mock_runtime.json");
    std::fs::write(&path, format!("{manifest:#}\n"))?;
    Ok(path)
}
