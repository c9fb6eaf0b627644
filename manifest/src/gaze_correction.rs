//! The correction of an eye tracker that `parafovea gaze calibrate` and `recentre` measured: a file for each headset in
//! `$XDG_STATE_HOME/parafovea/gaze`.
//!
//! It has the correction, its residuals and the names of headset and source, and nothing else of the gaze.

use crate::paths::{Environment, file_stem};
use crate::private_file;
use serde::{Deserialize, Serialize};
use std::fs::{self, DirBuilder, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// The version of the format. Version 1 had no calibration, and versions 1 and 2 one source alone; they are read as well.
const VERSION: u32 = 3;

/// The largest offset, degrees: more is not measured (`parafovea_core::gaze::MAX_OFFSET_DEG`).
const MAX_OFFSET_DEG: f32 = 10.0;

/// More than a file has.
const MOST_BYTES: u64 = 16_384;

/// The correction of an eye tracker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeCorrection {
    version: u32,
    /// The headset, as the runtime calls it.
    pub headset: String,
    /// The source that it holds for: "eyes" or "osc", as in the status.
    pub source: String,
    /// The calibration; `None` without one.
    #[serde(default)]
    pub calibration: Option<GazeCalibration>,
    /// Angles to the left and upwards that are added to the calibrated gaze, degrees, together at most 10.
    pub offset_deg: [f32; 2],
    /// Root mean square of the samples' distances from their centre in the measurement of the offset, degrees; of the calibration before an
    /// offset was measured.
    pub spread_deg: f32,
    /// Corrections of the headset's other sources, without such of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<GazeCorrection>,
}

/// A calibration: a polynomial of the second order in the angles of the gaze, and its residuals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeCalibration {
    /// Angles to the left and upwards that are added to the gaze, degrees: coefficients of 1, left, up, left * left, left * up and up * up, with
    /// angles in units of 10 degrees.
    pub coefficients_deg: [[f32; 6]; 2],
    /// The measured area: its right lower and its left upper corner, degrees to the left and upwards.
    pub area_deg: [[f32; 2]; 2],
    /// Root mean square of the distances from each dot, of a fit to the other ones, degrees.
    pub error_deg: f32,
    /// The same before the calibration.
    pub error_before_deg: f32,
    /// Accuracy and precision at each dot, degrees: distance of the calibrated gaze from the dot, and root mean square of the samples'
    /// distances from their centre.
    pub dots_deg: [[f32; 2]; 9],
}

impl GazeCalibration {
    /// The same, with coefficients in ten-thousandths, and all else in hundredths of a degree.
    fn rounded(self) -> Self {
        Self {
            coefficients_deg: self.coefficients_deg.map(|axis| axis.map(|value| round_to(value, 10_000.0))),
            area_deg: self.area_deg.map(|corner| corner.map(hundredths)),
            error_deg: hundredths(self.error_deg),
            error_before_deg: hundredths(self.error_before_deg),
            dots_deg: self.dots_deg.map(|dot| dot.map(hundredths)),
        }
    }

    /// Mean accuracy and root mean square of the precision, degrees.
    pub fn accuracy_and_precision_deg(&self) -> (f32, f32) {
        let count = self.dots_deg.len() as f32;
        let accuracy = self.dots_deg.iter().map(|[accuracy, _]| accuracy).sum::<f32>() / count;
        let squares = self.dots_deg.iter().map(|[_, precision]| precision * precision).sum::<f32>();
        (accuracy, (squares / count).sqrt())
    }
}

fn round_to(value: f32, per_unit: f32) -> f32 {
    (value * per_unit).round() / per_unit
}

fn hundredths(angle: f32) -> f32 {
    round_to(angle, 100.0)
}

impl GazeCorrection {
    /// A correction for the gaze of `source` in `headset`, rounded to hundredths of a degree.
    pub fn new(headset: &str, source: &str, offset_deg: [f32; 2], spread_deg: f32) -> Self {
        Self {
            version: VERSION,
            headset: headset.to_owned(),
            source: source.to_owned(),
            calibration: None,
            offset_deg: offset_deg.map(hundredths),
            spread_deg: hundredths(spread_deg),
            others: Vec::new(),
        }
    }

