//! Reading a file without ever hanging or reading too much.

use std::fs::OpenOptions;
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use super::ConfigError;

/// The largest file that is read: 1 MiB.
pub const MAX_BYTES: u64 = 1 << 20;

/// The bytes of the file at `path`.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, ConfigError> {
    // O_NONBLOCK: otherwise, opening a FIFO would wait until another process opens it for writing.
    let file = OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK).open(path)?;
    let metadata = file.metadata()?;
    if !metadata.is_file() {
        return Err(ConfigError::NotAFile);
    }
    let too_large = ConfigError::TooLarge { limit: MAX_BYTES };
    if metadata.len() > MAX_BYTES {
        return Err(too_large);
    }
    // The file may grow while it is read, and files of /proc state no length.
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests;
