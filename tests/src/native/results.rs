//! The file that is kept of a device.

use super::{Comparison, Length, Times};
use crate::HarnessError;
use crate::device::Machine;
use crate::measure::{Comparison as Beside, Row};
use parafovea_zoo::Device;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Results of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// The device.
    pub device: Device,
    /// The stand-in's profile, where the device is none of its own.
    pub stand_in: Option<String>,
    /// Frames of a timed run, and pixels of an eye's side.
    pub timed: [u64; 2],
    /// The styles, in the order of the zoo.
    pub styles: Vec<StyleResults>,
}

/// Results of a style.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StyleResults {
    /// Its name.
    pub style: String,
    /// Features that the device lacks for it; then there are no other results.
    pub lacking: Option<String>,
    /// The pictures.
    pub comparison: Option<Comparison>,
    /// The times.
    pub times: Option<Times>,
}

impl Results {
    /// Nothing yet.
    pub fn new(machine: &Machine, timed: Length) -> Self {
        Self {
            device: machine.device.clone(),
            stand_in: machine.stand_in.map(|profile| profile.name().to_owned()),
            timed: [timed.frames, u64::from(timed.size)],
            styles: Vec::new(),
        }
    }

    /// Writes it into a folder, as `<device>.json`: the file's path.
    ///
    /// # Errors
    /// [`HarnessError::File`].
    pub fn write(&self, folder: &Path) -> Result<PathBuf, HarnessError> {
        let path = folder.join(format!("{}.json", file_stem(&self.device.name)));
        let text = serde_json::to_string_pretty(self).map_err(|error| HarnessError::format(&path, error))?;
        crate::installation::write(&path, &(text + "\n"))?;
        Ok(path)
    }
}

impl StyleResults {
    /// Its figures, for programs.
    pub fn rows(&self) -> Vec<Row> {
        let row = |case: &str, metric: &str, value: f64, unit, comparison| Row {
            bench: "gpu",
            app: self.style.clone(),
            case: case.to_owned(),
            metric: metric.to_owned(),
            value,
            unit,
            comparison,
        };
        let mut rows = Vec::new();
        if let Some(found) = &self.comparison {
            rows.push(row("layer", "differing", found.differing_pixels as f64, "pixels", None));
            rows.push(row("layer", "changed", found.changed_pixels as f64, "pixels", None));
        }
        if let Some(times) = &self.times {
            rows.push(row("off", "gpu_ms", times.off_ms, "ms", None));
            for (case, value, [ratio, spread]) in [
                ("layer", times.layer_ms, times.layer),
                ("native", times.native_ms, times.native),
                ("attached", times.attached_ms, times.attached),
            ] {
                let beside = Beside { baseline: times.off_ms, ratio, spread: Some(spread) };
                rows.push(row(case, "gpu_ms", value, "ms", Some(beside)));
            }
        }
        rows
    }
}

/// Small letters and digits, and `-` for all between.
fn file_stem(name: &str) -> String {
    let parts = name.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    parts.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_after_devices() {
        assert_eq!(file_stem("NVIDIA GeForce RTX 4090"), "nvidia-geforce-rtx-4090");
        assert_eq!(file_stem("llvmpipe (LLVM 15.0.6, 256 bits)"), "llvmpipe-llvm-15-0-6-256-bits");
    }
}
