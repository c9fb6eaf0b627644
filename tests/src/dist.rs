//! Packages for users: an archive with an installer for one user, and a Debian package for all, from cargo's build.
//!
//! Manifests in the package name the library by a path that is relative to them, so that its content can be tried wherever it is
//! unpacked.

mod archive;
mod deb;
mod glibc;
mod parts;
mod test_names;

pub use archive::archive;
pub use deb::{architecture as debian_architecture, package};
pub use glibc::{NEWEST_GLIBC, newest_glibc};
pub use parts::{Entry, Parts};
pub use test_names::{TEST_NAMES, test_names};

use std::path::{Path, PathBuf};

/// The version of all of it.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Reason why nothing was packed.
#[derive(Debug, thiserror::Error)]
pub enum DistError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The command did not print a part of the package.
    #[error("parafovea generate {what} failed: {output}")]
    Generate {
        /// Kind of output.
        what: &'static str,
        /// Its output.
        output: String,
    },
    /// It was linked with a newer C library than most systems have.
    #[error("{} needs GLIBC_{}.{}; allowed: at most GLIBC_{}.{}", .path.display(), .needs[0], .needs[1], NEWEST_GLIBC[0], NEWEST_GLIBC[1])]
    TooNew {
        /// The file.
        path: PathBuf,
        /// Major and minor version.
        needs: [u32; 2],
    },
    /// It knows variables for tests.
    #[error("{name} is a build for tests: it knows {}", .names.join(", "))]
    ForTests {
        /// The program or library.
        name: &'static str,
        /// The variables.
        names: Vec<&'static str>,
    },
}

impl DistError {
    pub(crate) fn file(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::File { path: path.to_owned(), source }
    }
}
