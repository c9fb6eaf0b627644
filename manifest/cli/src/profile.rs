//! `parafovea profile`: the configuration of each application.

mod edit;
mod effective;
mod files;
mod kinds;

use edit::{Change, EditError};
use effective::{Origin, effective};
use files::{Files, Target};
use parafovea_manifest::config::{self, ConfigErrors};
use parafovea_manifest::install::{InstallError, Step};
use parafovea_manifest::options::{OPTIONS, OptionSpec, keys_named};
use std::fmt::Write as _;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Tasks on configuration files.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// List configuration files, with their applications and errors
    List,
    /// Show an application's settings and their sources
    Show {
        /// OpenXR application name or executable name; `all` for applications without a file of their own
        application: String,
        /// Also show options at their defaults
        #[arg(long)]
        effective: bool,
    },
    /// Set an option in an application's file, and keep its comments
    Set {
        /// Application, as for show; `all` for config.toml
        application: String,
        /// Option, such as chroma.mode; `parafovea config default` lists all
        key: String,
        /// Value of the option
        #[arg(allow_hyphen_values = true)]
        value: String,
    },
    /// Remove an option from an application's file, and return to the value of the preset
    Unset {
        /// Application, as for show; `all` for config.toml
        application: String,
        /// Option to remove
        key: String,
    },
    /// Create a commented file with suitable settings for a kind of application
    New {
        /// Application, as for show
        application: String,
        /// Kind of application
        #[arg(value_parser = clap::builder::PossibleValuesParser::new(kinds::names()))]
        kind: String,
    },
    /// Check all configuration files
    Validate,
}

/// Reason why nothing was done.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(
        "no folder for profiles: neither XDG_CONFIG_HOME nor HOME is an absolute path; set HOME to your home folder"
    )]
    NoHome,
    #[error(
        "{0:?} is not an application name; allowed: the OpenXR application name, or the name of the executable"
    )]
    NoName(String),
    #[error(
        "{0} is a path; give the application's name for OpenXR, or the name of its executable without folders"
    )]
    IsPath(String),
    #[error("there is no option {0}; parafovea config default lists all{did_you_mean}", did_you_mean = near(.0))]
    NoOption(String),
    #[error("{}: {}", .0.display(), .1)]
    Read(PathBuf, std::io::Error),
    #[error("{} already exists; to change it: parafovea profile set", .0.display())]
    Exists(PathBuf),
    #[error("{}: {}", .0.display(), .1)]
    Edit(PathBuf, EditError),
    #[error("nothing was changed:\n{0}")]
    NotAllowed(ConfigErrors),
    #[error("the file has errors:\n{0}")]
    Invalid(ConfigErrors),
    #[error("{} is a link to {}, which is missing; create that file, or remove the link", .0.display(), .1.display())]
    LinkToNothing(PathBuf, PathBuf),
    #[error(transparent)]
    Write(#[from] InstallError),
}

fn near(key: &str) -> String {
    let name = key.rsplit('.').next().unwrap_or(key);
    let of_section = || OPTIONS.iter().find(|option| option.section == name).map(OptionSpec::key);
    keys_named(name).or_else(of_section).map(|keys| format!("; did you mean {keys}?")).unwrap_or_default()
}

