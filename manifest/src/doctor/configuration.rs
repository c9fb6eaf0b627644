//! The configuration: the file in force, and errors of any of them.

use super::manifests::anybody_may_write;
use super::{Finding, Surroundings};
use crate::config::{Config, Places, load, missing_target};
use crate::options::{AudioSource, GazeSource};
use std::fs;
use std::path::{Path, PathBuf};

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
    for path in all_files(surroundings, &file) {
        if let Some(target) = missing_target(&path).filter(|_| file.as_ref() != Some(&path)) {
            findings.push(link_to_nothing(surroundings, &path, &target, file.as_deref()));
        } else if let Err(errors) = load(&path) {
            let means = if errors.turns_off() {
                "The whole file is ignored, except for enabled = false when the game starts."
            } else {
                "The whole file is ignored: the previous settings, or the defaults, apply."
            };
            findings.extend(errors.lines().map(|line| {
                Finding::problem("configuration-wrong", line, means)
                    .advise("correct this line; parafovea config default prints every option")
            }));
        }
    }
    if let Some(config) = config {
        findings.extend(of_config(&config, file.as_deref()));
    }
    findings
}

/// The file in force, if there is any, and its configuration, if it is right.
pub(super) fn in_force(surroundings: &Surroundings) -> (Option<PathBuf>, Option<Config>) {
    match places(surroundings).in_force() {
        None => (None, Some(Config::default())),
        Some(file) => (Some(file.to_owned()), load(file).ok()),
    }
}

fn places(surroundings: &Surroundings) -> Places {
    let names = surroundings.application.clone().unwrap_or_default();
    Places::new(&surroundings.environment, names.application.as_deref(), &names.executable)
}

/// A link whose target is missing, in the place of a file.
fn link_to_nothing(
    surroundings: &Surroundings,
    link: &Path,
    target: &Path,
    in_force: Option<&Path>,
) -> Finding {
    let is_of_application = places(surroundings).files().iter().any(|file| file == link);
    let next = match in_force {
        _ if !is_of_application => "the next file for its application applies, or the defaults".to_owned(),
        Some(next) => format!("{} applies", next.display()),
        None => "the defaults apply".to_owned(),
    };
    Finding::problem(
        "configuration-link",
        format!("{} is a link to a missing file, {}", link.display(), target.display()),
        format!("It counts as no file: {next}."),
    )
    .advise("create that file, or remove the link")
}

/// The file in force, links to missing files in its place, and the files of all applications.
fn all_files(surroundings: &Surroundings, in_force: &Option<PathBuf>) -> Vec<PathBuf> {
    let places = places(surroundings);
    let links = places.files().iter().filter(|file| missing_target(file).is_some()).cloned();
    let apps = surroundings.environment.config_home().map(|home| home.join("parafovea/apps"));
    let entries = apps.and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .chain(in_force.clone())
        .chain(links)
        .collect();
    files.sort();
    files.dedup();
    files
}

/// Settings of the file in force with which a technique or a source has no effect.
fn of_config(config: &Config, file: Option<&Path>) -> Vec<Finding> {
    let in_file = |text: String| file.map_or(text.clone(), |file| format!("{}: {text}", file.display()));
    let mut findings = Vec::new();
    if !config.enabled {
        findings.push(
            Finding::warning(
                "turned-off",
                in_file("enabled = false".to_owned()),
                "Parafovea is loaded, but has no effect.",
            )
            .advise("set enabled = true, or remove that line"),
        );
    }
    let files = [
        (config.gaze.source == GazeSource::File, "gaze.file", config.gaze.file),
        (config.audio.source == AudioSource::File, "audio.file", config.audio.file),
    ];
    for (is_used, key, source) in files {
        let is_there = source.path().is_some_and(|path| fs::File::open(path).is_ok());
        if is_used && !is_there {
            findings.push(
                Finding::problem(
                    "file-missing",
                    in_file(match source.path() {
                        Some(path) => format!("{key} is {}, which cannot be read", path.display()),
                        None => format!("{key} is empty, but source = \"file\""),
                    }),
                    "The source has no data.",
                )
                .advise(format!("set {key} to the absolute path of a readable file")),
            );
        }
    }
    findings
}
