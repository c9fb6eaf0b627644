//! Noticing that the configuration changed.

use std::fs::{self, Metadata};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use super::{Config, ConfigErrors, Places, load};
use crate::paths::Environment;

/// Watches the places of one application's configuration. Looking costs one `stat` for each place down to
/// the first that has a file; the caller chooses the interval.
#[derive(Debug)]
pub struct Watch {
    places: Places,
    /// The state that was read last: `None` before the first look, `Some(None)` where no place has a file.
    seen: Option<Option<Seen>>,
    /// Another state at the last look, which may be one of a file that is being written.
    unsettled: Option<Option<Seen>>,
}

/// The configuration file when last looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    /// Index of the place that has it.
    place: usize,
    /// `None` where it is missing or cannot be looked at.
    fingerprint: Option<Fingerprint>,
}

/// Marks that differ between two states of a file. The inode changes when an editor replaces the file, the
/// change time also when the modification time is set back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fingerprint {
    device: u64,
    inode: u64,
    size: u64,
    modified: (i64, i64),
    changed: (i64, i64),
}

impl From<Metadata> for Fingerprint {
    fn from(metadata: Metadata) -> Self {
        Self {
            device: metadata.dev(),
            inode: metadata.ino(),
            size: metadata.size(),
            modified: (metadata.mtime(), metadata.mtime_nsec()),
            changed: (metadata.ctime(), metadata.ctime_nsec()),
        }
    }
}

impl Watch {
    /// Will watch the places of [`Places::new`]; nothing is looked at yet.
    pub fn new(environment: &Environment, application: Option<&str>, executable: &Path) -> Self {
        Self { places: Places::new(environment, application, executable), seen: None, unsettled: None }
    }

    /// Reads the configuration, if it may be another one than the last read: its file was changed, replaced or removed, or one of
    /// higher precedence appeared. Always reads at the first look, and later only what two looks in a row have found: editors empty a file
    /// before they write it, or remove it before they put another in its place. Without a file, the defaults are the configuration.
    ///
    /// Errors of a file: see [`load`]. An edit after the look is seen by the next ones.
    pub fn poll(&mut self) -> Option<Result<Config, ConfigErrors>> {
        let now = look(&self.places);
        let is_settled = self.seen.is_none() || self.unsettled == Some(now);
        if self.seen == Some(now) || !is_settled {
            self.unsettled = Some(now);
            return None;
        }
        self.seen = Some(now);
        Some(self.file().map_or_else(|| Ok(Config::default()), load))
    }

    /// The configuration file that was read last; `None` where the defaults hold.
    pub fn file(&self) -> Option<&Path> {
        let seen = self.seen.flatten()?;
        self.places.files().get(seen.place).map(PathBuf::as_path)
    }
}

fn look(places: &Places) -> Option<Seen> {
    let file = places.in_force()?;
    let place = places.files().iter().position(|candidate| candidate == file)?;
    Some(Seen { place, fingerprint: fs::metadata(file).ok().map(Fingerprint::from) })
}

#[cfg(test)]
mod tests;
