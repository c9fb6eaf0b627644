//! Installing the layer for one user, and taking it away again: first a plan, which says what will be done,
//! then its steps.
//!
//! The library is copied into `$XDG_DATA_HOME/parafovea`, so that the build folder may go, and both manifests
//! name that one copy by its absolute path.

mod error;
mod step;

pub use error::InstallError;
pub use step::Step;

use crate::json::{Activation, Half};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The library's file name.
pub const LIBRARY_NAME: &str = "libparafovea.so";

/// Where below `data` (`$XDG_DATA_HOME`) the library is installed.
pub fn library_path(data: &Path) -> PathBuf {
    data.join("parafovea").join(LIBRARY_NAME)
}

/// What installing the `library` below `data` (`$XDG_DATA_HOME`) takes; nothing, where all is in place.
///
/// # Errors
///
/// `library` is not the layer, or in the place of one of our files is one that is not ours.
pub fn plan_install(data: &Path, library: &Path) -> Result<Vec<Step>, InstallError> {
    let bytes = fs::read(library).map_err(InstallError::io(library))?;
    if !is_layer(&bytes) {
        return Err(InstallError::NotTheLayer(library.to_owned()));
    }
    // The library first, and so never a manifest without it.
    let installed = library_path(data);
    let mut steps = Vec::new();
    if installed_library(&installed)?.as_deref() != Some(&bytes) {
        steps.push(Step::Copy { from: library.to_owned(), to: installed.clone() });
    }
    let named = installed.to_str().ok_or_else(|| InstallError::NotText(installed.clone()))?;
    for half in Half::BOTH {
        let path = half.manifest_path(data);
        let text = half.manifest(named, Activation::Implicit);
        if installed_manifest(half, &path)?.as_deref() != Some(&text) {
            steps.push(Step::Write { path, text });
        }
    }
    Ok(steps)
}

/// What taking the layer away again takes; nothing, where it is not installed. Configuration and logs stay.
///
/// # Errors
///
/// In the place of one of our files is one that is not ours.
pub fn plan_uninstall(data: &Path) -> Result<Vec<Step>, InstallError> {
    let mut steps = Vec::new();
    for half in Half::BOTH {
        let path = half.manifest_path(data);
        if installed_manifest(half, &path)?.is_some() {
            steps.push(Step::Remove(path));
        }
    }
    let library = library_path(data);
    if installed_library(&library)?.is_some() {
        steps.push(Step::Remove(library));
    }
    Ok(steps)
}

/// Lays out one half below `data` (as `$XDG_DATA_HOME`) with the library where it is: for tests and tools that
/// point the loaders there.
///
/// # Errors
///
/// The manifest cannot be written, or the path of the library is not UTF-8.
pub fn stage(data: &Path, half: Half, library: &Path) -> Result<(), InstallError> {
    let named = library.to_str().ok_or_else(|| InstallError::NotText(library.to_owned()))?;
    Step::Write { path: half.manifest_path(data), text: half.manifest(named, Activation::Implicit) }.apply()
}

/// The manifest at `path`, if there is one.
fn installed_manifest(half: Half, path: &Path) -> Result<Option<String>, InstallError> {
    match present(path)? {
        None => Ok(None),
        Some(bytes) => match String::from_utf8(bytes) {
            Ok(text) if half.is_manifest(&text) => Ok(Some(text)),
            _ => Err(InstallError::NotOurs(path.to_owned())),
        },
    }
}

/// The library at `path`, if there is one.
fn installed_library(path: &Path) -> Result<Option<Vec<u8>>, InstallError> {
    match present(path)? {
        Some(bytes) if !is_layer(&bytes) => Err(InstallError::NotOurs(path.to_owned())),
        installed => Ok(installed),
    }
}

/// The content of the file at `path`, if there is one.
fn present(path: &Path) -> Result<Option<Vec<u8>>, InstallError> {
    let metadata = match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        other => other.map_err(InstallError::io(path))?,
    };
    if !metadata.is_file() {
        return Err(InstallError::NotOurs(path.to_owned()));
    }
    fs::read(path).map(Some).map_err(InstallError::io(path))
}

/// Whether this is a shared library with what both loaders ask for.
fn is_layer(bytes: &[u8]) -> bool {
    let contains = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    bytes.starts_with(b"\x7fELF") && Half::BOTH.into_iter().all(|half| contains(half.negotiate()))
}

#[cfg(test)]
mod tests;
