//! The drivers' limits of shading rates, for the emulating test layer.

use super::ShimDevice;
use crate::HarnessError;
use crate::installation::Driver;
use crate::run::{Application, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_test_layers::{ShadingRateDevice, ShadingRateProfile};
use std::path::Path;
use std::time::Duration;

/// The profiles that are made from drivers over shims.
pub const QUERIED: [(ShadingRateProfile, ShimDevice); 4] = [
    (ShadingRateProfile::Navi21, ShimDevice::Navi21),
    (ShadingRateProfile::Navi31, ShimDevice::Navi31),
    (ShadingRateProfile::NvkTuring, ShimDevice::NvkTuring),
    (ShadingRateProfile::Turnip750, ShimDevice::Turnip750),
];

/// The limits of a device's shading rates.
///
/// # Errors
/// Errors of the harness; [`HarnessError::Application`] for a device without rates.
pub fn shading_rates(device: ShimDevice) -> Result<ShadingRateDevice, HarnessError> {
    let application = Application::ours("parafovea-zoo", &["--shading-rates"])?;
    let run = Run::new(&application, &Scenario::new(1)).driver(Driver::Shim(device));
    let outcome = run.timeout(Duration::from_secs(30)).finish()?.expect_end()?;
    let found = outcome.output.lines().find_map(|line| serde_json::from_str(line).ok());
    found.ok_or_else(|| outcome.failed("no device with shading rates"))
}

/// Writes a device's limits to a profile's file among the sources.
///
/// # Errors
/// As for [`shading_rates`], and [`HarnessError::File`].
pub fn write(profile: ShadingRateProfile, device: ShimDevice) -> Result<(), HarnessError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("layers/profiles");
    let path = folder.join(format!("{}.json", profile.name()));
    let text = serde_json::to_string_pretty(&shading_rates(device)?)
        .map_err(|error| HarnessError::format(&path, error))?;
    std::fs::write(&path, text + "\n").map_err(HarnessError::file(&path))
}
