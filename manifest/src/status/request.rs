//! Requests to a running application: small files beside its status, in the folder that is its user's alone.

use crate::paths::Environment;
use crate::private_file;
use std::fs::{self, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// The file of a process for the requests of a kind.
pub(super) fn request_file(folder: &Path, pid: u32, kind: &str) -> PathBuf {
    folder.join(format!("{pid}.{kind}"))
}

/// The request in a file; `None` for anything but a file that only its folder's owner can write. Never waits, and allocates nothing.
pub(super) fn read<'a>(path: &Path, bytes: &'a mut [u8]) -> Option<&'a str> {
    let flags = libc::O_NOFOLLOW | libc::O_NONBLOCK;
    let mut file = OpenOptions::new().read(true).custom_flags(flags).open(path).ok()?;
    let (file_is, folder_is) = (file.metadata().ok()?, fs::metadata(path.parent()?).ok()?);
    if !file_is.is_file() || file_is.uid() != folder_is.uid() || file_is.mode() & 0o022 != 0 {
        return None;
    }
    let length = file.read(bytes).ok()?;
    Some(std::str::from_utf8(&bytes[..length]).ok()?.trim_end())
}

/// Puts a request to the process `pid`, as its status calls it, in place of the last one of its kind; `None` withdraws that.
///
/// # Errors
/// There is no status folder, or the file system refuses.
pub(super) fn write(
    environment: &Environment,
    pid: u32,
    kind: &str,
    request: Option<&str>,
) -> io::Result<()> {
    let folders = environment.status_folders();
    let has_status = |folder: &&PathBuf| folder.join(format!("{pid}.json")).is_file();
    let folder = folders.iter().find(has_status).or(folders.first()).ok_or(io::ErrorKind::NotFound)?;
    let path = request_file(folder, pid, kind);
    let Some(request) = request else {
        return match fs::remove_file(path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        };
    };
    let next = folder.join(format!(".{pid}.{kind}"));
    private_file::replace(&path, &next, request.as_bytes())
}
