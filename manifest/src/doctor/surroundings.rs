//! Surroundings of the program: everything outside of it that findings depend on.

use super::Probed;
use crate::config::Names;
use crate::paths::Environment;
use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Everything that findings depend on, apart from the content of files.
#[derive(Clone, Debug)]
pub struct Surroundings {
    variables: HashMap<OsString, OsString>,
    /// Locations of the user's files, by these variables.
    pub environment: Environment,
    /// Root of the file system: `/`.
    pub root: PathBuf,
    /// The library that came with this program, which `--fix` installs.
    pub shipped: Option<PathBuf>,
    /// Path of this program, for commands that another user is to type.
    pub program: PathBuf,
    /// The application whose configuration is looked at; `None`: any without a file of its own.
    pub application: Option<Names>,
    /// Answers of Vulkan and OpenXR.
    pub probed: Probed,
}

impl Surroundings {
    /// Surroundings of a process with these environment variables.
    pub fn new(root: &Path, variables: impl IntoIterator<Item = (OsString, OsString)>) -> Self {
        let variables: HashMap<_, _> = variables.into_iter().collect();
        let environment = Environment::new(false, |name| variables.get(OsStr::new(name)).cloned());
        Self {
            variables,
            environment,
            root: root.to_owned(),
            shipped: None,
            program: "parafovea".into(),
            application: None,
            probed: Probed::default(),
        }
    }

    /// A variable's value, where it is set; it may be empty.
    pub(super) fn set(&self, name: &str) -> Option<&OsStr> {
        self.variables.get(OsStr::new(name)).map(OsString::as_os_str)
    }

    /// A variable's value, where it is not empty.
    pub(super) fn variable(&self, name: &str) -> Option<&OsStr> {
        self.set(name).filter(|value| !value.is_empty())
    }

    /// The paths of a variable that lists some, or these of the system where it does not.
    pub(super) fn paths_or(&self, name: &str, system: &[&str]) -> Vec<PathBuf> {
        match self.variable(name) {
            Some(list) => std::env::split_paths(list).filter(|path| !path.as_os_str().is_empty()).collect(),
            None => system.iter().map(|path| self.system(path)).collect(),
        }
    }

    /// A path of the system: `/etc` and such.
    pub(super) fn system(&self, path: &str) -> PathBuf {
        self.root.join(path.trim_start_matches('/'))
    }

    /// The command that runs this program as root, whose `PATH` seldom has it.
    pub(super) fn as_root(&self, arguments: &str) -> String {
        format!("sudo {} {arguments}", word(&self.program))
    }

    /// The command that runs this program, which may be outside of `PATH`, with another folder for data files.
    pub(super) fn with_data(&self, data: &Path, arguments: &str) -> String {
        format!("XDG_DATA_HOME={} {} {arguments}", word(data), word(&self.program))
    }

    /// A shared library by its name, as the dynamic linker would probably find it. The linker's own cache is not read: of
    /// unusual places only `LD_LIBRARY_PATH` is known.
    pub(super) fn library(&self, name: &str) -> Option<PathBuf> {
        let multiarch = format!("/usr/lib/{}-linux-gnu", std::env::consts::ARCH);
        let system = ["/usr/local/lib", &multiarch, "/usr/lib64", "/usr/lib", "/lib64", "/lib"];
        let listed = self.paths_or("LD_LIBRARY_PATH", &[]);
        listed
            .into_iter()
            .chain(system.iter().map(|folder| self.system(folder)))
            .map(|folder| folder.join(name))
            .find(|path| path.is_file())
    }
}

/// A path as one word of a shell.
fn word(path: &Path) -> String {
    let path = path.display().to_string();
    if path.contains([' ', '\'']) { format!("{path:?}") } else { path }
}
