//! One application, run once.

mod application;
mod child;
mod outcome;
mod running;
mod validation;

pub use application::Application;
pub use outcome::{Outcome, complaints};
pub use running::Running;
pub use validation::{Message, is_of_late_hello_xr};

use crate::artifacts::Library;
use crate::installation::{Driver, Halves, Installation, write};
use crate::scenario::Scenario;
use crate::{HarnessError, artifacts};
use child::Child;
use outcome::Folder;
use parafovea_manifest::install::{AUDIO_LIBRARY_NAME, LIBRARY_NAME};
use parafovea_test_layers::validation::VALIDATION_LAYER;
use parafovea_test_layers::{
    COSTS_FILE_VARIABLE, COSTS_VARIABLE, COUNT_FILE_VARIABLE, DROP_BARRIER_VARIABLE, FAULT_FILE_VARIABLE,
    FAULT_VARIABLE, LIVE_FILE_VARIABLE, PlantedCosts, SAMPLES_FILE_VARIABLE, SHADING_RATE_FILE_VARIABLE,
    SHADING_RATE_PROFILE_VARIABLE, ShadingRateProfile, TIMES_FILE_VARIABLE, TestLayer, VulkanFault,
};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Installation and activation of the layer in a run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LayerMode {
    /// Not installed.
    Absent,
    /// Installed; nothing enables it.
    Off,
    /// Enabled, with this configuration file; empty: the defaults.
    On(String),
    /// As [`Self::On`], but only the Vulkan half is installed.
    VulkanHalf(String),
    /// As [`Self::On`], but only the OpenXR half is installed.
    OpenXrHalf(String),
}

impl LayerMode {
    fn config(&self) -> Option<&str> {
        match self {
            LayerMode::Absent | LayerMode::Off => None,
            LayerMode::On(config) | LayerMode::VulkanHalf(config) | LayerMode::OpenXrHalf(config) => {
                Some(config)
            }
        }
    }
}

/// A run to be started.
#[derive(Clone, Debug)]
pub struct Run {
    application: Application,
    scenario: Scenario,
    layer: LayerMode,
    library: Option<PathBuf>,
    copies: bool,
    offers_gaze: bool,
    has_audio_library: bool,
    validation: bool,
    test_layers: Vec<TestLayer>,
    two_queues: bool,
    compiles_at_once: bool,
    driver: Driver,
    environment: Vec<(String, OsString)>,
    timeout: Duration,
    closes_input: bool,
}

impl Run {
    /// A run of `application` without the layer.
    pub fn new(application: &Application, scenario: &Scenario) -> Self {
        Self {
            application: application.clone(),
            scenario: scenario.clone(),
            layer: LayerMode::Absent,
            library: None,
            copies: false,
            offers_gaze: false,
            has_audio_library: false,
            validation: false,
            test_layers: Vec::new(),
            two_queues: false,
            compiles_at_once: true,
            driver: Driver::default(),
            environment: Vec::new(),
            timeout: Duration::from_secs(240),
            closes_input: false,
        }
    }

    /// Sets the mode of the layer.
    pub fn layer(mut self, mode: LayerMode) -> Self {
        self.layer = mode;
        self
    }

    /// Installs this library as the layer; otherwise the one of this build.
    pub fn library(mut self, path: &Path) -> Self {
        self.library = Some(path.to_owned());
        self
    }

    /// Enables the layer with this configuration.
    pub fn on(self, config: &str) -> Self {
        self.layer(LayerMode::On(config.to_owned()))
    }

    /// Installs the two halves from two copies of the library, at different paths.
    pub fn from_copies(mut self) -> Self {
        self.copies = true;
        self
    }

    /// Installs the layer so that the OpenXR loader lists eye gaze among its extensions.
    pub fn listing_eye_gaze(mut self) -> Self {
        self.offers_gaze = true;
        self
    }

    /// Installs the sound capture library, beside the layer's.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`].
    pub fn with_audio_library(mut self) -> Result<Self, HarnessError> {
        Library::Audio.path()?;
        self.has_audio_library = true;
        Ok(self)
    }

    /// Puts the Khronos Vulkan validation layer, with synchronization validation across submits, and the OpenXR core
    /// validation layer below ours.
    pub fn validated(mut self) -> Self {
        self.validation = true;
        self
    }

    /// As [`Self::validated`], unless the validation layer beside the driver set before is older than Vulkan headers
    /// 1.3.`headers`, the first to know the application's calls: older ones complain of valid calls, or crash.
    pub fn validated_from(self, headers: u32) -> Self {
        let has = validation::headers(&self.driver.data_folders());
        if has.is_some_and(|has| has < headers) { self } else { self.validated() }
    }

    /// Whether validation is below ours.
    pub fn is_validated(&self) -> bool {
        self.validation
    }

