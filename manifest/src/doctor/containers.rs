//! Steam's container, Flatpak and snap: the parts of this machine that games see in them.
//!
//! Source: pressure-vessel (steam-runtime), which imports Vulkan layers from the system by itself, and OpenXR layers where
//! `PRESSURE_VESSEL_IMPORT_OPENXR_1_LAYERS` asks for it; the home folder is visible unchanged.

use super::layers::Layers;
use super::{Finding, Surroundings, flatpak};
use crate::json::Half;
use crate::paths::SNAP_STEAM;
use std::path::Path;

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let mut findings = Vec::new();
    let Some(home) = surroundings.environment.home() else { return findings };
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
    findings.extend(flatpak::examine(surroundings));
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
