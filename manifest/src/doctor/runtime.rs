//! The OpenXR runtime that games get.
//!
//! Source: OpenXR loader, `manifest_file.cpp` (`RuntimeManifestFile::FindManifestFiles`).

use super::{Finding, Surroundings};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

pub(super) fn examine(surroundings: &Surroundings) -> Vec<Finding> {
    vec![match manifest(surroundings) {
        Some(path) => of_manifest(surroundings, &path),
        None => Finding::problem(
            "no-runtime",
            "no active OpenXR runtime",
            "Games find no headset: the OpenXR loader finds no active_runtime.json.",
        )
        .advise(
            "set the active runtime: in SteamVR under Settings > OpenXR; WiVRn and Monado set it at startup; otherwise, \
             link the runtime's openxr_*.json to ~/.config/openxr/1/active_runtime.json",
        ),
    }]
}

/// Whether there is a file that names one.
pub(super) fn is_set(surroundings: &Surroundings) -> bool {
    manifest(surroundings).is_some()
}

/// The file that names the runtime.
fn manifest(surroundings: &Surroundings) -> Option<PathBuf> {
    if let Some(named) = surroundings.variable("XR_RUNTIME_JSON") {
        return Some(PathBuf::from(named));
    }
    let arch = std::env::consts::ARCH;
    let home = surroundings.environment.config_home().map(Path::to_owned);
    home.into_iter()
        .chain(surroundings.paths_or("XDG_CONFIG_DIRS", &["/etc/xdg"]))
        .chain([surroundings.system("/etc")])
        .map(|base| base.join("openxr/1"))
        .flat_map(|folder| {
            [folder.join(format!("active_runtime.{arch}.json")), folder.join("active_runtime.json")]
        })
        // The loader finds no file behind a broken link either, but the link is worth a finding: it was set on purpose.
        .find(|path| fs::symlink_metadata(path).is_ok())
}

fn of_manifest(surroundings: &Surroundings, path: &Path) -> Finding {
    let shown = path.display();
    let wrong = |reason: String| {
        Finding::problem("runtime-broken", format!("{shown} {reason}"), "Games find no headset.")
            .advise("start your runtime, or set it as the active runtime again")
    };
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) => return wrong(format!("cannot be read: {error}")),
    };
    let Ok(file) = serde_json::from_str::<Value>(&text) else {
        return wrong("is not JSON".to_owned());
    };
    let Some(library) = file["runtime"]["library_path"].as_str() else {
        return wrong("has no value runtime.library_path".to_owned());
    };
    let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let is_there = match library.contains('/') {
        true => real.parent().is_some_and(|folder| folder.join(library).exists()),
        false => surroundings.library(library).is_some(),
    };
    if !is_there {
        return wrong(format!("names the library {library}, which does not exist"));
    }
    let name = file["runtime"]["name"].as_str().unwrap_or_default();
    Finding::good("runtime", format!("OpenXR runtime: {} ({shown})", kind(name, library)))
}

/// The usual name of a runtime with that name and library.
fn kind(name: &str, library: &str) -> String {
    let told = format!("{name} {library}").to_lowercase();
    let known = [("wivrn", "WiVRn"), ("monado", "Monado"), ("vrclient", "SteamVR"), ("steamvr", "SteamVR")];
    match known.iter().find(|(part, _)| told.contains(part)) {
        Some((_, known)) => (*known).to_owned(),
        None if name.is_empty() => library.to_owned(),
        None => name.to_owned(),
    }
}
