//! A log file of limited size.

use std::fs::{DirBuilder, File, OpenOptions};
use std::io::Write;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::Path;

/// Size above which a process empties the file when it opens it, and the most that the process appends afterwards: 1 MiB.
const MAX_BYTES: u64 = 1 << 20;

/// Appended to by any number of processes.
pub struct BoundedFile {
    file: File,
    left: u64,
    full: bool,
}

impl BoundedFile {
    /// Opens the file at `path`, and makes the folders above it; `None` where that is not possible.
    pub fn open(path: &Path) -> Option<Self> {
        // 0700, as the XDG Base Directory Specification asks for.
        DirBuilder::new().recursive(true).mode(0o700).create(path.parent()?).ok()?;
        // O_NONBLOCK: a FIFO in the file's place must not make the application wait. O_NOFOLLOW, and one name alone: where others
        // may write to the folder, a link that they left must not make us write to, or empty, another file of the user's.
        let file = OpenOptions::new()
            .append(true)
            .create(true)
            .mode(0o600)
            .custom_flags(libc::O_NONBLOCK | libc::O_NOFOLLOW)
            .open(path)
            .ok()?;
        let metadata = file.metadata().ok().filter(|metadata| metadata.is_file() && metadata.nlink() == 1)?;
        if metadata.len() > MAX_BYTES {
            file.set_len(0).ok()?;
        }
        Some(Self { file, left: MAX_BYTES, full: false })
    }

    /// Appends a line with one write, so that lines of several processes do not mix.
    pub fn append(&mut self, line: &str) {
        let line = match self.left.checked_sub(line.len() as u64) {
            Some(left) if !self.full => {
                self.left = left;
                line
            }
            _ if self.full => return,
            _ => {
                self.full = true;
                "log full: no further lines from this process\n"
            }
        };
        // A full disk or a revoked file: the error cannot be reported anywhere.
        let _ = self.file.write_all(line.as_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_at_its_limit_and_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/app.log");
        let mut file = BoundedFile::open(&path).unwrap();
        let line = format!("{}\n", "x".repeat(1023));
        for _ in 0..2000 {
            file.append(&line);
        }
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().filter(|found| found.starts_with('x')).count(), 1024);
        assert_eq!(text.lines().filter(|found| found.starts_with("log full")).count(), 1);
        file.append("after");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    }

    #[test]
    fn an_overgrown_file_starts_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("app.log");
        std::fs::write(&path, vec![b'x'; MAX_BYTES as usize + 1]).unwrap();
        BoundedFile::open(&path).unwrap().append("new\n");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new\n");
    }

    #[test]
    fn a_link_in_the_files_place_is_no_log() {
        let folder = tempfile::tempdir().unwrap();
        let precious = folder.path().join("precious");
        let content = vec![b'x'; MAX_BYTES as usize + 1];
        std::fs::write(&precious, &content).unwrap();
        let [symbolic, hard] = ["symbolic.log", "hard.log"].map(|name| folder.path().join(name));
        std::os::unix::fs::symlink(&precious, &symbolic).unwrap();
        std::fs::hard_link(&precious, &hard).unwrap();
        for link in [symbolic, hard] {
            assert!(BoundedFile::open(&link).is_none(), "{}", link.display());
        }
        assert_eq!(std::fs::read(&precious).unwrap(), content);
    }

    #[test]
    fn a_folder_in_the_files_place_is_no_log() {
        let folder = tempfile::tempdir().unwrap();
        assert!(BoundedFile::open(folder.path()).is_none());
    }
}
