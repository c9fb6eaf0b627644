//! Location of this workspace's libraries and programs as built by cargo: beside the running test, bench or program.

use crate::HarnessError;
use std::path::{Path, PathBuf};

/// The shared libraries of this workspace.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Library {
    /// The layer, both halves.
    Parafovea,
    /// The sound capture library, which the layer loads from beside itself.
    Audio,
    /// The mock OpenXR runtime.
    MockRuntime,
    /// The Vulkan layers for tests and benches.
    TestLayers,
    /// The library that counts allocations.
    TestAllocations,
}

impl Library {
    fn file_name(self) -> &'static str {
        match self {
            Library::Parafovea => "libparafovea.so",
            Library::Audio => "libparafovea_audio.so",
            Library::MockRuntime => "libparafovea_mock_runtime.so",
            Library::TestLayers => "libparafovea_test_layers.so",
            Library::TestAllocations => "libparafovea_test_allocations.so",
        }
    }

    /// The library's path. Of two copies (cargo puts one into `deps`, and one beside the programs when the library
    /// itself was asked for) the newer one.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`].
    pub fn path(self) -> Result<PathBuf, HarnessError> {
        let folder = profile_folder()?;
        let folders = [folder.join("deps"), folder.join("examples"), folder.clone()];
        let modified = |path: &PathBuf| std::fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
        let copies = folders.map(|folder| folder.join(self.file_name())).into_iter();
        let newest = copies.filter(|path| path.is_file()).max_by_key(modified);
        newest.ok_or_else(|| HarnessError::NotBuilt { name: self.file_name().to_owned(), folder })
    }
}

/// The path of a program of this workspace.
///
/// # Errors
/// [`HarnessError::NotBuilt`].
pub fn program(name: &str) -> Result<PathBuf, HarnessError> {
    let folder = profile_folder()?;
    let path = folder.join(name);
    if path.is_file() { Ok(path) } else { Err(HarnessError::NotBuilt { name: name.to_owned(), folder }) }
}

/// The path of a program of the system.
///
/// # Errors
/// [`HarnessError::NotInstalled`].
pub fn system_program(name: &str) -> Result<PathBuf, HarnessError> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).map(|folder| folder.join(name)).find(|path| path.is_file());
    found.ok_or_else(|| HarnessError::NotInstalled { name: name.to_owned() })
}

/// `target`, or the folder of `CARGO_TARGET_DIR`.
///
/// # Errors
/// [`HarnessError::File`] where the running program's own path is unknown.
pub fn target_folder() -> Result<PathBuf, HarnessError> {
    let profile = profile_folder()?;
    Ok(profile.parent().map(Path::to_owned).unwrap_or(profile))
}

/// `target/debug`: programs lie in it, tests and benches in its folder `deps`.
fn profile_folder() -> Result<PathBuf, HarnessError> {
    let own = std::env::current_exe().map_err(HarnessError::file(Path::new("/proc/self/exe")))?;
    let folder = own.parent().unwrap_or(Path::new("/"));
    let above = folder.parent().filter(|_| folder.ends_with("deps"));
    Ok(above.unwrap_or(folder).to_owned())
}
