//! One thing that was found.

use crate::config::offers_gaze;
use crate::install::{InstallError, Step, plan_install};
use std::fmt;
use std::path::PathBuf;

use super::Surroundings;

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// As it should be.
    Good,
    /// Worth knowing.
    Note,
    /// Something works less well than it could.
    Warning,
    /// Parafovea does nothing, or something else than configured.
    Problem,
}

impl Severity {
    /// Its name, as it is printed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Problem => "problem",
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A repair without a question: it changes only Parafovea's own files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fix {
    /// As `parafovea install` does.
    Install,
    /// Takes the permission to write from everybody but the owner.
    Restrict(PathBuf),
}

impl Fix {
    /// Its steps.
    ///
    /// # Errors
    /// As for [`plan_install`].
    pub fn plan(&self, surroundings: &Surroundings) -> Result<Vec<Step>, InstallError> {
        match self {
            Self::Install => match (surroundings.environment.data_home(), &surroundings.shipped) {
                (Some(data), Some(library)) => {
                    plan_install(data, library, offers_gaze(&surroundings.environment))
                }
                _ => Ok(Vec::new()),
            },
            Self::Restrict(path) => Ok(vec![Step::Restrict(path.clone())]),
        }
    }
}

/// One thing that was found. Texts are single lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Its kind: a name for scripts, which stays the same.
    pub id: &'static str,
    /// Its severity.
    pub severity: Severity,
    /// The observation.
    pub found: String,
    /// Its meaning.
    pub means: String,
    /// The advice; empty where nothing is to be done.
    pub advice: String,
    /// The repair by `--fix`.
    pub fix: Option<Fix>,
}

impl Finding {
    pub(super) fn new(
        severity: Severity,
        id: &'static str,
        found: impl Into<String>,
        means: impl Into<String>,
    ) -> Self {
        Self { id, severity, found: found.into(), means: means.into(), advice: String::new(), fix: None }
    }

    pub(super) fn problem(id: &'static str, found: impl Into<String>, means: impl Into<String>) -> Self {
        Self::new(Severity::Problem, id, found, means)
    }

    pub(super) fn warning(id: &'static str, found: impl Into<String>, means: impl Into<String>) -> Self {
        Self::new(Severity::Warning, id, found, means)
    }

    pub(super) fn note(id: &'static str, found: impl Into<String>, means: impl Into<String>) -> Self {
        Self::new(Severity::Note, id, found, means)
    }

    /// A name that no application has had so far, which may be misspelt; these names are `similar`.
    pub fn unknown_application(name: &str, similar: &[String]) -> Self {
        let found = format!("no application named {name:?} has run with Parafovea yet");
        let means = "The settings for this name were checked; the application may have another name.";
        let advice = match similar {
            [] => String::new(),
            names => format!("similar names: {}", names.join(", ")),
        };
        Self::note("unknown-application", found, means).advise(advice)
    }

    pub(super) fn good(id: &'static str, found: impl Into<String>) -> Self {
        Self::new(Severity::Good, id, found, "")
    }

    pub(super) fn advise(self, advice: impl Into<String>) -> Self {
        Self { advice: advice.into(), ..self }
    }

    pub(super) fn fixed_by(self, fix: Fix) -> Self {
        Self { fix: Some(fix), ..self }
    }

    pub(super) fn fixed_if(self, can: bool, fix: Fix) -> Self {
        if can { self.fixed_by(fix) } else { self }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:8} {}", self.severity, self.found)?;
        if !self.means.is_empty() {
            write!(f, "\n         {}", self.means)?;
        }
        if !self.advice.is_empty() {
            write!(f, "\n         To do: {}", self.advice)?;
        }
        Ok(())
    }
}