    /// The same with a calibration before the offset, or without one.
    #[must_use]
    pub fn with_calibration(self, calibration: Option<GazeCalibration>) -> Self {
        Self { calibration: calibration.map(GazeCalibration::rounded), ..self }
    }

    /// The same in place of `stored`, whose corrections of other sources stay.
    #[must_use]
    pub fn in_place_of(self, stored: Option<&Self>) -> Self {
        let others = stored.into_iter().flat_map(Self::of_all_sources);
        let others = others.filter(|other| other.source != self.source);
        let others = others.map(|other| Self { others: Vec::new(), ..other.clone() }).collect();
        Self { others, ..self }
    }

    /// The corrections of all sources: this one first.
    pub fn of_all_sources(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.others)
    }

    /// The file for a headset; `None` without a home, or without a name.
    pub fn file(environment: &Environment, headset: &str) -> Option<PathBuf> {
        Some(folder(environment.state_home()?).join(format!("{}.json", file_stem(headset)?)))
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
        if !(1..=VERSION).contains(&read.version) {
            return Err(fault(&format!("version = {}: expected 1 to {VERSION}", read.version)));
        }
        read.of_all_sources().try_for_each(Self::check).map_err(|error| fault(&error))?;
        Ok(Some(Self { version: VERSION, ..read }))
    }

    /// Finds a value that is out of its range.
    fn check(&self) -> Result<(), String> {
        let [left, up] = self.offset_deg;
        if !left.is_finite() || !up.is_finite() || left.hypot(up) > MAX_OFFSET_DEG + 0.1 {
            return Err(format!(
                "offset_deg = [{left}, {up}]: expected at most {MAX_OFFSET_DEG} degrees in all"
            ));
        }
        if !self.spread_deg.is_finite() {
            return Err(format!("spread_deg = {}: expected a finite number", self.spread_deg));
        }
        let Some(calibration) = &self.calibration else { return Ok(()) };
        let GazeCalibration { coefficients_deg, area_deg, error_deg, error_before_deg, dots_deg } =
            calibration;
        let residuals = dots_deg.iter().flatten().chain([error_deg, error_before_deg]);
        let all = coefficients_deg.iter().flatten().chain(area_deg.iter().flatten()).chain(residuals);
        match all.into_iter().find(|value| !value.is_finite()) {
            Some(value) => Err(format!("calibration: {value}: expected a finite number")),
            None => Ok(()),
        }
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

    /// Removes the corrections of all headsets, damaged ones and those in Steam's Flatpak too, and returns their files.
    ///
    /// # Errors
    /// The file system refuses.
    pub fn remove_all(environment: &Environment) -> io::Result<Vec<PathBuf>> {
        let mut removed = Vec::new();
        for state in environment.state_homes() {
            let entries = match fs::read_dir(folder(&state)) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                entries => entries?,
            };
            for path in entries.flatten().map(|entry| entry.path()) {
                if path.extension().is_some_and(|extension| extension == "json") {
                    fs::remove_file(&path)?;
                    removed.push(path);
                }
            }
        }
        removed.sort();
        Ok(removed)
    }
}

