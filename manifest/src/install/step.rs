//! The steps of an installation.

use super::InstallError;
use std::fmt;
use std::fs::{self, Permissions};
use std::io::{self, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// One change to the file system. `Display` describes [`Step::apply`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Puts a copy of a file in place, and makes the folders above it.
    Copy {
        /// The file.
        from: PathBuf,
        /// Destination of the copy.
        to: PathBuf,
    },
    /// Puts a text file in place, and makes the folders above it.
    Write {
        /// The file.
        path: PathBuf,
        /// All of its content.
        text: String,
    },
    /// Removes a file, and the folders above it that this leaves empty.
    Remove {
        /// The file.
        path: PathBuf,
        /// A folder above it, which stays, as do those above that.
        below: PathBuf,
    },
    /// Takes the permission to write from everybody but the owner.
    Restrict(PathBuf),
}

impl Step {
    /// Does it. A file appears whole or not at all, and a process that has the former one open keeps that. New files and folders have the
    /// permissions that the process's umask leaves; a text file that was there keeps its own.
    ///
    /// # Errors
    ///
    /// The file system refuses.
    pub fn apply(&self) -> Result<(), InstallError> {
        self.apply_for(Modes::ByUmask)
    }

    /// As [`Self::apply`], with files and new folders that all users can read, regardless of the umask.
    ///
    /// # Errors
    ///
    /// The file system refuses.
    pub fn apply_for_all_users(&self) -> Result<(), InstallError> {
        self.apply_for(Modes::Exact)
    }

    fn apply_for(&self, modes: Modes) -> Result<(), InstallError> {
        match self {
            Self::Copy { from, to } => {
                let content = fs::read(from).map_err(InstallError::io(from))?;
                replace(to, &content, 0o755, modes).map_err(InstallError::io(to))
            }
            Self::Write { path, text } => {
                let (mode, modes) = match fs::metadata(path) {
                    // The user may have chosen its permissions.
                    Ok(present) if modes == Modes::ByUmask => {
                        (present.permissions().mode() & 0o7777, Modes::Exact)
                    }
                    _ => (0o644, modes),
                };
                replace(path, text.as_bytes(), mode, modes).map_err(InstallError::io(path))
            }
            Self::Remove { path, below } => {
                fs::remove_file(path).map_err(InstallError::io(path))?;
                let above = path.ancestors().skip(1);
                for folder in above.take_while(|folder| folder.starts_with(below) && folder != below) {
                    // Only removes an empty folder; one that holds something else stays.
                    if fs::remove_dir(folder).is_err() {
                        break;
                    }
                }
                Ok(())
            }
            Self::Restrict(path) => {
                let mode = fs::metadata(path).map_err(InstallError::io(path))?.permissions().mode();
                let restricted = Permissions::from_mode(mode & 0o7755);
                fs::set_permissions(path, restricted).map_err(InstallError::io(path))
            }
        }
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Copy { from, to } => write!(f, "copy {} to {}", from.display(), to.display()),
            Self::Write { path, .. } => write!(f, "write {}", path.display()),
            Self::Remove { path, .. } => write!(f, "remove {}", path.display()),
            Self::Restrict(path) => write!(f, "restrict write permission to the owner: {}", path.display()),
        }
    }
}

/// Permissions of files, and of new folders.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Modes {
    /// Limited by the umask of the process.
    ByUmask,
    /// Regardless of the umask; folders can be read by all users.
    Exact,
}

/// Writes to a temporary file beside `path` and renames that. Its name does not end in `.json`, so that no
/// loader reads it half written.
fn replace(path: &Path, content: &[u8], mode: u32, modes: Modes) -> io::Result<()> {
    let folder = path.parent().ok_or(io::ErrorKind::InvalidInput)?;
    make_folders(folder, modes)?;
    let mut file = tempfile::Builder::new()
        .prefix(".parafovea-")
        .permissions(Permissions::from_mode(mode))
        .tempfile_in(folder)?;
    file.write_all(content)?;
    if modes == Modes::Exact {
        file.as_file().set_permissions(Permissions::from_mode(mode))?;
    }
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

/// Makes the folder and those above it, if they are missing; folders that were there keep their permissions.
fn make_folders(folder: &Path, modes: Modes) -> io::Result<()> {
    let missing: Vec<&Path> = folder.ancestors().take_while(|folder| !folder.exists()).collect();
    fs::create_dir_all(folder)?;
    if modes == Modes::Exact {
        for folder in missing {
            fs::set_permissions(folder, Permissions::from_mode(0o755))?;
        }
    }
    Ok(())
}
