//! Steam from Flatpak, whose games have a home folder of their own.

use super::{Finding, Surroundings};
use crate::config::offers_gaze;
use crate::install::plan_install;
use crate::json::Half;
use crate::paths::FLATPAK_STEAM;
use std::fs;
use std::path::{Path, PathBuf};

/// Steam's name among Flatpaks.
const STEAM: &str = "com.valvesoftware.Steam";

/// The folder of Flatpaks for all users.
const SYSTEM: &str = "/var/lib/flatpak";

/// The files that name further folders of Flatpaks (Flatpak, "flatpak-installation").
const FURTHER: &str = "/etc/flatpak/installations.d";

/// The command that shares the settings.
const OVERRIDE: &str = "flatpak override --user --filesystem=xdg-config/parafovea:ro com.valvesoftware.Steam";

/// The folder for data files in the home of Steam's Flatpak.
pub(super) fn data(surroundings: &Surroundings) -> Option<PathBuf> {
    Some(surroundings.environment.home()?.join(FLATPAK_STEAM).join(".local/share"))
}

/// Manifests of the copy in Steam's Flatpak, which is installed and removed by commands of its own.
pub fn installed_in_flatpak(surroundings: &Surroundings) -> Vec<PathBuf> {
    let data = data(surroundings);
    let manifests = data.iter().flat_map(|data| Half::BOTH.map(|half| half.manifest_path(data)));
    manifests.filter(|path| path.is_file()).collect()
}

/// Steam from Flatpak without the layer, with another build of it, or without a view of the settings.
pub(super) fn examine(surroundings: &Surroundings) -> Option<Finding> {
    let data = data(surroundings)?;
    if !is_installed(surroundings) {
        return None;
    }
    let is_there = Half::BOTH.iter().all(|half| half.manifest_path(&data).is_file());
    let differs = surroundings.shipped.as_ref().is_some_and(|shipped| {
        plan_install(&data, shipped, offers_gaze(&surroundings.environment))
            .is_ok_and(|steps| !steps.is_empty())
    });
    let (found, means) = match (is_there, differs) {
        (true, false) => return settings_hidden(surroundings),
        (true, true) => (
            "the Flatpak of Steam has another build of Parafovea",
            "Its games use a copy in their own home folder; an update in your home folder does not reach it.",
        ),
        (false, _) => (
            "Steam is installed as a Flatpak",
            "Its games have their own home folder, where Parafovea is not installed.",
        ),
    };
    Some(Finding::warning("flatpak-steam", found, means).advise(format!(
        "{}; so that your settings apply there: {OVERRIDE}; then restart Steam",
        surroundings.with_data(&data, "install")
    )))
}

/// The user's settings, if games of Steam's Flatpak neither see them nor have any of their own.
fn settings_hidden(surroundings: &Surroundings) -> Option<Finding> {
    let settings = surroundings.environment.config_home()?.join("parafovea");
    let own = surroundings.environment.home()?.join(FLATPAK_STEAM).join(".config/parafovea");
    let has_files = |folder: &Path| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
    if !has_files(&settings) || has_files(&own) || is_shared(surroundings, &settings) {
        return None;
    }
    let found = format!("games in the Flatpak of Steam do not see {}", settings.display());
    let means = "They have their own home folder, so the defaults apply to them.";
    Some(Finding::warning("flatpak-settings", found, means).advise(OVERRIDE))
}

/// Whether the user or the administrator lets Steam's Flatpak see a folder of the user.
fn is_shared(surroundings: &Surroundings, folder: &Path) -> bool {
    let files = installations(surroundings).into_iter().map(|folder| folder.join("overrides"));
    let files = files.flat_map(|overrides| [overrides.join(STEAM), overrides.join("global")]);
    let lists = files.flat_map(|file| values(&file, "Context", "filesystems"));
    let grants: Vec<String> = lists.flat_map(|list| list.split(';').map(grant).collect::<Vec<_>>()).collect();
    let shared = grants.iter().filter_map(|name| place(surroundings, name));
    shared.into_iter().any(|place| folder.starts_with(place))
}

/// A place that a Flatpak may see, without its mode.
fn grant(entry: &str) -> String {
    let entry = entry.trim();
    match entry.rsplit_once(':') {
        Some((place, "ro" | "rw" | "create")) => place.to_owned(),
        _ => entry.to_owned(),
    }
}

/// Path of a place as Flatpak names it; `None` for places other than the user's (Flatpak, "Sandbox Permissions").
fn place(surroundings: &Surroundings, name: &str) -> Option<PathBuf> {
    let home = surroundings.environment.home()?;
    match name.split_once('/').unwrap_or((name, "")) {
        ("host", "") => Some("/".into()),
        ("home", "") => Some(home.to_owned()),
        ("~", below) => Some(home.join(below)),
        ("xdg-config", below) => Some(surroundings.environment.config_home()?.join(below)),
        ("", _) if name.starts_with('/') => Some(name.into()),
        _ => None,
    }
}

/// Whether Steam is installed as a Flatpak: its home folder alone remains when it is removed.
fn is_installed(surroundings: &Surroundings) -> bool {
    installations(surroundings).iter().any(|folder| folder.join("app").join(STEAM).exists())
}

/// The folders of Flatpaks: this user's, that for all users, and further ones of the administrator.
fn installations(surroundings: &Surroundings) -> Vec<PathBuf> {
    let user = surroundings.environment.data_home().map(|data| data.join("flatpak"));
    let mut folders: Vec<PathBuf> = user.into_iter().chain([surroundings.system(SYSTEM)]).collect();
    let files = fs::read_dir(surroundings.system(FURTHER)).into_iter().flatten().flatten();
    let paths = files.flat_map(|file| values(&file.path(), "Installation", "Path"));
    folders.extend(paths.map(|path| surroundings.system(&path)));
    folders
}

/// Values of a key in a file of sections, in those whose name begins with `section`; none without the file.
fn values(file: &Path, section: &str, key: &str) -> Vec<String> {
    let (mut found, mut is_in) = (Vec::new(), false);
    for line in fs::read_to_string(file).unwrap_or_default().lines().map(str::trim) {
        if let Some(name) = line.strip_prefix('[') {
            is_in = name.starts_with(section);
        } else if let Some((_, value)) = line.split_once('=').filter(|(name, _)| is_in && name.trim() == key)
        {
            found.push(value.trim().to_owned());
        }
    }
    found
}
