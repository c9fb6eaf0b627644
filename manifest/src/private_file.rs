//! Files that only their user can read, replaced as a whole.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

/// Writes `bytes` to `next`, a new name in the same folder, which then takes the place of the file at `path`: readers see the old file or the
/// new one, never a part.
///
/// # Errors
/// The file system refuses; the old file stays then, and `next` is removed.
pub fn replace(path: &Path, next: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .mode(0o600)
        .custom_flags(libc::O_NOFOLLOW)
        .open(next)?;
    let written = file.write_all(bytes).and_then(|()| fs::rename(next, path));
    written.inspect_err(|_| drop(fs::remove_file(next)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    #[test]
    fn a_file_is_replaced_or_stays_and_nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let [path, next, foreign] = ["file", "next", "foreign"].map(|name| folder.path().join(name));
        for text in ["one", "two"] {
            replace(&path, &next, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        // A link is not followed.
        symlink(&foreign, &next).unwrap();
        replace(&path, &next, b"three").unwrap_err();
        assert!(!foreign.exists());
        fs::remove_file(&next).unwrap();
        // A folder is not a file to replace.
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        replace(&taken, &next, b"three").unwrap_err();
        assert!(!next.exists());
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
    }
}
