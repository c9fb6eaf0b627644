//! Measurements of the eye tracker that `parafovea gaze calibrate` and `recentre` request of a running application, and their result.

use super::request::{self, request_file};
use crate::gaze_correction::GazeCorrection;
use crate::paths::Environment;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::PathBuf;

/// More than a kind and a number have.
const MOST_BYTES: usize = 48;

/// The requests of this kind.
pub(super) const KIND: &str = "measurement";

/// A kind of measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GazeMeasurement {
    /// One dot: the offset.
    Recentre,
    /// Nine dots: a calibration, which replaces the offset.
    Calibrate,
}

impl GazeMeasurement {
    /// Its name in requests, and its command below `parafovea gaze`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Recentre => "recentre",
            Self::Calibrate => "calibrate",
        }
    }
}

/// The place where a process looks for requests.
#[derive(Debug)]
pub struct AskedMeasurement(Option<PathBuf>);

impl AskedMeasurement {
    /// Of the process `pid`, as it knows itself.
    pub fn new(environment: &Environment, pid: u32) -> Self {
        Self(environment.status_folder().map(|folder| request_file(&folder, pid, KIND)))
    }

    /// The requested measurement and its number, above 0; `None` without one. Anything else in the file, or a file that others than
    /// this folder's owner can write, requests nothing.
    pub fn look(&self) -> Option<(GazeMeasurement, u64)> {
        let mut bytes = [0; MOST_BYTES];
        let (name, number) = request::read(self.0.as_deref()?, &mut bytes)?.split_once(' ')?;
        let kind = [GazeMeasurement::Recentre, GazeMeasurement::Calibrate]
            .into_iter()
            .find(|kind| kind.name() == name)?;
        let number = number.parse().ok()?;
        (number > 0).then_some((kind, number))
    }
}

/// Requests a measurement with a number of the process `pid`, as its status calls it; `None` withdraws it. It begins within a second.
///
/// # Errors
/// There is no status folder, or the file system refuses.
pub fn ask_measurement(
    environment: &Environment,
    pid: u32,
    asked: Option<(GazeMeasurement, u64)>,
) -> io::Result<()> {
    let text = asked.map(|(kind, number)| format!("{} {number}", kind.name()));
    request::write(environment, pid, KIND, text.as_deref())
}

/// The correction of the eye tracker in use, and the last measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CorrectionStatus {
    /// The correction; `None` without one.
    pub correction: Option<GazeCorrection>,
    /// Path of its file; empty: there is no place for one.
    pub file: String,
    /// The number of the last measurement; 0: there was none.
    pub number: u64,
    /// Whether it is under way.
    pub is_measuring: bool,
    /// The number of the dot that is shown in it, from 1.
    pub dot: u32,
    /// Reason why it gave no correction; empty: it gave one, or is under way.
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
        let recentre = |number| Some((GazeMeasurement::Recentre, number));
        assert!(ask_measurement(&environment, 7, recentre(3)).is_err(), "nobody has a folder there");
        let session = StatusFile::new(&environment, 7).unwrap().unwrap();
        let asked = AskedMeasurement::new(&environment, 7);
        assert_eq!(asked.look(), None);
        for request in [recentre(u64::MAX), Some((GazeMeasurement::Calibrate, u64::MAX))] {
            ask_measurement(&environment, 7, request).unwrap();
            assert_eq!(asked.look(), request);
        }
        assert_eq!(AskedMeasurement::new(&environment, 8).look(), None, "asked of another process");
        ask_measurement(&environment, 7, None).unwrap();
        assert_eq!(asked.look(), None);
        let file = runtime.path().join("parafovea/7.measurement");
        for text in [
            "",
            "5",
            "recentre",
            "recentre 0",
            "recentre -1",
            "recentre 1.5",
            "recentre 18446744073709551616",
            "calibrate 111111111111111111111111111111111111",
            "other 5",
        ] {
            fs::write(&file, text).unwrap();
            assert_eq!(asked.look(), None, "{text}");
        }
        fs::write(&file, "recentre 5").unwrap();
        assert_eq!(asked.look(), recentre(5));
        fs::set_permissions(&file, fs::Permissions::from_mode(0o666)).unwrap();
        assert_eq!(asked.look(), None, "others may write it");
        drop(session);
        assert_eq!(fs::read_dir(runtime.path().join("parafovea")).unwrap().count(), 0);
    }
}
