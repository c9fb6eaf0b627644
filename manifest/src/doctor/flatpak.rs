//! Steam from Flatpak, whose games have a home folder of their own.

use super::{Finding, Surroundings};
use crate::config::offers_gaze;
use crate::install::plan_install;
use crate::json::Half;
use crate::paths::FLATPAK_STEAM;
use std::path::PathBuf;

/// Steam's name among Flatpaks.
const STEAM: &str = "com.valvesoftware.Steam";

/// The folder of Flatpaks for all users.
const SYSTEM: &str = "/var/lib/flatpak";

/// The command that shares the settings.
const OVERRIDE: &str = "flatpak override --user --filesystem=xdg-config/parafovea:ro com.valvesoftware.Steam";

/// The folder for data files in the home of Steam's Flatpak.
pub(super) fn data(surroundings: &Surroundings) -> Option<PathBuf> {
    Some(surroundings.home()?.join(FLATPAK_STEAM).join(".local/share"))
}

/// Manifests of the copy in Steam's Flatpak, which is installed and removed by commands of its own.
pub fn installed_in_flatpak(surroundings: &Surroundings) -> Vec<PathBuf> {
    let data = data(surroundings);
    let manifests = data.iter().flat_map(|data| Half::BOTH.map(|half| half.manifest_path(data)));
    manifests.filter(|path| path.is_file()).collect()
}

/// Steam from Flatpak without the layer, or with another build of it.
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
        (true, false) => return None,
        (true, true) => (
            "the Flatpak of Steam has another build of Parafovea",
            "Its games have their own home folder, which is not updated with yours.",
        ),
        (false, _) => (
            "Steam is installed as a Flatpak",
            "Its games have their own home folder, where Parafovea is not installed.",
        ),
    };
    Some(Finding::warning("flatpak-steam", found, means).advise(format!(
        "XDG_DATA_HOME={} parafovea install; so that your settings apply there: {OVERRIDE}",
        data.display()
    )))
}

/// Whether Steam is installed as a Flatpak: its home folder alone remains when it is removed.
fn is_installed(surroundings: &Surroundings) -> bool {
    installations(surroundings).iter().any(|folder| folder.join("app").join(STEAM).exists())
}

/// The folders of Flatpaks: this user's, and that for all users.
fn installations(surroundings: &Surroundings) -> Vec<PathBuf> {
    let user = surroundings.environment.data_home().map(|data| data.join("flatpak"));
    user.into_iter().chain([surroundings.system(SYSTEM)]).collect()
}
