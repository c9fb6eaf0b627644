//! The devices that the shims fake, and how a program is started on one.

use crate::HarnessError;
use crate::artifacts::target_folder;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with unpacked drivers, made by `cargo dev setup` or `cargo dev drivers`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Folder {
    /// `target/drivers/release`: drivers of this machine's Debian release or of its backports, for this machine's loaders.
    Release,
    /// `target/drivers/sid`: Debian sid's drivers, loaders, validation and C library.
    Sid,
}

impl Folder {
    /// Its name below `target/drivers`.
    pub fn name(self) -> &'static str {
        match self {
            Folder::Release => "release",
            Folder::Sid => "sid",
        }
    }

    /// The folder.
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`] where it was not made.
    pub fn path(self) -> Result<PathBuf, HarnessError> {
        let path = target_folder()?.join("drivers").join(self.name());
        // Written last, when everything is unpacked.
        if path.join(PACKAGES_FILE).is_file() { Ok(path) } else { Err(HarnessError::NoDriver { path }) }
    }

    /// The driver manifest that begins with `prefix`.
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`]; [`HarnessError::File`] where the folder is incomplete.
    pub fn manifest(self, prefix: &str) -> Result<PathBuf, HarnessError> {
        file_of_prefix(&self.path()?.join("usr/share/vulkan/icd.d"), prefix)
    }

    /// The variable by which programs started by [`Self::command`] find this folder's libraries and layers.
    ///
    /// # Errors
    /// As for [`Self::manifest`].
    pub fn environment(self) -> Result<(&'static str, OsString), HarnessError> {
        let folder = self.path()?;
        Ok(match self {
            Folder::Release => {
                let mut path = libraries(&folder).into_os_string();
                if let Some(before) = std::env::var_os("LD_LIBRARY_PATH") {
                    path.push(":");
                    path.push(before);
                }
                ("LD_LIBRARY_PATH", path)
            }
            // Loaders find explicit layers here. Programs of this machine's C library must not find sid's libraries: the
            // library path is a part of the command.
            Folder::Sid => ("XDG_DATA_DIRS", folder.join("usr/share").into_os_string()),
        })
    }

    /// A command that runs `program` on the libraries of this folder.
    ///
    /// # Errors
    /// As for [`Self::manifest`].
    pub fn command(self, program: &Path) -> Result<Command, HarnessError> {
        if self == Folder::Release {
            return Ok(Command::new(program));
        }
        let libraries = libraries(&self.path()?);
        let mut command = Command::new(file_of_prefix(&libraries, "ld-linux-")?);
        let mut path = libraries.clone().into_os_string();
        // Folders that libraries name by absolute paths: SDL needs the first, Qt the second.
        for folder in ["pulseaudio", "libproxy"] {
            path.push(":");
            path.push(libraries.join(folder));
        }
        command.arg("--library-path").arg(path).arg("--argv0").arg(program).arg(program);
        Ok(command)
    }

    /// The folder of its libraries.
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`].
    pub fn libraries(self) -> Result<PathBuf, HarnessError> {
        self.path().map(|folder| libraries(&folder))
    }

    /// The version of a package in it, as Debian writes it.
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`]; [`HarnessError::File`] where the list of packages cannot be read;
    /// [`HarnessError::Format`] where the package is not in it.
    pub fn version(self, package: &str) -> Result<String, HarnessError> {
        let list = self.path()?.join(PACKAGES_FILE);
        let text = std::fs::read_to_string(&list).map_err(HarnessError::file(&list))?;
        let mut packages = text.lines().filter_map(|line| line.split_once('='));
        let found = packages.find(|(name, _)| *name == package);
        found
            .map(|(_, version)| version.to_owned())
            .ok_or_else(|| HarnessError::format(&list, format!("it does not list {package}")))
    }
}

/// The list of unpacked packages in each folder, `name=version` a line.
const PACKAGES_FILE: &str = "packages";

/// A device that a shim fakes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShimDevice {
    /// RADV, Radeon RX 5700 (RDNA 1): no shading rates.
    Navi10,
    /// RADV, Radeon RX 6800 (RDNA 2).
    Navi21,
    /// RADV, Radeon RX 7900 (RDNA 3).
    Navi31,
    /// RADV, Steam Deck (RDNA 2).
    Vangogh,
    /// RADV, Radeon RX 9070 (RDNA 4).
    Gfx1201,
    /// NVK, GeForce RTX 2080 (Turing, chipset TU104).
    NvkTuring,
    /// NVK, GeForce RTX 3090 (Ampere, chipset GA102).
    NvkAmpere,
    /// Turnip, Adreno 750.
    Turnip750,
}

