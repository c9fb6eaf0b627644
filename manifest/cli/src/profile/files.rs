//! Configuration files of the user.

use super::Failure;
use parafovea_manifest::config::Places;
use parafovea_manifest::paths::{Environment, file_stem};
use std::fs;
use std::path::{Path, PathBuf};

/// Name for all applications without a file of their own.
pub const ALL: &str = "all";

/// The files of this user.
pub struct Files {
    environment: Environment,
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

    /// The file that is to be changed for an application.
    pub fn own(&self, application: &str) -> Result<PathBuf, Failure> {
        let folder = self.folder().ok_or(Failure::NoHome)?;
        if application == ALL {
            return Ok(folder.join("config.toml"));
        }
        let stem = file_stem(application).ok_or_else(|| Failure::NoName(application.to_owned()))?;
        Ok(folder.join("apps").join(format!("{stem}.toml")))
    }

    /// The file that holds for an application; `None`: the defaults do.
    pub fn in_force(&self, application: &str) -> Option<PathBuf> {
        let application = (application != ALL).then_some(application);
        let places = Places::new(&self.environment, application, Path::new(application.unwrap_or_default()));
        places.find(|file| fs::symlink_metadata(file).is_ok()).map(Path::to_owned)
    }

    /// The rest of a sentence about a file that was copied for an application: whether it still applies to that.
    pub fn applies(&self, from: &Path, application: &str) -> String {
        if self.environment.config_file() == Some(from) {
            "; PARAFOVEA_CONFIG names that file, so it still applies".to_owned()
        } else {
            format!(", which no longer applies to {application}")
        }
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
        let shared = places.files().iter().filter(|file| fs::symlink_metadata(file).is_ok());
        found.extend(shared.map(|file| Found { application: "all others".to_owned(), path: file.clone() }));
        found
    }
}
