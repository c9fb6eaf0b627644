//! The measurement that `parafovea gaze recentre` requests of a running application, and its result.

use super::folder::folder;
use super::request::{self, request_file};
use crate::gaze_correction::GazeCorrection;
use crate::paths::Environment;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::PathBuf;

/// More than a number has.
const MOST_BYTES: usize = 32;

/// The requests of this kind.
pub(super) const KIND: &str = "recentre";

/// The place where a process looks for requests.
#[derive(Debug)]
pub struct AskedRecentre(Option<PathBuf>);

impl AskedRecentre {
    /// Of the process `pid`, as it knows itself.
    pub fn new(environment: &Environment, pid: u32) -> Self {
        Self(folder(environment).map(|folder| request_file(&folder, pid, KIND)))
    }

    /// The number of the requested measurement, above 0; `None` without one. What is no number, or not a file that only this folder's owner
    /// can write, asks for nothing.
    pub fn look(&self) -> Option<u64> {
        let number = request::read(self.0.as_deref()?, &mut [0; MOST_BYTES])?.parse().ok()?;
        (number > 0).then_some(number)
    }
}

/// Requests the measurement `number` of the process `pid`, as its status calls it; `None` withdraws it. It begins within a second.
///
/// # Errors
/// Nothing tells of that process, or the file system refuses.
pub fn ask_recentre(environment: &Environment, pid: u32, number: Option<u64>) -> io::Result<()> {
    request::write(environment, pid, KIND, number.map(|number| number.to_string()).as_deref())
}

/// The correction of the eye tracker in use, and the last measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Recentre {
    /// The correction; `None` without one.
    pub correction: Option<GazeCorrection>,
    /// Path of its file; empty: there is no place for one.
    pub file: String,
    /// The number of the last measurement; 0: there was none.
    pub number: u64,
    /// Whether it is under way.
    pub is_measuring: bool,
    /// Why it gave no correction; empty: it gave one, or is under way.
    pub failure: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::StatusFile;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_measurement_is_requested_by_its_number_until_it_is_withdrawn() {
        let runtime = tempfile::tempdir().unwrap();
        let environment =
            Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| runtime.path().into()));
        assert!(ask_recentre(&environment, 7, Some(3)).is_err(), "nobody has a folder there");
        let session = StatusFile::new(&environment, 7).unwrap().unwrap();
        let asked = AskedRecentre::new(&environment, 7);
        assert_eq!(asked.look(), None);
        ask_recentre(&environment, 7, Some(u64::MAX)).unwrap();
        assert_eq!(asked.look(), Some(u64::MAX));
        assert_eq!(AskedRecentre::new(&environment, 8).look(), None, "asked of another process");
        ask_recentre(&environment, 7, None).unwrap();
        assert_eq!(asked.look(), None);
        let file = runtime.path().join("parafovea/7.recentre");
        for text in ["", "0", "-1", "1.5", "18446744073709551616", "111111111111111111111111111111111111"] {
            fs::write(&file, text).unwrap();
            assert_eq!(asked.look(), None, "{text}");
        }
        fs::write(&file, "5").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o666)).unwrap();
        assert_eq!(asked.look(), None, "others may write it");
        drop(session);
        assert_eq!(fs::read_dir(runtime.path().join("parafovea")).unwrap().count(), 0);
    }
}
