//! A folder in which everything is installed as on a user's machine, and the environment that leads to it.
//!
//! The loaders find layers through `XDG_DATA_HOME`, configuration and logs through `XDG_CONFIG_HOME` and
//! `XDG_STATE_HOME`, the runtime through `XR_RUNTIME_JSON`. No part of the surrounding environment that could
//! change their behaviour is passed on.

use crate::HarnessError;
use crate::artifacts::Library;
use crate::drivers::{Folder, ShimDevice};
use parafovea_manifest::install::stage;
use parafovea_manifest::json::Half;
use parafovea_mock_runtime::write_runtime_manifest;
use parafovea_test_layers::TestLayer;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Installed halves of the layer, with the libraries of their manifests.
#[derive(Clone, Default, Debug)]
pub struct Halves {
    /// The library that the OpenXR manifest names.
    pub openxr: Option<PathBuf>,
    /// The library that the Vulkan manifest names.
    pub vulkan: Option<PathBuf>,
    /// Whether the OpenXR loader lists eye gaze, as after `parafovea install` with `gaze.offer = true`.
    pub offers_gaze: bool,
}

/// A folder with everything installed below it.
pub struct Installation {
    folder: PathBuf,
    runtime_manifest: PathBuf,
}

/// The Vulkan driver that applications find.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Driver {
    /// lavapipe, where it is installed: the same pictures on every machine.
    #[default]
    Lavapipe,
    /// Access to the system's real GPUs.
    System,
    /// lavapipe of unpacked drivers. Programs must be started by [`Driver::command`].
    UnpackedLavapipe(Folder),
    /// One of Mesa's real drivers over a shim of the kernel's device. Programs must be started by [`Driver::command`].
    Shim(ShimDevice),
}

impl Driver {
    /// Folders with the explicit layers that programs find with this driver, besides the test layers.
    pub(crate) fn data_folders(self) -> Vec<PathBuf> {
        match self {
            Driver::UnpackedLavapipe(Folder::Sid) => sid_data(),
            Driver::Shim(device) if device.folder() == Folder::Sid => sid_data(),
            _ => ["/usr/share", "/usr/local/share", "/etc"].map(PathBuf::from).into(),
        }
    }

