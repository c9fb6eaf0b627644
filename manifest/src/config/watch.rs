//! Noticing that the configuration changed.

use std::fs::{self, Metadata};
use std::io::ErrorKind;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use super::{Config, ConfigErrors, Places, load};

/// Watches the places of one application's configuration. Looking costs one `stat` for each place down to
/// the first that has a file; how often to look is the caller's business.
#[derive(Debug)]
pub struct Watch {
    places: Places,
    seen: Option<Seen>,
}

/// The configuration file when last looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    /// Which of the places has it.
    place: usize,
    /// `None` where it is missing or cannot be looked at.
    fingerprint: Option<Fingerprint>,
}

/// What tells one state of a file from another. The inode changes when an editor replaces the file, the
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
    /// Starts to watch, and takes the first look.
    pub fn new(places: Places) -> Self {
        let seen = look(&places);
        Self { places, seen }
    }

    /// Whether the configuration may be another one than at the last look: its file was changed, replaced or
    /// removed, or one of higher precedence appeared.
    pub fn changed(&mut self) -> bool {
        let now = look(&self.places);
        std::mem::replace(&mut self.seen, now) != now
    }

    /// The configuration file at the last look; `None` where the defaults hold.
    pub fn file(&self) -> Option<&Path> {
        self.seen.map(|seen| self.places.files()[seen.place].as_path())
    }

    /// Reads the configuration. An edit after the last look is seen by the next one, so nothing is missed.
    ///
    /// # Errors
    ///
    /// As [`load`].
    pub fn load(&self) -> Result<Config, ConfigErrors> {
        self.file().map_or_else(|| Ok(Config::default()), load)
    }
}

/// A place that cannot be looked at for another reason than that it is missing counts as having the file, so
/// that reading it gives the reason.
fn look(places: &Places) -> Option<Seen> {
    let missing = |file: &Path| {
        fs::metadata(file)
            .is_err_and(|error| matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory))
    };
    let file = places.find(|file| !missing(file))?;
    let place = places.files().iter().position(|candidate| candidate == file)?;
    Some(Seen { place, fingerprint: fs::metadata(file).ok().map(Fingerprint::from) })
}
