//! The device that applications render with.

use crate::HarnessError;
use crate::installation::Driver;
use crate::run::{Application, Run};
use crate::scenario::{Scenario, ScenarioExt};
use parafovea_test_layers::ShadingRateProfile;
use parafovea_zoo::Device;
use std::fmt::{self, Display};

/// A driver, and the device that applications have with it.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Vulkan driver of the device.
    pub driver: Driver,
    /// Its properties.
    pub device: Device,
    /// Profile of the stand-in for shading rates; None for the device without one.
    pub stand_in: Option<ShadingRateProfile>,
}

impl Machine {
    /// Devices of a driver.
    ///
    /// # Errors
    /// Errors of the harness, and a machine without any device.
    pub fn of(driver: Driver) -> Result<Self, HarnessError> {
        Self::with(driver, None)
    }

    /// lavapipe, looking as if it had shading rates.
    ///
    /// # Errors
    /// As for [`Self::of`].
    pub fn over_stand_in(profile: ShadingRateProfile) -> Result<Self, HarnessError> {
        Self::with(Driver::Lavapipe, Some(profile))
    }

    fn with(driver: Driver, stand_in: Option<ShadingRateProfile>) -> Result<Self, HarnessError> {
        let application = Application::ours("parafovea-zoo", &["--devices"])?;
        let run = Run::new(&application, &Scenario::new(1)).driver(driver);
        let outcome = match stand_in {
            Some(profile) => run.shading_rates(profile),
            None => run,
        }
        .finish()?;
        let found = outcome.output.lines().filter_map(|line| serde_json::from_str(line).ok());
        // GPUs before CPUs, and of those the ones with rate attachments first.
        let best = found.min_by_key(|device: &Device| (device.is_cpu, !device.has_rate_attachments));
        Ok(Self { driver, device: best.ok_or_else(|| outcome.failed("it found no device"))?, stand_in })
    }

    /// Whether frames are timed by the GPU's own timestamps.
    pub fn has_gpu_times(&self) -> bool {
        !self.device.is_cpu && self.device.timestamp_bits > 0
    }

    /// Sets a run up to be on this device.
    pub fn set_up(&self, run: Run) -> Run {
        let run = run.driver(self.driver).device(&self.device.name);
        match self.stand_in {
            Some(profile) => run.shading_rates(profile),
            None => run,
        }
    }
}

impl Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.device.name, self.device.driver)?;
        match self.stand_in {
            Some(profile) => write!(f, ", looking like {}", profile.name()),
            None => Ok(()),
        }
    }
}
