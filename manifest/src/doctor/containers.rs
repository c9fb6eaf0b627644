//! Steam's container, and Flatpak: the parts of this machine that games see in them.
//!
//! Source: pressure-vessel (steam-runtime), which imports Vulkan layers from the system by itself, and OpenXR layers where
//! `PRESSURE_VESSEL_IMPORT_OPENXR_1_LAYERS` asks for it; the home folder is visible unchanged.

use super::layers::Layers;
use super::{Finding, Surroundings};
use crate::config::offers_gaze;
use crate::install::plan_install;
use crate::json::Half;
use crate::paths::{FLATPAK_STEAM, SNAP_STEAM};
use std::path::{Path, PathBuf};

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let mut findings = Vec::new();
    let Some(home) = surroundings.home() else { return findings };
    if surroundings.system("/.flatpak-info").exists() {
        findings.push(
            Finding::warning(
                "in-flatpak",
                "this command runs in a Flatpak",
                "It can check and change only this Flatpak, not games outside it.",
            )
            .advise("run it outside Flatpak, unless the games run in the same Flatpak"),
        );
    }
    let has_steam = [".steam", ".local/share/Steam"].iter().any(|folder| home.join(folder).exists());
    findings.extend(flatpak_steam(surroundings, &home.join(FLATPAK_STEAM)));
    findings.extend(snap_steam(&home.join(SNAP_STEAM)));
    if has_steam {
        let mut variables = vec!["PARAFOVEA=1"];
        // The first manifest is the one that counts.
        let is_at_home = layers.ours(Half::OpenXr).next().is_none_or(|found| found.path.starts_with(home));
        if !is_at_home {
            variables.push("PRESSURE_VESSEL_IMPORT_OPENXR_1_LAYERS=1");
        }
        findings.push(
            Finding::note(
                "steam",
                "Steam starts games in a container",
                if is_at_home {
                    "Layers in your home are available there."
                } else {
                    "OpenXR layers of the system are available there only on request."
                },
            )
            .advise(format!(
                "launch options: {} %command% (for a runtime other than SteamVR, PRESSURE_VESSEL_IMPORT_OPENXR_1_RUNTIMES=1 as well)",
                variables.join(" ")
            )),
        );
    }
    findings
}

/// The folder for data files in the home of Steam's Flatpak.
pub(super) fn flatpak_data(surroundings: &Surroundings) -> Option<PathBuf> {
    Some(surroundings.home()?.join(FLATPAK_STEAM).join(".local/share"))
}

/// Manifests of the copy in Steam's Flatpak, which is installed and removed by commands of its own.
pub fn installed_in_flatpak(surroundings: &Surroundings) -> Vec<PathBuf> {
    let data = flatpak_data(surroundings);
    let manifests = data.iter().flat_map(|data| Half::BOTH.map(|half| half.manifest_path(data)));
    manifests.filter(|path| path.is_file()).collect()
}

/// Steam as a Flatpak without the layer, or with another build of it.
fn flatpak_steam(surroundings: &Surroundings, steam: &Path) -> Option<Finding> {
    if !steam.exists() {
        return None;
    }
    let data = steam.join(".local/share");
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
        "XDG_DATA_HOME={} parafovea install; so that your settings apply there: flatpak override --user --filesystem=xdg-config/parafovea:ro com.valvesoftware.Steam",
        data.display()
    )))
}

/// Steam as a snap, which sees neither the user's home nor the layers of the system.
fn snap_steam(steam: &Path) -> Option<Finding> {
    let is_there = || Half::BOTH.iter().all(|half| half.manifest_path(&steam.join(".local/share")).is_file());
    (steam.exists() && !is_there()).then(|| {
        Finding::warning(
            "snap-steam",
            "Steam is installed as a snap",
            "Its games see neither your home nor the layers of the system, so Parafovea is not loaded.",
        )
        .advise("use Valve's package of Steam, whose games find it")
    })
}
