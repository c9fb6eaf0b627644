//! Programs that are run.

use crate::HarnessError;
use crate::artifacts::{program, system_program};
use std::path::{Path, PathBuf};

/// The program.
#[derive(Clone, Debug)]
pub struct Application {
    pub(super) name: String,
    pub(super) program: PathBuf,
    pub(super) arguments: Vec<String>,
}

impl Application {
    /// Khronos' hello_xr as the system's packages have it, with the graphics plug-in `Vulkan` or `Vulkan2`.
    ///
    /// # Errors
    /// [`HarnessError::NotInstalled`].
    pub fn hello_xr(graphics: &str) -> Result<Self, HarnessError> {
        let arguments = vec!["--graphics".to_owned(), graphics.to_owned()];
        Ok(Self { name: "hello_xr".to_owned(), program: system_program("hello_xr")?, arguments })
    }

    /// A program of this workspace.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`].
    pub fn ours(name: &str, arguments: &[&str]) -> Result<Self, HarnessError> {
        let arguments = arguments.iter().map(|argument| (*argument).to_owned()).collect();
        Ok(Self { name: name.to_owned(), program: program(name)?, arguments })
    }

    /// A program of the system.
    ///
    /// # Errors
    /// [`HarnessError::NotInstalled`].
    pub fn of_system(name: &str, arguments: &[&str]) -> Result<Self, HarnessError> {
        let arguments = arguments.iter().map(|argument| (*argument).to_owned()).collect();
        Ok(Self { name: name.to_owned(), program: system_program(name)?, arguments })
    }

    /// A program in a file of this path, for instance of an unpacked system.
    pub fn at(path: &Path, arguments: &[String]) -> Self {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Self { name, program: path.to_owned(), arguments: arguments.to_vec() }
    }

    /// The same, started by a program of the system such as strace, with these arguments before it.
    ///
    /// # Errors
    /// [`HarnessError::NotInstalled`].
    pub fn under(self, program: &str, arguments: &[&str]) -> Result<Self, HarnessError> {
        let before = arguments.iter().map(|argument| (*argument).to_owned());
        let own = std::iter::once(self.program.to_string_lossy().into_owned()).chain(self.arguments);
        Ok(Self {
            name: self.name,
            program: system_program(program)?,
            arguments: before.chain(own).collect(),
        })
    }

    /// Its name in tables and results.
    pub fn name(&self) -> &str {
        &self.name
    }
}
