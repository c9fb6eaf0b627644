//! The implicit layers that both loaders find, in the order in which they find them.
//!
//! Sources: OpenXR loader, `manifest_file.cpp` (`ReadDataFilesInSearchPaths`, `ApiLayerManifestFile::CreateIfValid`); Vulkan
//! loader, `LoaderLayerInterface.md`, "Linux Layer Discovery" and "Layer Manifest File Format".

use super::Surroundings;
use crate::json::{ENABLE_VARIABLE, Half};
use serde_json::Value;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Manifests of both halves' loaders.
pub struct Layers {
    openxr: Vec<Manifest>,
    vulkan: Vec<Manifest>,
    unreadable: Vec<UnreadableFolder>,
}

/// A folder of manifests that exists, but cannot be read.
pub struct UnreadableFolder {
    /// The half whose loader searches it.
    pub half: Half,
    /// Its path.
    pub path: PathBuf,
    /// The error of the system.
    pub reason: String,
}

/// A file that a loader reads.
pub struct Manifest {
    /// Its path.
    pub path: PathBuf,
    /// Its content.
    pub content: Result<Vec<Layer>, Unusable>,
}

/// Reason why a loader skips a manifest.
pub enum Unusable {
    /// It cannot be read.
    Unreadable(String),
    /// It is not a valid manifest.
    Malformed(String),
}

/// A layer of a manifest.
pub struct Layer {
    /// The loader's name for it.
    pub name: String,
    /// As it is written.
    pub library: String,
    /// Variables that enable it, each with the value that it must have, if that matters; none: it is enabled as it is.
    pub enable: Vec<(String, Option<String>)>,
    /// Variables that disable it.
    pub disable: Vec<String>,
    /// The name of the function that the loader calls first.
    pub negotiate: Option<String>,
}

impl Layers {
    /// Looks for all of them.
    pub fn find(surroundings: &Surroundings) -> Self {
        let mut unreadable = Vec::new();
        let mut of = |half| {
            let mut found = Vec::new();
            for path in folders(surroundings, half) {
                match manifests(half, &path) {
                    Ok(manifests) => found.extend(manifests),
                    Err(error) => unreadable.push(UnreadableFolder { half, path, reason: error.to_string() }),
                }
            }
            found
        };
        let (openxr, vulkan) = (of(Half::OpenXr), of(Half::Vulkan));
        Self { openxr, vulkan, unreadable }
    }

    /// Folders in which the loader of `half` may find more manifests.
    pub fn unreadable(&self, half: Half) -> impl Iterator<Item = &UnreadableFolder> {
        self.unreadable.iter().filter(move |folder| folder.half == half)
    }

    /// Manifests that the loader of `half` finds.
    pub fn of(&self, half: Half) -> &[Manifest] {
        match half {
            Half::OpenXr => &self.openxr,
            Half::Vulkan => &self.vulkan,
        }
    }

    /// Manifests of Parafovea, or with its file name.
    pub fn ours(&self, half: Half) -> impl Iterator<Item = &Manifest> {
        self.of(half).iter().filter(move |manifest| {
            let is_named = manifest.path.file_name() == Some(OsStr::new("parafovea.json"));
            is_named || manifest.layers().iter().any(|layer| layer.name == half.layer_name())
        })
    }

    /// The library of `half` that its loader loads.
    pub fn library(&self, surroundings: &Surroundings, half: Half) -> Option<PathBuf> {
        self.ours(half).find_map(|manifest| {
            let layer = manifest.layers().iter().find(|layer| layer.name == half.layer_name())?;
            layer.library_at(surroundings, &manifest.path)
        })
    }
}

impl Manifest {
    /// Its layers; none where it is unusable.
    pub fn layers(&self) -> &[Layer] {
        self.content.as_deref().unwrap_or_default()
    }
}

impl Layer {
    /// The file that the loader loads; `None` where it finds none.
    pub fn library_at(&self, surroundings: &Surroundings, manifest: &Path) -> Option<PathBuf> {
        if !self.library.contains('/') {
            return surroundings.library(&self.library);
        }
        Some(manifest.parent()?.join(&self.library)).filter(|path| path.is_file())
    }

