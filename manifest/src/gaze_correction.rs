//! The correction of an eye tracker that `parafovea gaze recentre` measured: a file for each headset in `$XDG_STATE_HOME/parafovea/gaze`.
//!
//! It has the offset, the spread and the names of headset and source, and nothing else of the gaze.

use crate::paths::{Environment, file_stem};
use crate::private_file;
use serde::{Deserialize, Serialize};
use std::fs::{self, DirBuilder, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// The version of the format.
const VERSION: u32 = 1;

/// The largest offset, degrees: more is not measured (`parafovea_core::gaze::MAX_OFFSET_DEG`).
const MAX_OFFSET_DEG: f32 = 10.0;

/// More than a file has.
const MOST_BYTES: u64 = 4096;

/// The correction of an eye tracker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeCorrection {
    version: u32,
    /// The headset, as the runtime calls it.
    pub headset: String,
    /// The source that it holds for: "eyes" or "osc", as in the status.
    pub source: String,
    /// Angles to the left and upwards that are added to the gaze, degrees, together at most 10.
    pub offset_deg: [f32; 2],
    /// Root mean square of the samples' distances from their centre in the measurement, degrees.
    pub spread_deg: f32,
}

impl GazeCorrection {
    /// A correction for the gaze of `source` in `headset`, rounded to hundredths of a degree.
    pub fn new(headset: &str, source: &str, offset_deg: [f32; 2], spread_deg: f32) -> Self {
        let rounded = |angle: f32| (angle * 100.0).round() / 100.0;
        Self {
            version: VERSION,
            headset: headset.to_owned(),
            source: source.to_owned(),
            offset_deg: offset_deg.map(rounded),
            spread_deg: rounded(spread_deg),
        }
    }

    /// The file for a headset; `None` without a home, or without a name.
    pub fn file(environment: &Environment, headset: &str) -> Option<PathBuf> {
        Some(folder(environment)?.join(format!("{}.json", file_stem(headset)?)))
    }

    /// The correction in a file; `None` if it is missing. Never waits.
    ///
    /// # Errors
    /// One line that names file and fault.
    pub fn read(path: &Path) -> Result<Option<Self>, String> {
        let fault = |fault: &dyn std::fmt::Display| format!("{}: {fault}", path.display());
        let flags = libc::O_NOFOLLOW | libc::O_NONBLOCK;
        let file = match OpenOptions::new().read(true).custom_flags(flags).open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            file => file.map_err(|error| fault(&error))?,
        };
        if !file.metadata().is_ok_and(|metadata| metadata.is_file()) {
            return Err(fault(&"not a regular file"));
        }
        let mut bytes = Vec::new();
        file.take(MOST_BYTES).read_to_end(&mut bytes).map_err(|error| fault(&error))?;
        let read: Self = serde_json::from_slice(&bytes).map_err(|error| fault(&error))?;
        if read.version != VERSION {
            return Err(fault(&format!("version = {}: expected {VERSION}", read.version)));
        }
        let [left, up] = read.offset_deg;
        if !left.is_finite() || !up.is_finite() || left.hypot(up) > MAX_OFFSET_DEG + 0.1 {
            return Err(fault(&format!(
                "offset_deg = [{left}, {up}]: expected at most {MAX_OFFSET_DEG} degrees in all"
            )));
        }
        Ok(Some(read))
    }

    /// Stores it in place of the last one at `path`.
    ///
    /// # Errors
    /// The file system refuses; the last one stays then.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let folder = path.parent().ok_or(io::ErrorKind::InvalidInput)?;
        DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
        let next = path.with_extension(format!("{}.new", std::process::id()));
        let text = serde_json::to_string_pretty(self)?;
        private_file::replace(path, &next, text.as_bytes())
    }

    /// Removes the corrections of all headsets, damaged ones too, and returns their files.
    ///
    /// # Errors
    /// The file system refuses.
    pub fn remove_all(environment: &Environment) -> io::Result<Vec<PathBuf>> {
        let entries = match folder(environment).map(fs::read_dir) {
            None => return Ok(Vec::new()),
            Some(Err(error)) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Some(entries) => entries?,
        };
        let mut removed = Vec::new();
        for path in entries.flatten().map(|entry| entry.path()) {
            if path.extension().is_some_and(|extension| extension == "json") {
                fs::remove_file(&path)?;
                removed.push(path);
            }
        }
        removed.sort();
        Ok(removed)
    }
}

fn folder(environment: &Environment) -> Option<PathBuf> {
    Some(environment.state_home()?.join("parafovea").join("gaze"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_correction_is_stored_for_its_headset_until_all_are_removed() {
        let state = tempfile::tempdir().unwrap();
        let environment =
            Environment::new(false, |name| (name == "XDG_STATE_HOME").then(|| state.path().into()));
        assert_eq!(GazeCorrection::remove_all(&environment).unwrap(), [] as [PathBuf; 0]);
        let path = GazeCorrection::file(&environment, "Head/set 2").unwrap();
        assert_eq!(path, state.path().join("parafovea/gaze/Head_set 2.json"));
        assert_eq!(GazeCorrection::read(&path), Ok(None));
        let correction = GazeCorrection::new("Head/set 2", "eyes", [-1.504, 0.75], 0.2199);
        assert_eq!((correction.offset_deg, correction.spread_deg), ([-1.5, 0.75], 0.22));
        correction.write(&path).unwrap();
        assert_eq!(GazeCorrection::read(&path), Ok(Some(correction.clone())));
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        let other = GazeCorrection::new("other", "osc", [1.0, 0.0], 0.1);
        other.write(&GazeCorrection::file(&environment, "other").unwrap()).unwrap();
        assert_eq!(GazeCorrection::remove_all(&environment).unwrap().len(), 2);
        assert_eq!(GazeCorrection::read(&path), Ok(None));
        assert_eq!(GazeCorrection::file(&environment, ""), None);
    }

    #[test]
    fn a_damaged_correction_is_refused_with_its_file_and_fault() {
        let state = tempfile::tempdir().unwrap();
        let path = state.path().join("a.json");
        let good = r#"{"version":1,"headset":"a","source":"eyes","offset_deg":[1,2],"spread_deg":0.1}"#;
        fs::write(&path, good).unwrap();
        assert_eq!(GazeCorrection::read(&path).unwrap().unwrap().offset_deg, [1.0, 2.0]);
        for (text, fault) in [
            ("", "EOF"),
            ("\u{0}\u{1}", "expected value"),
            (&good[..40], "EOF"),
            (&good.replace("\"version\":1", "\"version\":2"), "version = 2: expected 1"),
            (&good.replace("[1,2]", "[9,9]"), "offset_deg = [9, 9]: expected at most 10 degrees in all"),
            (&good.replace("[1,2]", "[1e39,0]"), "offset_deg = [inf, 0]"),
            (&good.replace("[1,2]", "[1]"), "invalid length 1"),
            (&"[".repeat(10_000), "invalid type: sequence"),
        ] {
            fs::write(&path, text).unwrap();
            let refused = GazeCorrection::read(&path).unwrap_err();
            assert!(refused.contains("a.json: ") && refused.contains(fault), "{refused}");
            assert_eq!(refused.lines().count(), 1, "{refused}");
        }
        fs::remove_file(&path).unwrap();
        fs::create_dir(&path).unwrap();
        assert!(GazeCorrection::read(&path).unwrap_err().contains("not a regular file"));
    }
}
