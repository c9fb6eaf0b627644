//! Installation of the layer for one user, and its removal: a plan of steps, which can be printed, and the steps.
//!
//! The library is copied into `$XDG_DATA_HOME/parafovea`, so that the build folder may go, and both manifests
//! name that one copy by its absolute path. The sound capture library is copied beside it, where it was built: without
//! it there is no sound, and all else works.

mod error;
mod step;

pub use error::InstallError;
pub use step::Step;

pub use crate::audio_library::LIBRARY_NAME as AUDIO_LIBRARY_NAME;

use crate::audio_library::GET_TABLE_NAME;
use crate::json::{Activation, Half};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The library's file name.
pub const LIBRARY_NAME: &str = "libparafovea.so";

/// Path of the installed library below `data` (`$XDG_DATA_HOME`).
pub fn library_path(data: &Path) -> PathBuf {
    data.join("parafovea").join(LIBRARY_NAME)
}

/// Path of the installed audio library below `data` (`$XDG_DATA_HOME`): beside the layer's library, which loads it.
pub fn audio_library_path(data: &Path) -> PathBuf {
    library_path(data).with_file_name(AUDIO_LIBRARY_NAME)
}

/// Steps that install the `library` below `data` (`$XDG_DATA_HOME`); none where all is in place. The library
/// that listens is taken from beside `library`; where there is none, none is installed. `offers_gaze`: a configuration gives the gaze to
/// applications, so the loader is to list the extension for that.
///
/// # Errors
///
/// `library` is not the layer, or in the place of one of our files is one that is not ours.
pub fn plan_install(data: &Path, library: &Path, offers_gaze: bool) -> Result<Vec<Step>, InstallError> {
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
    steps.extend(plan_audio(data, &library.with_file_name(AUDIO_LIBRARY_NAME))?);
    let named = installed.to_str().ok_or_else(|| InstallError::NotText(installed.clone()))?;
    for half in Half::BOTH {
        let path = half.manifest_path(data);
        let text = implicit_manifest(half, named, offers_gaze);
        if installed_manifest(half, &path)?.as_deref() != Some(&text) {
            steps.push(Step::Write { path, text });
        }
    }
    Ok(steps)
}

/// The removal of an installation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Removal {
    /// Its steps; none where the layer is not installed. Folders that are empty then go too, the folder of data files excepted.
    pub steps: Vec<Step>,
    /// Files in the place of ours that are not recognised as Parafovea's. They stay.
    pub kept: Vec<PathBuf>,
}

impl Removal {
    fn add<T>(
        &mut self,
        data: &Path,
        path: PathBuf,
        installed: Result<Option<T>, InstallError>,
    ) -> Result<(), InstallError> {
        match installed {
            Ok(None) => {}
            Ok(Some(_)) => self.steps.push(remove(data, path)),
            Err(InstallError::NotOurs(path)) => self.kept.push(path),
            Err(error) => return Err(error),
        }
        Ok(())
    }
}

/// The removal of the layer below `data` (`$XDG_DATA_HOME`). Configuration and logs stay.
///
/// # Errors
///
/// A file that may be ours cannot be read.
pub fn plan_uninstall(data: &Path) -> Result<Removal, InstallError> {
    let mut removal = Removal::default();
    for half in Half::BOTH {
        let path = half.manifest_path(data);
        let installed = installed_manifest(half, &path);
        removal.add(data, path, installed)?;
    }
    let (library, audio) = (library_path(data), audio_library_path(data));
    let installed = (installed_library(&library), installed_audio(&audio));
    removal.add(data, library, installed.0)?;
    removal.add(data, audio, installed.1)?;
    Ok(removal)
}

/// Takes a file of ours away, with the folders that were there for it alone: the loaders' and ours below `data`.
fn remove(data: &Path, path: PathBuf) -> Step {
    Step::Remove { path, below: data.to_owned() }
}

/// The step that makes the sound library as it was `built`, or takes it away where none was built.
fn plan_audio(data: &Path, built: &Path) -> Result<Option<Step>, InstallError> {
    let to = audio_library_path(data);
    let installed = installed_audio(&to)?;
    if !built.is_file() {
        return Ok(installed.map(|_| remove(data, to)));
    }
    let bytes = fs::read(built).map_err(InstallError::io(built))?;
    if !is_audio(&bytes) {
        return Err(InstallError::NotTheLayer(built.to_owned()));
    }
    Ok((installed.as_deref() != Some(&bytes)).then(|| Step::Copy { from: built.to_owned(), to }))
}

/// Lays out one half below `data` (as `$XDG_DATA_HOME`) with the library where it is: for tests and tools that
/// point the loaders there. `offers_gaze` as for [`plan_install`].
///
/// # Errors
///
/// The manifest cannot be written, or the path of the library is not UTF-8.
pub fn stage(data: &Path, half: Half, library: &Path, offers_gaze: bool) -> Result<(), InstallError> {
    let named = library.to_str().ok_or_else(|| InstallError::NotText(library.to_owned()))?;
    Step::Write { path: half.manifest_path(data), text: implicit_manifest(half, named, offers_gaze) }.apply()
}

fn implicit_manifest(half: Half, library: &str, offers_gaze: bool) -> String {
    if offers_gaze {
        half.manifest_with_eye_gaze(library)
    } else {
        half.manifest(library, Activation::Implicit)
    }
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

/// The sound capture library at `path`, if there is one.
fn installed_audio(path: &Path) -> Result<Option<Vec<u8>>, InstallError> {
    match present(path)? {
        Some(bytes) if !is_audio(&bytes) => Err(InstallError::NotOurs(path.to_owned())),
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

/// Whether this is a shared library with the functions for both loaders.
pub(crate) fn is_layer(bytes: &[u8]) -> bool {
    Half::BOTH.into_iter().all(|half| is_library_with(bytes, half.negotiate().as_bytes()))
}

/// Whether this is a shared library with the functions of the sound library.
pub(crate) fn is_audio(bytes: &[u8]) -> bool {
    is_library_with(bytes, GET_TABLE_NAME.to_bytes())
}

fn is_library_with(bytes: &[u8], name: &[u8]) -> bool {
    bytes.starts_with(b"\x7fELF") && bytes.windows(name.len()).any(|window| window == name)
}

#[cfg(test)]
mod tests;
