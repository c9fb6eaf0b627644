//! Statistics of Mesa's compilers for the layer's kernels, and estimates for GPUs without measurements.
//!
//! The compilers' words are queried on the shims' devices ([`query`]) and kept among the sources ([`kept`]); all figures are made of
//! those ([`estimate()`], [`GPUS`], [`TASKS`]): in the table of `tests/baselines/drivers.md` ([`table()`]) and in the report.

pub mod estimate;
pub mod gpu;
mod table;
pub mod work;

pub use estimate::{Estimate, estimate};
pub use gpu::{GPUS, Gpu};
pub use table::table;
pub use work::{TASKS, Task};

use super::ShimDevice;
use crate::HarnessError;
use crate::installation::Driver;
use crate::run::{Application, Run};
use crate::scenario::{Scenario, ScenarioExt};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The devices whose compilers are queried: the devices of the [`GPUS`], and the next older NVIDIA.
pub const QUERIED: [ShimDevice; 4] =
    [ShimDevice::Navi21, ShimDevice::Navi31, ShimDevice::NvkTuring, ShimDevice::NvkAmpere];

/// The kept statistics, JSON.
const KEPT: &str = include_str!("../../baselines/kernels.json");

/// A compiler's statistics of one stage of a kernel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compiled {
    /// The kernel: the stem of its shader.
    pub kernel: String,
    /// The entry point.
    pub entry: String,
    /// The stage, `COMPUTE`, `VERTEX` or `FRAGMENT`.
    pub stage: String,
    /// Invocations of a subgroup.
    pub subgroup_size: u32,
    /// Each statistic by the driver's name for it.
    pub statistics: BTreeMap<String, f64>,
}

impl Compiled {
    /// The first statistic of these names that the driver has.
    pub fn statistic(&self, names: &[&str]) -> Option<f64> {
        names.iter().find_map(|name| self.statistics.get(*name).copied())
    }

    /// Instructions of the program, each counted once (ACO, NAK).
    pub fn instructions(&self) -> Option<f64> {
        self.statistic(&["Instructions", "Instruction count"])
    }
}

/// The statistics of all kernels on one device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kernels {
    /// The device's name.
    pub device: String,
    /// The driver package's version.
    pub driver: String,
    /// Each stage.
    pub compiled: Vec<Compiled>,
}

impl Kernels {
    /// A stage by its entry point; names of entry points are unique but for vertex and fragment stages.
    pub fn of_entry(&self, entry: &str) -> Option<&Compiled> {
        self.compiled.iter().find(|compiled| compiled.entry == entry)
    }
}

/// The kept statistics.
///
/// # Errors
/// [`HarnessError::Format`].
pub fn kept() -> Result<Vec<Kernels>, HarnessError> {
    serde_json::from_str(KEPT).map_err(|error| HarnessError::format(&kept_path(), error))
}

fn kept_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("baselines/kernels.json")
}

/// Asks a device's compiler.
///
/// # Errors
/// Errors of the harness; [`HarnessError::Application`] for a device without VK_KHR_pipeline_executable_properties.
pub fn query(device: ShimDevice) -> Result<Kernels, HarnessError> {
    let application = Application::ours("examples/kernel_statistics", &[])?;
    let run = Run::new(&application, &Scenario::new(1)).driver(Driver::Shim(device));
    let outcome = run.timeout(Duration::from_secs(60)).finish()?.expect_end()?;
    let lines = outcome.output.lines().filter_map(|line| serde_json::from_str::<Compiled>(line).ok());
    let mut compiled: Vec<Compiled> = lines.collect();
    for compiled in &mut compiled {
        compiled.statistics.retain(|name, _| !name.to_lowercase().contains("hash"));
        // Made with compose.
        if compiled.entry.ends_with("change") {
            compiled.kernel = "change".to_owned();
        }
    }
    // A second pipeline with the same stage has the same statistics.
    let name =
        |compiled: &Compiled| (compiled.kernel.clone(), compiled.entry.clone(), compiled.stage.clone());
    compiled.sort_by_key(name);
    compiled.dedup_by_key(|compiled| name(compiled));
    let driver = device.folder().version("mesa-vulkan-drivers")?;
    Ok(Kernels { device: device.name().to_owned(), driver, compiled })
}

/// Asks all compilers, and keeps their statistics among the sources.
///
/// # Errors
/// As for [`query`], and [`HarnessError::File`].
pub fn keep() -> Result<Vec<Kernels>, HarnessError> {
    let all = QUERIED.into_iter().map(query).collect::<Result<Vec<_>, _>>()?;
    let path = kept_path();
    let text = kept_text(&all).map_err(|error| HarnessError::format(&path, error))?;
    std::fs::write(&path, text).map_err(HarnessError::file(&path))?;
    Ok(all)
}

/// JSON with a line for each kernel, so that a change of a driver shows as few changed lines.
fn kept_text(all: &[Kernels]) -> serde_json::Result<String> {
    let of_device = |kernels: &Kernels| {
        let [device, driver] = [&kernels.device, &kernels.driver].map(serde_json::to_string);
        let lines = kernels.compiled.iter().map(serde_json::to_string).collect::<Result<Vec<_>, _>>()?;
        let lines = lines.join(",\n");
        Ok(format!("{{\"device\":{},\"driver\":{},\"compiled\":[\n{lines}\n]}}", device?, driver?))
    };
    let devices = all.iter().map(of_device).collect::<serde_json::Result<Vec<_>>>()?;
    Ok(format!("[{}]\n", devices.join(",\n")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kept_file_is_as_it_would_be_written() {
        assert_eq!(kept_text(&kept().unwrap()).unwrap(), KEPT);
    }
}