fn folder(state_home: &Path) -> PathBuf {
    state_home.join("parafovea").join("gaze")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paths::FLATPAK_STEAM;
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

    /// Games of that Steam have another home than this user's command.
    #[test]
    fn corrections_in_the_flatpak_of_steam_are_removed_too() {
        let home = tempfile::tempdir().unwrap();
        let of = |home: &Path| Environment::new(false, |name| (name == "HOME").then(|| home.into()));
        let (host, flatpak) = (of(home.path()), of(&home.path().join(FLATPAK_STEAM)));
        let files = [&host, &flatpak].map(|environment| GazeCorrection::file(environment, "a").unwrap());
        for file in &files {
            GazeCorrection::new("a", "eyes", [1.0, 0.0], 0.1).write(file).unwrap();
        }
        assert_eq!(GazeCorrection::remove_all(&host).unwrap(), files);
        assert!(!files.iter().any(|file| file.exists()));
    }

    /// A calibration whose numbers are kept by rounding.
    fn calibration() -> GazeCalibration {
        GazeCalibration {
            coefficients_deg: [[0.625, -0.5, 0.25, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0001, 0.0, 0.0, 0.0]],
            area_deg: [[-12.5, -9.25], [13.0, 10.0]],
            error_deg: 0.5,
            error_before_deg: 3.25,
            dots_deg: [[0.5, 0.25]; 9],
        }
    }

    #[test]
    fn a_correction_replaces_that_of_its_own_source_alone() {
        let eyes = GazeCorrection::new("a", "eyes", [1.0, 2.0], 0.1).with_calibration(Some(calibration()));
        let osc = GazeCorrection::new("a", "osc", [3.0, 0.0], 0.1).in_place_of(Some(&eyes));
        assert_eq!(osc.others, std::slice::from_ref(&eyes));
        let state = tempfile::tempdir().unwrap();
        let path = state.path().join("a.json");
        osc.write(&path).unwrap();
        assert_eq!(GazeCorrection::read(&path), Ok(Some(osc.clone())));
        let moved = GazeCorrection::new("a", "osc", [4.0, 0.0], 0.1).in_place_of(Some(&osc));
        assert_eq!(moved.others, [eyes]);
        let again = GazeCorrection::new("a", "eyes", [0.0; 2], 0.1).in_place_of(Some(&moved));
        let sources = again.of_all_sources().map(|one| (one.source.as_str(), one.others.len()));
        assert_eq!(sources.collect::<Vec<_>>(), [("eyes", 1), ("osc", 0)]);
        let text = fs::read_to_string(&path).unwrap().replace("2.0", "1e39");
        fs::write(&path, text).unwrap();
        assert!(GazeCorrection::read(&path).unwrap_err().contains("offset_deg = [1, inf]"));
    }

    #[test]
    fn a_calibration_is_stored_with_its_residuals() {
        let state = tempfile::tempdir().unwrap();
        let path = state.path().join("a.json");
        let fine = GazeCalibration {
            coefficients_deg: [[0.62503, -0.5, 0.25, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0001, 0.0, 0.0, 0.0]],
            ..calibration()
        };
        let correction = GazeCorrection::new("a", "eyes", [0.0; 2], 0.25).with_calibration(Some(fine));
        correction.write(&path).unwrap();
        let read = GazeCorrection::read(&path).unwrap().unwrap();
        assert_eq!(read, correction);
        assert_eq!(read.calibration, Some(calibration()));
        assert_eq!(calibration().accuracy_and_precision_deg(), (0.5, 0.25));
    }

    #[test]
    fn a_damaged_correction_is_refused_with_its_file_and_fault() {
        let state = tempfile::tempdir().unwrap();
        let path = state.path().join("a.json");
        let good = r#"{"version":1,"headset":"a","source":"eyes","offset_deg":[1,2],"spread_deg":0.1}"#;
        fs::write(&path, good).unwrap();
        let first_version = GazeCorrection::new("a", "eyes", [1.0, 2.0], 0.1);
        assert_eq!(GazeCorrection::read(&path), Ok(Some(first_version.clone())));
        first_version.with_calibration(Some(calibration())).write(&path).unwrap();
        let calibrated = fs::read_to_string(&path).unwrap();
        for (text, fault) in [
            ("", "EOF"),
            ("\u{0}\u{1}", "expected value"),
            (&good[..40], "EOF"),
            (&good.replace("\"version\":1", "\"version\":4"), "version = 4: expected 1 to 3"),
            (&calibrated.replace("0.625", "1e39"), "calibration: inf: expected a finite number"),
            (&calibrated.replace("0.625,", ""), "invalid length"),
            (&good.replace("[1,2]", "[9,9]"), "offset_deg = [9, 9]: expected at most 10 degrees in all"),
            (&good.replace("[1,2]", "[1e39,0]"), "offset_deg = [inf, 0]"),
            (&good.replace("[1,2]", "[1]"), "invalid length 1"),
            (&good.replace("0.1", "1e39"), "spread_deg = inf: expected a finite number"),
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
