//! The request of `parafovea gaze` to read the eye tracker in each frame: a layer that rests reads it once a second.
//!
//! It is an empty file beside the status, renewed with each look at that, and lapses by its age.

use super::request::{self, request_file};
use crate::paths::Environment;
use std::fs;
use std::io;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

/// The requests of this kind.
pub(super) const KIND: &str = "watch";

/// A request lapses after this time; the command renews it every second.
const LAPSES_AFTER: Duration = Duration::from_secs(4);

/// The place where a process looks for requests.
#[derive(Debug)]
pub struct GazeWatch(Option<PathBuf>);

impl GazeWatch {
    /// Of the process `pid`, as it knows itself.
    pub fn new(environment: &Environment, pid: u32) -> Self {
        Self(environment.status_folder().map(|folder| request_file(&folder, pid, KIND)))
    }

    /// Whether the gaze is watched at `now`. Never waits.
    pub fn look(&self, now: SystemTime) -> bool {
        let asked = self.0.as_ref().and_then(|file| fs::symlink_metadata(file).ok()?.modified().ok());
        asked.is_some_and(|asked| now.duration_since(asked).is_ok_and(|age| age < LAPSES_AFTER))
    }
}

/// Requests of the process `pid`, as its status calls it, to read its eye tracker in each frame of the next seconds.
///
/// # Errors
/// There is no status folder, or the file system refuses.
pub fn watch_gaze(environment: &Environment, pid: u32) -> io::Result<()> {
    request::write(environment, pid, KIND, Some(""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::StatusFile;
    use tempfile::TempDir;

    #[test]
    fn a_watch_lapses() {
        let runtime = TempDir::new().unwrap();
        let environment =
            Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| runtime.path().into()));
        let watch = GazeWatch::new(&environment, 7);
        let now = SystemTime::now();
        assert!(watch_gaze(&environment, 7).is_err() && !watch.look(now), "nobody has a folder there");
        let session = StatusFile::new(&environment, 7).unwrap().unwrap();
        watch_gaze(&environment, 7).unwrap();
        let after = |s| SystemTime::now() + Duration::from_secs(s);
        assert!(watch.look(after(0)) && watch.look(after(3)) && !watch.look(after(5)));
        assert!(!GazeWatch::new(&environment, 8).look(after(0)), "of another process");
        drop(session);
        assert!(!watch.look(after(0)));
    }
}