    /// Adds a test layer below ours, and above validation; not the counting one, for which see [`Self::counted`].
    pub fn test_layer(mut self, layer: TestLayer) -> Self {
        self.test_layers.push(layer);
        self
    }

    /// Puts layers that do nothing directly above and below ours, as overlays and capture tools are.
    pub fn between_layers(self) -> Self {
        self.test_layer(TestLayer::PassThrough).env(&TestLayer::Above.implicit_variable(), "1")
    }

    /// Counts the fragments that the application shades, above our layer: its own draws are not counted. Counts also the samples that pass
    /// the depth test in the application's render passes, directly below ours.
    pub fn counted(mut self) -> Self {
        self.test_layers.insert(0, TestLayer::Samples);
        self.env(&TestLayer::Count.implicit_variable(), "1")
    }

    /// Times command buffers on the GPU, directly below ours: the application's and our layer's.
    pub fn gpu_timed(mut self) -> Self {
        self.test_layers.insert(0, TestLayer::Times);
        self
    }

    /// Counts the calls that reach the driver, the application's and the layer's own, and makes the calls of `fault` fail, directly
    /// below ours; [`Outcome::faults`] has the counts.
    pub fn faulted(mut self, fault: Option<&VulkanFault>) -> Self {
        self.test_layers.insert(0, TestLayer::Faults);
        let run = self.env(&TestLayer::Calls.implicit_variable(), "1");
        // Structures of strings and numbers always serialise.
        let text = fault.map(|fault| serde_json::to_string(fault).unwrap_or_default());
        text.into_iter().fold(run, |run, text| run.env(FAULT_VARIABLE, text))
    }

    /// Plants the GPU time of frames, directly below ours, and runs no command of them; [`Outcome::costs`] has the frames.
    pub fn planted(mut self, costs: &PlantedCosts) -> Self {
        self.test_layers.insert(0, TestLayer::Costs);
        // Structures of numbers always serialise.
        self.env(COSTS_VARIABLE, serde_json::to_string(costs).unwrap_or_default())
    }

    /// Counts live objects and device memory, directly below ours; [`Outcome::live_objects`] has the counts.
    pub fn live_counted(mut self) -> Self {
        self.test_layers.insert(0, TestLayer::Live);
        self.env(&TestLayer::Calls.implicit_variable(), "1")
    }

    /// Makes the runtime choose the first device whose name has this in it.
    pub fn device(mut self, name: &str) -> Self {
        name.clone_into(&mut self.scenario.vulkan.device);
        self
    }

    /// Sets the Vulkan driver; otherwise lavapipe.
    pub fn driver(mut self, driver: Driver) -> Self {
        self.driver = driver;
        self
    }

    /// Leaves out the barriers that match `pattern`, which [`DROP_BARRIER_VARIABLE`] describes.
    pub fn without_barrier(self, pattern: &str) -> Self {
        self.test_layer(TestLayer::DropBarrier).env(DROP_BARRIER_VARIABLE, pattern)
    }

    /// Makes the device look as if it had shading rates, below ours and above validation; [`Outcome::shading_rates`] has the passes with
    /// rates.
    pub fn shading_rates(self, profile: ShadingRateProfile) -> Self {
        self.test_layer(TestLayer::ShadingRate).env(SHADING_RATE_PROFILE_VARIABLE, profile.name())
    }

    /// If `wanted`, gives a device with only one queue a second one, below all other layers.
    pub fn two_queues(mut self, wanted: bool) -> Self {
        self.two_queues = wanted;
        self
    }

    /// Compiles the layer's pipelines on its thread, as for users. Otherwise a layer with debug assertions has each at once, so that its
    /// effect shows from the first frame on.
    pub fn compiling_in_background(mut self) -> Self {
        self.compiles_at_once = false;
        self
    }

    /// Sets a variable of the application's environment.
    pub fn env(mut self, name: &str, value: impl Into<OsString>) -> Self {
        self.environment.push((name.to_owned(), value.into()));
        self
    }

    /// Kills the application when it takes longer; otherwise after four minutes.
    pub fn timeout(mut self, timeout: Duration) -> Self {
        self.timeout = timeout;
        self
    }

    /// Ends the application's standard input when all frames of the scenario are submitted. hello_xr reads it in a thread of its
    /// own until its end, and newer C libraries (2.43) wait for that thread in `exit`.
    pub fn closing_input(mut self) -> Self {
        self.closes_input = true;
        self
    }

    /// Runs it to its end.
    ///
    /// # Errors
    /// Errors of the harness only; the application's errors are in the outcome.
    pub fn finish(self) -> Result<Outcome, HarnessError> {
        self.start()?.finish()
    }

