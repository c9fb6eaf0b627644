//! The configuration: the file in force, and errors of any of them.

use super::manifests::anybody_may_write;
use super::{Finding, Surroundings};
use crate::config::{Config, Places, load};
use crate::options::{AudioSource, GazeSource};
use std::fs;
use std::path::PathBuf;

pub(super) fn examine(surroundings: &Surroundings) -> Vec<Finding> {
    let (file, config) = in_force(surroundings);
    let mut findings = Vec::new();
    match &file {
        None => findings.push(Finding::good("configuration", "no configuration file: defaults")),
        Some(file) => {
            findings.extend(anybody_may_write(file, "the configuration of games"));
            if config.is_some() {
                findings.push(Finding::good("configuration", format!("configuration: {}", file.display())));
            }
        }
    }
    for file in all_files(surroundings, file) {
        if let Err(errors) = load(&file) {
            findings.extend(errors.lines().map(|line| {
                Finding::problem(
                    "configuration-wrong",
                    line,
                    "The whole file is ignored: the previous settings, or the defaults, apply.",
                )
                .advise("correct this line; parafovea config default prints every option")
            }));
        }
    }
    if let Some(config) = config {
        findings.extend(of_config(&config));
    }
    findings
}

/// The file in force, if there is any, and its configuration, if it is right.
pub(super) fn in_force(surroundings: &Surroundings) -> (Option<PathBuf>, Option<Config>) {
    let names = surroundings.application.clone().unwrap_or_default();
    let places = Places::new(&surroundings.environment, names.application.as_deref(), &names.executable);
    match places.find(|file| fs::symlink_metadata(file).is_ok()) {
        None => (None, Some(Config::default())),
        Some(file) => (Some(file.to_owned()), load(file).ok()),
    }
}

/// The file in force, and the files of all applications.
fn all_files(surroundings: &Surroundings, in_force: Option<PathBuf>) -> Vec<PathBuf> {
    let apps = surroundings.environment.config_home().map(|home| home.join("parafovea/apps"));
    let entries = apps.and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .chain(in_force)
        .collect();
    files.sort();
    files.dedup();
    files
}

fn of_config(config: &Config) -> Vec<Finding> {
    let mut findings = Vec::new();
    if !config.enabled {
        findings.push(
            Finding::warning(
                "turned-off",
                "the configuration has enabled = false",
                "Parafovea is loaded, but has no effect.",
            )
            .advise("set enabled = true, or remove that line"),
        );
    }
    let files = [
        (config.gaze.source == GazeSource::File, "gaze.file", config.gaze.file),
        (config.audio.source == AudioSource::File, "audio.file", config.audio.file),
    ];
    for (is_used, key, file) in files {
        let is_there = file.path().is_some_and(|path| fs::File::open(path).is_ok());
        if is_used && !is_there {
            findings.push(
                Finding::problem(
                    "file-missing",
                    match file.path() {
                        Some(path) => format!("{key} is {}, which cannot be read", path.display()),
                        None => format!("{key} is empty, but source = \"file\""),
                    },
                    "The source has no data.",
                )
                .advise(format!("correct {key}")),
            );
        }
    }
    findings
}
