//! Errors of the harness itself, as opposed to errors of the application that it runs.

use std::path::{Path, PathBuf};

/// A failure of the harness, or of the machine that it runs on.
#[derive(Debug, thiserror::Error)]
pub enum HarnessError {
    /// A library or program of this workspace is missing: only a build of the whole workspace makes them all.
    #[error(
        "{name} is not built in {folder}; build it with `cargo build --workspace`, or run a task of `cargo dev`, which does so"
    )]
    NotBuilt {
        /// File name.
        name: String,
        /// Folder that was searched.
        folder: PathBuf,
    },
    /// A program of the system is not in `PATH`.
    #[error("{name} is not in PATH; `cargo dev setup` installs it, or prints the command")]
    NotInstalled {
        /// The program.
        name: String,
    },
    /// Mesa's drivers over shims of the kernel's devices are not unpacked.
    #[error(
        "there are no drivers in {path}; `cargo dev setup` or `cargo dev drivers` unpacks them, or prints the reason against it"
    )]
    NoDriver {
        /// Their folder.
        path: PathBuf,
    },
    /// Reading or writing a file failed.
    #[error("{path}: {source}")]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Its cause.
        source: std::io::Error,
    },
    /// Installing the layer failed.
    #[error(transparent)]
    Install(#[from] parafovea_manifest::install::InstallError),
    /// A program could not be started.
    #[error("cannot start {program}: {source}")]
    Start {
        /// The program.
        program: PathBuf,
        /// Its cause.
        source: std::io::Error,
    },
    /// An image, record or result does not have its format.
    #[error("{path}: {reason}")]
    Format {
        /// The file.
        path: PathBuf,
        /// The error.
        reason: String,
    },
    /// The application did not meet the measurement's needs; details are in its output.
    #[error("{application}: {reason}\n{output}")]
    Application {
        /// Name of the application.
        application: String,
        /// The expectation.
        reason: String,
        /// The end of its output.
        output: String,
    },
}

impl HarnessError {
    /// For `map_err` on file operations.
    pub(crate) fn file(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::File { path: path.to_owned(), source }
    }

    /// A file with unexpected content.
    pub(crate) fn format(path: &Path, reason: impl std::fmt::Display) -> Self {
        Self::Format { path: path.to_owned(), reason: reason.to_string() }
    }
}
