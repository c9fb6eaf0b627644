//! Reasons why an installation fails.

use std::io;
use std::path::{Path, PathBuf};

/// Reason why an installation fails. `Display` is one line that names the file.
#[derive(Debug, thiserror::Error)]
pub enum InstallError {
    /// A file cannot be read, written or removed.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The file to install is something else.
    #[error("{}: not a Parafovea library", .0.display())]
    NotTheLayer(PathBuf),
    /// In our place is something that this program did not write. It is left alone.
    #[error("{}: not installed by Parafovea, so it stays unchanged; move it away first", .0.display())]
    NotOurs(PathBuf),
    /// A manifest is text and cannot name this path.
    #[error("{}: the path is not UTF-8, as manifests require", .0.display())]
    NotText(PathBuf),
}

impl InstallError {
    pub(super) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::File { path: path.to_owned(), source }
    }
}
