//! Small files in `$XDG_CACHE_HOME/parafovea`, which may be lost or damaged at any time.

use crate::abi::Enablement;
use parafovea_manifest::paths::Environment;
use parafovea_manifest::private_file;
use std::fs::{DirBuilder, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// The folder of this process; `None` where the environment names none, with elevated rights, and in unit tests.
pub fn folder() -> Option<PathBuf> {
    let environment = Environment::of_process(Enablement::of_process() == Enablement::Elevated);
    let folder = environment.cache_home().filter(|_| !cfg!(test));
    folder.map(|folder| folder.join("parafovea"))
}

/// The first `most_bytes` of a file; `None` for a missing or unreadable one, and for anything but a plain file.
pub fn read(path: &Path, most_bytes: u64) -> Option<Vec<u8>> {
    let flags = libc::O_NOFOLLOW | libc::O_NONBLOCK;
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path).ok()?;
    if !file.metadata().ok()?.is_file() {
        return None;
    }
    let mut bytes = Vec::new();
    file.take(most_bytes).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// Writes a new file, which then takes the place of the one at `path`.
///
/// # Errors
/// A failed call; nothing is left behind then.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().ok_or(io::ErrorKind::InvalidInput)?;
    let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?;
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let next = folder.join(format!(".{}.{}", name.to_string_lossy(), std::process::id()));
    private_file::replace(path, &next, bytes)
}

/// FNV-1a, 64 bits: detects damage, not manipulation.
pub fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