    /// Starts it.
    ///
    /// # Errors
    /// As for [`Self::finish`].
    pub fn start(self) -> Result<Running, HarnessError> {
        let kept = artifacts::target_folder()?.join("tmp");
        let folder = Folder::new(&kept)?;
        let installation = Installation::new(folder.path(), &self.halves(folder.path())?)?;
        if let Some(config) = self.layer.config() {
            write(&installation.config_file(), config)?;
        }
        let scenario = folder.path().join("scenario.toml");
        let text = toml::to_string(&self.scenario).map_err(|error| HarnessError::format(&scenario, error))?;
        write(&scenario, &text)?;

        let mut command = self.driver.command(&self.application.program)?;
        command.args(&self.application.arguments).current_dir(folder.path()).env_clear();
        command.envs(installation.private_environment(self.driver)?).env("PARAFOVEA_MOCK_SCENARIO", scenario);
        command.envs(self.layer.config().map(|_| ("PARAFOVEA", "1")));
        // Shared by all runs: to compile an application's shaders takes lavapipe as long as the rest of a short run.
        command.env("MESA_SHADER_CACHE_DIR", kept.join("shaders"));
        let mut vulkan_layers: Vec<String> = self.test_layers.iter().map(|layer| layer.name()).collect();
        if self.validation {
            vulkan_layers.push(VALIDATION_LAYER.to_owned());
            command.envs(validation::environment(folder.path())?);
        }
        vulkan_layers.extend(self.two_queues.then(|| TestLayer::TwoQueues.name()));
        command.env("VK_INSTANCE_LAYERS", vulkan_layers.join(":"));
        command.env(COUNT_FILE_VARIABLE, folder.path().join(COUNT_FILE));
        command.env(SAMPLES_FILE_VARIABLE, folder.path().join(SAMPLES_FILE));
        command.env(FAULT_FILE_VARIABLE, folder.path().join(FAULT_FILE));
        command.env(LIVE_FILE_VARIABLE, folder.path().join(LIVE_FILE));
        command.env(TIMES_FILE_VARIABLE, folder.path().join(TIMES_FILE));
        command.env(COSTS_FILE_VARIABLE, folder.path().join(COSTS_FILE));
        command.env(SHADING_RATE_FILE_VARIABLE, folder.path().join(SHADING_RATE_FILE));
        command.envs(self.compiles_at_once.then_some((COMPILE_AT_ONCE_VARIABLE, "1")));
        command.envs(self.environment.iter().map(|(name, value)| (name, value)));
        let child = Child::start(command, folder.path(), self.timeout)?;
        Ok(Running { run: self, folder, installation, child })
    }

    fn halves(&self, folder: &Path) -> Result<Halves, HarnessError> {
        let library = match (&self.library, self.has_audio_library) {
            (Some(library), _) => library.clone(),
            (None, true) => link_with_audio_library(folder)?,
            (None, false) => Library::Parafovea.path()?,
        };
        let mut halves = Halves {
            openxr: Some(library.clone()),
            vulkan: Some(library.clone()),
            offers_gaze: self.offers_gaze,
        };
        if self.copies {
            for (name, half) in
                [("copy_openxr.so", &mut halves.openxr), ("copy_vulkan.so", &mut halves.vulkan)]
            {
                let copy = folder.join(name);
                std::fs::copy(&library, &copy).map_err(HarnessError::file(&copy))?;
                *half = Some(copy);
            }
        }
        if matches!(self.layer, LayerMode::Absent | LayerMode::VulkanHalf(_)) {
            halves.openxr = None;
        }
        if matches!(self.layer, LayerMode::Absent | LayerMode::OpenXrHalf(_)) {
            halves.vulkan = None;
        }
        Ok(halves)
    }
}

/// Puts the layer and the sound capture library beside each other, as they are installed.
fn link_with_audio_library(folder: &Path) -> Result<PathBuf, HarnessError> {
    let link = |from: PathBuf, name: &str| {
        let to = folder.join(name);
        std::fs::hard_link(&from, &to).map_err(HarnessError::file(&to)).map(|()| to)
    };
    link(Library::Audio.path()?, AUDIO_LIBRARY_NAME)?;
    link(Library::Parafovea.path()?, LIBRARY_NAME)
}

/// Read by a layer with debug assertions: its pipelines are compiled where they are asked for.
const COMPILE_AT_ONCE_VARIABLE: &str = "PARAFOVEA_COMPILE_AT_ONCE";

/// Output file of the counting layer.
const COUNT_FILE: &str = "count.jsonl";

/// Output file of the layer that counts samples.
const SAMPLES_FILE: &str = "samples.jsonl";

/// Output file of the layer that makes calls fail.
const FAULT_FILE: &str = "faults.jsonl";

/// Output file of the layer that counts live objects.
const LIVE_FILE: &str = "live.jsonl";

/// Output file of the layer that times command buffers.
const TIMES_FILE: &str = "times.jsonl";

/// Output file of the layer that plants costs.
const COSTS_FILE: &str = "costs.jsonl";

/// Output file of the layer that stands in for shading rates, in the run's folder.
const SHADING_RATE_FILE: &str = "shading_rates.jsonl";
