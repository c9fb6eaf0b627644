//! Steam's container, and Flatpak: the parts of this machine that games see in them.
//!
//! Source: pressure-vessel (steam-runtime), which imports Vulkan layers from the system by itself, and OpenXR layers where
//! `PRESSURE_VESSEL_IMPORT_OPENXR_1_LAYERS` asks for it; the home folder is visible unchanged.

use super::layers::Layers;
use super::{Finding, Surroundings};
use crate::json::Half;

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
    let flatpak_steam = home.join(".var/app/com.valvesoftware.Steam");
    let has_steam = [".steam", ".local/share/Steam"].iter().any(|folder| home.join(folder).exists());
    if flatpak_steam.exists() {
        let data = flatpak_steam.join(".local/share");
        let is_there = Half::BOTH.iter().all(|half| half.manifest_path(&data).is_file());
        if !is_there {
            findings.push(
                Finding::warning(
                    "flatpak-steam",
                    "Steam is installed as a Flatpak",
                    "Its games have their own home folder, where Parafovea is not installed.",
                )
                .advise(format!("XDG_DATA_HOME={} parafovea install", data.display())),
            );
        }
    }
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