impl ShimDevice {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Navi10,
        Self::Navi21,
        Self::Navi31,
        Self::Vangogh,
        Self::Gfx1201,
        Self::NvkTuring,
        Self::NvkAmpere,
        Self::Turnip750,
    ];

    /// Its name in tables and on command lines.
    pub fn name(self) -> &'static str {
        match self {
            Self::Navi10 => "navi10",
            Self::Navi21 => "navi21",
            Self::Navi31 => "navi31",
            Self::Vangogh => "vangogh",
            Self::Gfx1201 => "gfx1201",
            Self::NvkTuring => "nvk-turing",
            Self::NvkAmpere => "nvk-ampere",
            Self::Turnip750 => "turnip-750",
        }
    }

    /// The device of that name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|device| device.name() == name)
    }

    /// The folder with its driver.
    pub fn folder(self) -> Folder {
        match self {
            Self::Navi10 | Self::Navi21 | Self::Navi31 | Self::Vangogh => Folder::Release,
            Self::Gfx1201 | Self::NvkTuring | Self::NvkAmpere | Self::Turnip750 => Folder::Sid,
        }
    }

    /// Whether its driver has `VK_KHR_fragment_shading_rate`.
    pub fn has_rates(self) -> bool {
        self != Self::Navi10
    }

    /// The shim's library, the variable that chooses the device, its value, and the start of the driver manifest's name.
    fn parts(self) -> [&'static str; 4] {
        let radv = |family| ["libamdgpu_noop_drm_shim.so", "AMDGPU_GPU_ID", family, "radeon_icd"];
        // The value is the chipset's id (Mesa: src/nouveau/drm-shim/nouveau_noop.c).
        let nvk = |chipset| ["libnouveau_noop_drm_shim.so", "NOUVEAU_CHIPSET", chipset, "nouveau_icd"];
        match self {
            Self::Navi10 => radv("navi10"),
            Self::Navi21 => radv("navi21"),
            Self::Navi31 => radv("navi31"),
            Self::Vangogh => radv("vangogh"),
            Self::Gfx1201 => radv("gfx1201"),
            Self::NvkTuring => nvk("0x164"),
            Self::NvkAmpere => nvk("0x172"),
            Self::Turnip750 => ["libfreedreno_noop_drm_shim.so", "FD_GPU_ID", "750", "freedreno_icd"],
        }
    }

    /// The variables that make a program started by [`Folder::command`] find this device, and no other.
    ///
    /// # Errors
    /// [`HarnessError::NoDriver`]; [`HarnessError::File`] where the folder is incomplete.
    pub fn environment(self) -> Result<Vec<(&'static str, OsString)>, HarnessError> {
        let [shim, variable, value, manifest] = self.parts();
        let folder = self.folder().path()?;
        let libraries = libraries(&folder);
        let manifest = self.folder().manifest(manifest)?;
        let mut variables = vec![
            ("LD_PRELOAD", libraries.join(shim).into_os_string()),
            (variable, value.into()),
            // The first is the loader's name for it since 1.3.207, the second the one before.
            ("VK_DRIVER_FILES", manifest.clone().into_os_string()),
            ("VK_ICD_FILENAMES", manifest.into_os_string()),
        ];
        variables.push(self.folder().environment()?);
        Ok(variables)
    }
}

/// Debian's folder of libraries for this architecture.
fn libraries(folder: &Path) -> PathBuf {
    folder.join("usr/lib").join(format!("{}-linux-gnu", std::env::consts::ARCH))
}

/// The first file with that prefix: names of manifests and of the program loader differ by release and architecture.
fn file_of_prefix(folder: &Path, prefix: &str) -> Result<PathBuf, HarnessError> {
    let files = std::fs::read_dir(folder).map_err(HarnessError::file(folder))?;
    let has_prefix = |name: &OsStr| name.to_string_lossy().starts_with(prefix);
    let mut names: Vec<OsString> =
        files.flatten().map(|file| file.file_name()).filter(|name| has_prefix(name)).collect();
    names.sort();
    let first = names.into_iter().next();
    first.map(|name| folder.join(name)).ok_or_else(|| {
        let missing = std::io::Error::new(std::io::ErrorKind::NotFound, format!("no file {prefix}*"));
        HarnessError::file(folder)(missing)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_their_devices() {
        for device in ShimDevice::ALL {
            assert_eq!(ShimDevice::of_name(device.name()), Some(device));
        }
        assert_eq!(ShimDevice::of_name("navi"), None);
    }

    #[test]
    fn the_first_file_of_a_prefix_is_found_and_a_missing_one_named() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["radeon_icd.x86_64.json", "radeon_icd.i686.json", "lvp_icd.json"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = file_of_prefix(folder.path(), "radeon_icd").unwrap();
        assert_eq!(found, folder.path().join("radeon_icd.i686.json"));
        let error = file_of_prefix(folder.path(), "nouveau_icd").unwrap_err();
        assert!(error.to_string().contains("no file nouveau_icd*"), "{error}");
    }
}