/// Runs a task; prints its outcome.
pub fn profile(command: &Command) -> ExitCode {
    let files = Files::of_process();
    let done = match command {
        Command::List => list(&files),
        Command::Show { application, effective } => show(&files, application, *effective),
        Command::Set { application, key, value } => change(&files, application, key, Change::Set(value)),
        Command::Unset { application, key } => change(&files, application, key, Change::Unset),
        Command::New { application, kind } => new(&files, application, kind),
        Command::Validate => return validate(&files),
    };
    match done {
        Ok(text) => {
            crate::print(&text);
            ExitCode::SUCCESS
        }
        Err(failure) => {
            complain!("parafovea: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn list(files: &Files) -> Result<String, Failure> {
    let mut text = String::new();
    for file in files.existing() {
        let state = match config::load(&file.path) {
            Err(_) if config::missing_target(&file.path).is_some() => {
                "no effect: a link to a missing file".to_owned()
            }
            Ok(config) => {
                let count = fs::read_to_string(&file.path).map_or(0, |text| effective::set_in(&text).len());
                let preset = OPTIONS.iter().find(|option| option.key() == "preset");
                let preset = preset.map_or(String::new(), |option| option.value(&config));
                format!("preset {preset}, {count} option{} set", if count == 1 { "" } else { "s" })
            }
            Err(errors) => {
                format!(
                    "ignored because of errors ({}); to list them: parafovea profile validate",
                    errors.errors().len()
                )
            }
        };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}\n    {}: {state}", file.application, file.path.display());
    }
    if text.is_empty() {
        text = "no configuration file: defaults for all applications\n".to_owned();
    }
    let _ = writeln!(text, "Kinds, for parafovea profile new: {}", kinds::names().join(", "));
    Ok(text)
}

fn show(files: &Files, application: &str, all: bool) -> Result<String, Failure> {
    let file = files.in_force(&files.target(application)?);
    let (config, content) = match &file {
        None => (config::Config::default(), String::new()),
        Some(path) => {
            let content = fs::read_to_string(path).map_err(|error| Failure::Read(path.clone(), error))?;
            (config::load(path).map_err(Failure::Invalid)?, content)
        }
    };
    let mut text = match &file {
        Some(path) => format!("# {application}: {}\n", path.display()),
        None => format!("# {application}: no file, defaults\n"),
    };
    for value in effective(&config, &content) {
        let origin = match value.origin {
            Origin::File => "set in this file".to_owned(),
            Origin::Preset => format!("from preset {}", value.preset),
            Origin::Default if !all => continue,
            Origin::Default => "default".to_owned(),
        };
        let _ = writeln!(text, "{} = {}  # {origin}", value.option.key(), value.value);
    }
    if !all {
        text += "# All other options are at their defaults; --effective lists them.\n";
    }
    Ok(text)
}

fn change(files: &Files, application: &str, key: &str, change: Change<'_>) -> Result<String, Failure> {
    let option = option(key)?;
    let target = files.target(application)?;
    let path = files.own(&target)?;
    let own = read(&path)?;
    // An application with a file of its own does not look at the others: nothing else is to change for it.
    let from = match &own {
        Some(_) => None,
        None => files.in_force(&target),
    };
    let before = match (own, &from) {
        (Some(text), _) => text,
        (None, Some(from)) => read(from)?.unwrap_or_default(),
        (None, None) => String::new(),
    };
    // The text is that of the file that is copied, and so are its errors.
    let errors_of_copied = || from.as_ref().and_then(|from| config::load(from).err());
    let after = edit::apply(&before, option, change).map_err(|error| match errors_of_copied() {
        Some(errors) => Failure::NotAllowed(errors),
        None => Failure::Edit(path.clone(), error),
    })?;
    if matches!(change, Change::Unset) && after == before {
        let text = format!("{key} is not set for {application}; nothing was changed\n");
        return Ok(text + &files.unknown(&target).unwrap_or_default());
    }
    config::parse(&path, &after)
        .map_err(|errors| Failure::NotAllowed(errors_of_copied().unwrap_or(errors)))?;
    write(&path, after)?;
    let mut text = format!("{}: ", path.display());
    text += &match change {
        Change::Set(value) => format!("{key} = {}\n", value.trim()),
        Change::Unset => format!("{key} removed\n"),
    };
    if let Some(from) = from {
        let _ = writeln!(
            text,
            "This new file starts as a copy of {}{}.",
            from.display(),
            files.applies(&from, &target)
        );
    }
    Ok(text + &notes(files, &path, &target))
}

/// Writes the kind's file, with the other settings of the file in force: only one file applies to an application.
fn new(files: &Files, application: &str, kind: &str) -> Result<String, Failure> {
    let target = files.target(application)?;
    let path = files.own(&target)?;
    if read(&path)?.is_some() {
        return Err(Failure::Exists(path));
    }
    let mut text = kinds::file(kind);
    let mut outcome = format!("{}: created, with settings for {kind}\n", path.display());
    if let Some(from) = files.in_force(&target) {
        let before = read(&from)?.unwrap_or_default();
        let config = config::load(&from).map_err(Failure::Invalid)?;
        // A default in the kind's file explains, and does not overrule a setting of the user.
        let overrules = |option: &OptionSpec| kinds::changes(kind, option);
        let kept = effective::set_in(&before).into_iter().filter_map(|key| option(&key).ok());
        for option in kept.filter(|option| !overrules(option)) {
            text = edit::apply(&text, option, Change::Set(&option.value(&config)))
                .map_err(|error| Failure::Edit(path.clone(), error))?;
        }
        let applies = files.applies(&from, &target);
        let _ = writeln!(outcome, "Its other settings are those of {}{applies}.", from.display());
    }
    write(&path, text)?;
    Ok(outcome + &notes(files, &path, &target))
}

/// Lines about a file that was written: reasons why it may have no effect, or more than asked for.
fn notes(files: &Files, path: &Path, target: &Target) -> String {
    [files.shared(path, target), files.shadow(path, target), files.unknown(target)]
        .into_iter()
        .flatten()
        .collect()
}

/// Prints a line for each error in any file.
fn validate(files: &Files) -> ExitCode {
    let mut is_valid = true;
    for file in files.existing() {
        match config::load(&file.path) {
            Ok(_) => crate::print(&format!("{}: valid\n", file.path.display())),
            Err(errors) => {
                is_valid = false;
                complain!("{errors}");
            }
        }
    }
    if is_valid { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn option(key: &str) -> Result<&'static OptionSpec, Failure> {
    OPTIONS.iter().find(|option| option.key() == key).ok_or_else(|| Failure::NoOption(key.to_owned()))
}

/// Text of the file, if it exists.
fn read(path: &Path) -> Result<Option<String>, Failure> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Failure::Read(path.to_owned(), error)),
    }
}

/// Writes through a link, so that a configuration that is kept elsewhere stays there. A link to a missing file stays, too.
fn write(path: &Path, text: String) -> Result<(), Failure> {
    if let Some(target) = config::missing_target(path) {
        return Err(Failure::LinkToNothing(path.to_owned(), target));
    }
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    Ok(Step::Write { path, text }.apply()?)
}