    /// A command that runs `program` where this driver can be loaded.
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`] where the driver is not unpacked.
    pub fn command(self, program: &Path) -> Result<Command, HarnessError> {
        match self {
            Driver::Lavapipe | Driver::System => Ok(Command::new(program)),
            Driver::UnpackedLavapipe(folder) => folder.command(program),
            Driver::Shim(device) => device.folder().command(program),
        }
    }
}

/// The data folder of sid, if it is unpacked.
fn sid_data() -> Vec<PathBuf> {
    Folder::Sid.path().into_iter().map(|folder| folder.join("usr/share")).collect()
}

/// The variable with the manifest of another driver than lavapipe's, for instance that of a newer one.
pub const DRIVER_VARIABLE: &str = "PARAFOVEA_TEST_DRIVER";

impl Installation {
    /// Installs the halves of the layer, the mock runtime and the test layers below `folder`.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`], [`HarnessError::File`].
    pub fn new(folder: &Path, halves: &Halves) -> Result<Self, HarnessError> {
        for part in ["home", "config/parafovea", "state", "cache", "runtime"] {
            let path = folder.join(part);
            std::fs::create_dir_all(&path).map_err(HarnessError::file(&path))?;
        }
        let data = folder.join("data");
        for (half, library) in [(Half::OpenXr, &halves.openxr), (Half::Vulkan, &halves.vulkan)] {
            if let Some(library) = library {
                stage(&data, half, library, halves.offers_gaze)?;
            }
        }
        let test_layers = Library::TestLayers.path()?;
        for layer in TestLayer::ALL {
            // Implicit layers from the configuration folder come above those from the data folder, and so these above ours.
            let is_above = matches!(layer, TestLayer::Above | TestLayer::Count | TestLayer::Calls);
            let (kind, manifest) = if is_above {
                ("config/vulkan/implicit_layer.d", layer.implicit_manifest(&test_layers))
            } else if layer == TestLayer::TwoQueues {
                ("lowest/vulkan/explicit_layer.d", layer.manifest(&test_layers))
            } else {
                ("data/vulkan/explicit_layer.d", layer.manifest(&test_layers))
            };
            write(&folder.join(kind).join(format!("{}.json", layer.stem())), &manifest)?;
        }
        let runtime_manifest = write_runtime_manifest(folder, &Library::MockRuntime.path()?)
            .map_err(HarnessError::file(folder))?;
        Ok(Self { folder: folder.to_owned(), runtime_manifest })
    }

    /// The configuration file that every application reads unless it has one of its own.
    pub fn config_file(&self) -> PathBuf {
        self.folder.join("config/parafovea/config.toml")
    }

    /// The folder with the layer's logs, one for each executable.
    pub fn log_folder(&self) -> PathBuf {
        self.folder.join("state/parafovea")
    }

    /// `$XDG_RUNTIME_DIR` of every application.
    pub fn runtime_folder(&self) -> PathBuf {
        self.folder.join("runtime")
    }

    /// The variable that makes the loaders look here too, besides where they would look anyway.
    pub fn search_path(&self) -> (&'static str, OsString) {
        let mut path = self.folder.join("data").into_os_string();
        path.push(":");
        // The default is the XDG base directory specification's.
        path.push(std::env::var_os("XDG_DATA_DIRS").unwrap_or_else(|| "/usr/local/share:/usr/share".into()));
        ("XDG_DATA_DIRS", path)
    }

    /// A whole environment for an application that is to run on the mock runtime and lavapipe, and find nothing
    /// of the user who runs it.
    ///
    /// # Errors
    /// As for [`Self::mock_environment`].
    pub fn private_environment(&self, driver: Driver) -> Result<Vec<(&'static str, OsString)>, HarnessError> {
        let folder = |part: &str| self.folder.join(part).into_os_string();
        let mut variables = vec![
            ("HOME", folder("home")),
            ("XDG_DATA_HOME", folder("data")),
            ("XDG_CONFIG_HOME", folder("config")),
            ("XDG_STATE_HOME", folder("state")),
            ("XDG_CACHE_HOME", folder("cache")),
            ("XDG_RUNTIME_DIR", folder("runtime")),
        ];
        // Both are how programs and libraries themselves are found.
        variables.extend(
            ["PATH", "LD_LIBRARY_PATH"].into_iter().filter_map(|name| Some((name, std::env::var_os(name)?))),
        );
        // Later entries replace earlier ones of the same name.
        variables.extend(self.mock_environment(driver)?);
        // Vulkan loaders up to 1.3.239 at least order explicit layers by their folders: validation is above the layers of the last one.
        let is_folders = |(name, _): &&(&str, OsString)| *name == "XDG_DATA_DIRS";
        let folders = variables.iter().rev().find(is_folders).map(|(_, folders)| folders.clone());
        let mut folders = folders.unwrap_or_else(|| "/usr/local/share:/usr/share".into());
        folders.push(":");
        folders.push(folder("lowest"));
        variables.push(("XDG_DATA_DIRS", folders));
        Ok(variables)
    }

    /// The variables that choose the mock runtime and the driver: lavapipe where there is one, or that of
    /// [`DRIVER_VARIABLE`].
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`] where the driver of a [`Driver::Shim`] is not unpacked.
    pub fn mock_environment(&self, driver: Driver) -> Result<Vec<(&'static str, OsString)>, HarnessError> {
        let mut variables = vec![("XR_RUNTIME_JSON", self.runtime_manifest.clone().into_os_string())];
        let manifest = match driver {
            Driver::Lavapipe => {
                std::env::var_os(DRIVER_VARIABLE).or_else(|| Some(lavapipe()?.into_os_string()))
            }
            Driver::System => None,
            Driver::UnpackedLavapipe(folder) => {
                variables.push(folder.environment()?);
                Some(folder.manifest("lvp_icd")?.into_os_string())
            }
            Driver::Shim(device) => {
                variables.extend(device.environment()?);
                None
            }
        };
        if let Some(manifest) = manifest {
            // The first is the loader's name for it since 1.3.207, the second is the one before.
            variables.push(("VK_DRIVER_FILES", manifest.clone()));
            variables.push(("VK_ICD_FILENAMES", manifest));
        }
        Ok(variables)
    }
}

/// The driver manifest of lavapipe, where it is installed.
fn lavapipe() -> Option<PathBuf> {
    let folders = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    let files = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let is_native = |name: &str| name.starts_with("lvp_icd") && !name.contains("i686");
    files
        .map(|file| file.path())
        .find(|path| path.file_name().is_some_and(|name| is_native(&name.to_string_lossy())))
}

/// Writes a file and the folders above it.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), HarnessError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(HarnessError::file(folder))?;
    }
    std::fs::write(path, text).map_err(HarnessError::file(path))
}