    /// Whether it would be loaded into an application that is started with Parafovea.
    pub fn is_enabled(&self, surroundings: &Surroundings) -> bool {
        let value = |name: &str| match name {
            ENABLE_VARIABLE => Some(OsStr::new("1")),
            _ => surroundings.set(name),
        };
        let enables = |(name, wanted): &(String, Option<String>)| {
            value(name).is_some_and(|value| wanted.as_ref().is_none_or(|wanted| value == OsStr::new(wanted)))
        };
        let is_asked_for = self.enable.is_empty() || self.enable.iter().any(enables);
        is_asked_for && !self.disable.iter().any(|name| value(name).is_some())
    }
}

/// Folders that the loader of `half` searches, first place first.
fn folders(surroundings: &Surroundings, half: Half) -> Vec<PathBuf> {
    let environment = &surroundings.environment;
    let config_dirs = surroundings.paths_or("XDG_CONFIG_DIRS", &["/etc/xdg"]);
    let data_dirs = surroundings.paths_or("XDG_DATA_DIRS", &["/usr/local/share", "/usr/share"]);
    let system = [surroundings.system("/etc")];
    let home = |folder: Option<&Path>| folder.map(Path::to_owned).into_iter();
    match half {
        Half::OpenXr => config_dirs
            .into_iter()
            .chain(system)
            .chain(data_dirs)
            .chain(home(environment.data_home()))
            .map(|base| base.join("openxr/1/api_layers/implicit.d"))
            .collect(),
        Half::Vulkan => {
            let only = surroundings.paths_or("VK_IMPLICIT_LAYER_PATH", &[]);
            if !only.is_empty() {
                return only;
            }
            let standard = home(environment.config_home())
                .chain(config_dirs)
                .chain(system)
                .chain(home(environment.data_home()))
                .chain(data_dirs)
                .map(|base| base.join("vulkan/implicit_layer.d"));
            surroundings.paths_or("VK_ADD_IMPLICIT_LAYER_PATH", &[]).into_iter().chain(standard).collect()
        }
    }
}

/// The manifests of a folder, if it exists. Loaders take them as the file system lists them; here they are sorted.
fn manifests(half: Half, folder: &Path) -> io::Result<Vec<Manifest>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(Vec::new());
        }
        entries => entries?.flatten().map(|entry| entry.path()),
    };
    let mut paths: Vec<_> = entries.filter(|path| path.extension() == Some(OsStr::new("json"))).collect();
    paths.sort();
    Ok(paths.into_iter().map(|path| Manifest { content: read(half, &path), path }).collect())
}

fn read(half: Half, path: &Path) -> Result<Vec<Layer>, Unusable> {
    let text = fs::read_to_string(path).map_err(|error| Unusable::Unreadable(error.to_string()))?;
    let malformed = |reason: &str| Unusable::Malformed(reason.to_owned());
    let file: Value = serde_json::from_str(&text).map_err(|error| malformed(&error.to_string()))?;
    let members = match (half, &file["layer"], &file["layers"]) {
        (Half::OpenXr, ..) => vec![&file["api_layer"]],
        (Half::Vulkan, _, Value::Array(several)) => several.iter().collect(),
        (Half::Vulkan, one, _) => vec![one],
    };
    members
        .into_iter()
        .map(|member| layer(half, member).ok_or_else(|| malformed("a required member is missing")))
        .collect()
}

fn layer(half: Half, member: &Value) -> Option<Layer> {
    let text = |name: &str| Some(member[name].as_str()?.to_owned());
    let pairs = |name: &str| -> Vec<(String, Option<String>)> {
        match &member[name] {
            // OpenXR: the variable's name; its value does not matter.
            Value::String(variable) if half == Half::OpenXr => vec![(variable.clone(), None)],
            Value::Object(pairs) if half == Half::Vulkan => pairs
                .iter()
                .map(|(variable, value)| (variable.clone(), value.as_str().map(str::to_owned)))
                .collect(),
            _ => Vec::new(),
        }
    };
    let negotiate = match half {
        Half::OpenXr => "xrNegotiateLoaderApiLayerInterface",
        Half::Vulkan => "vkNegotiateLoaderLayerInterfaceVersion",
    };
    Some(Layer {
        name: text("name")?,
        // A meta-layer of Vulkan has none.
        library: text("library_path").or_else(|| (half == Half::Vulkan).then(String::new))?,
        enable: pairs("enable_environment"),
        disable: pairs("disable_environment").into_iter().map(|(variable, _)| variable).collect(),
        negotiate: member["functions"][negotiate].as_str().map(str::to_owned),
    })
}
