//! Configuration files of the user.

use super::Failure;
use parafovea_manifest::config::{Names, Places};
use parafovea_manifest::paths::{Environment, file_stem};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Name for all applications without a file of their own.
pub const ALL: &str = "all";

/// The files of this user.
pub struct Files {
    environment: Environment,
}

/// An application, or all of them.
pub struct Target {
    /// As it was typed.
    pub name: String,
    /// Its names; `None` for all applications.
    names: Option<Names>,
    /// Whether it has run with Parafovea.
    has_run: bool,
}

/// An existing file.
pub struct Found {
    /// Application that it is for.
    pub application: String,
    /// Its path.
    pub path: PathBuf,
}

impl Files {
    /// As the variables of this process have them.
    pub fn of_process() -> Self {
        Self { environment: Environment::of_process(false) }
    }

    fn folder(&self) -> Option<PathBuf> {
        Some(self.environment.config_home()?.join("parafovea"))
    }

    /// The application that `name` means; a path is no name, unless an application gave it to OpenXR.
    ///
    /// # Errors
    /// The name cannot be used.
    pub fn target(&self, name: &str) -> Result<Target, Failure> {
        if name == ALL {
            return Ok(Target { name: name.to_owned(), names: None, has_run: true });
        }
        let known = Names::known(&self.environment, name, SystemTime::now());
        if known.is_none() && name.contains('/') {
            return Err(Failure::IsPath(name.to_owned()));
        }
        file_stem(name).ok_or_else(|| Failure::NoName(name.to_owned()))?;
        let has_run = known.is_some();
        let names = known.unwrap_or_else(|| Names::unknown(name));
        Ok(Target { name: name.to_owned(), names: Some(names), has_run })
    }

    /// The file that is to be changed for an application: the first of its own files that exists, else a new one by the name that was typed.
    ///
    /// # Errors
    /// There is no folder for files.
    pub fn own(&self, target: &Target) -> Result<PathBuf, Failure> {
        let folder = self.folder().ok_or(Failure::NoHome)?;
        let Some(names) = &target.names else { return Ok(folder.join("config.toml")) };
        let file = |name: &OsStr| Some(folder.join("apps").join(format!("{}.toml", file_stem(name)?)));
        let own = [names.application.as_ref().map(OsStr::new), names.executable.file_name()];
        let existing = own.into_iter().flatten().filter_map(file).find(|file| exists(file));
        existing
            .or_else(|| file(OsStr::new(&target.name)))
            .ok_or_else(|| Failure::NoName(target.name.clone()))
    }

    /// The file that holds for an application; `None`: the defaults do.
    pub fn in_force(&self, target: &Target) -> Option<PathBuf> {
        let names = target.names.clone().unwrap_or_default();
        let places = Places::new(&self.environment, names.application.as_deref(), &names.executable);
        places.in_force().map(Path::to_owned)
    }

    /// The rest of a sentence about a file that was copied for an application: whether it still applies to that.
    pub fn applies(&self, from: &Path, target: &Target) -> String {
        if self.environment.config_file() == Some(from) {
            String::new()
        } else {
            format!(", which no longer applies to {}", target.name)
        }
    }

    /// A line about the file that applies to an application in the place of `changed`; `None` if that one does.
    pub fn shadow(&self, changed: &Path, target: &Target) -> Option<String> {
        let other = self.in_force(target).filter(|file| file != changed)?;
        Some(format!(
            "Without effect for now: PARAFOVEA_CONFIG is set, and its file, {}, applies instead.\n",
            other.display()
        ))
    }

    /// A line about a file that is for an OpenXR name while another name was typed: OpenVR games below xrizer share one. `None` for other
    /// files.
    pub fn shared(&self, changed: &Path, target: &Target) -> Option<String> {
        let names = target.names.as_ref()?;
        let application = names.application.as_ref().filter(|name| **name != target.name)?;
        (changed.file_stem()? == OsStr::new(&file_stem(application)?))
            .then(|| format!("This file applies to all applications with the OpenXR name {application:?}.\n"))
    }

    /// A line about a name that no application has had so far, which may be misspelt; `None` for a known one.
    pub fn unknown(&self, target: &Target) -> Option<String> {
        if target.has_run {
            return None;
        }
        let similar = Names::similar(&self.environment, &target.name, SystemTime::now());
        let similar: Vec<String> = similar.iter().map(|name| format!("{name:?}")).collect();
        let similar = match similar.as_slice() {
            [] => String::new(),
            names => format!("; similar names: {}", names.join(", ")),
        };
        Some(format!("No application of this name has run with Parafovea yet{similar}.\n"))
    }

    /// Existing files: of single applications by name, then of all.
    pub fn existing(&self) -> Vec<Found> {
        let apps = self.folder().map(|folder| folder.join("apps"));
        let entries = apps.and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
        let mut found: Vec<Found> = entries
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
            .filter_map(|path| {
                Some(Found { application: path.file_stem()?.to_string_lossy().into_owned(), path })
            })
            .collect();
        found.sort_by(|one, other| one.application.cmp(&other.application));
        let places = Places::new(&self.environment, None, Path::new(""));
        let shared = places.files().iter().filter(|file| exists(file));
        found.extend(shared.map(|file| Found { application: "all others".to_owned(), path: file.clone() }));
        found
    }
}

/// Whether there is a file, or a link to one that is gone.
fn exists(file: &Path) -> bool {
    fs::symlink_metadata(file).is_ok()
}
