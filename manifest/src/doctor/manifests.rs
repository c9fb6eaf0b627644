//! Whether both halves are installed, and are one.

use super::layers::{Layer, Layers, Manifest, UnreadableFolder, Unusable};
use super::{Finding, Fix, Surroundings, flatpak};
use crate::config::offers_gaze;
use crate::install::{library_path, plan_install};
use crate::json::{DISABLE_VARIABLE, ENABLE_VARIABLE, Half};
use crate::paths::FLATPAK_HOMES;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Data files installed for all users without a package: both loaders search this folder.
pub const SYSTEM_DATA: &str = "/usr/local/share";

pub(super) fn examine(surroundings: &Surroundings, layers: &Layers) -> Vec<Finding> {
    let mut findings: Vec<Finding> =
        Half::BOTH.iter().flat_map(|half| of_half(surroundings, layers, *half)).collect();
    if findings.iter().filter(|finding| finding.id == "manifest-missing").count() == Half::BOTH.len() {
        return vec![
            Finding::problem(
                "not-installed",
                "Parafovea is not installed",
                "Neither the OpenXR loader nor the Vulkan loader finds it, so games run without it.",
            )
            .advise("parafovea install")
            .fixed_if(surroundings.shipped.is_some(), Fix::Install),
        ];
    }
    if findings.is_empty() {
        findings.extend(one_library(surroundings, layers));
    }
    if findings.is_empty() {
        findings.extend(is_outdated(surroundings));
    }
    findings.extend(writable(layers, surroundings));
    if findings.is_empty()
        && let Some(library) = layers.library(surroundings, Half::OpenXr)
    {
        findings.push(Finding::good(
            "installed",
            format!("both halves of the layer are installed: {}", library.display()),
        ));
    }
    findings
}

/// The name of a half in sentences.
pub(super) fn called(half: Half) -> &'static str {
    match half {
        Half::OpenXr => "OpenXR",
        Half::Vulkan => "Vulkan",
    }
}

fn of_half(surroundings: &Surroundings, layers: &Layers, half: Half) -> Vec<Finding> {
    let ours: Vec<&Manifest> = layers.ours(half).collect();
    let name = called(half);
    let mut findings: Vec<Finding> =
        ours.iter().filter_map(|manifest| of_manifest(surroundings, layers, half, manifest)).collect();
    match ours.as_slice() {
        [] if layers.unreadable(half).next().is_some() => {
            findings.extend(layers.unreadable(half).map(unreadable));
        }
        [] => findings.push(advise_install(
            Finding::problem(
                "manifest-missing",
                format!("the {name} half is not installed"),
                format!(
                    "The {name} loader finds no manifest for it, and the other half has no effect alone."
                ),
            ),
            surroundings,
            layers,
        )),
        [_] => {}
        several if several.iter().all(|manifest| real(&manifest.path) == real(&several[0].path)) => {
            // The Vulkan loader takes a layer of the same name once.
            if half == Half::OpenXr {
                findings.push(
                    Finding::warning(
                        "listed-twice",
                        format!("the {name} loader finds {} {} times", several[0].path.display(), several.len()),
                        "It loads every layer of that folder as many times. Some layers fail if they are loaded twice.",
                    )
                    .advise("name each folder once in XDG_DATA_DIRS and XDG_CONFIG_DIRS, and remove ~/.local/share (or your XDG_DATA_HOME) from them: loaders search it anyway"),
                );
            }
        }
        several => {
            let paths: Vec<_> = several.iter().map(|manifest| manifest.path.display().to_string()).collect();
            let removal = removal(surroundings, several.iter().map(|manifest| manifest.path.as_path()));
            let effect = match half {
                Half::OpenXr => "The OpenXR loader loads all of them, and the layer works as the first.",
                Half::Vulkan => "The Vulkan loader takes the first, which may belong to another version.",
            };
            findings.push(
                Finding::problem(
                    "installed-twice",
                    format!("the {name} half is installed {} times: {}", paths.len(), paths.join(", ")),
                    effect,
                )
                .advise(format!("keep one; to remove the others: {}", removal)),
            );
        }
    }
    findings
}

/// A folder of manifests without the permission to read it: the layer may be installed in it.
fn unreadable(folder: &UnreadableFolder) -> Finding {
    let UnreadableFolder { half, path, reason } = folder;
    let path = path.display();
    Finding::problem(
        "folder-unreadable",
        format!("{path} cannot be read: {reason}"),
        format!("The {} loader finds no layer in it; Parafovea may be installed there.", called(*half)),
    )
    .advise(format!("let all users read this folder and the folders above it: sudo chmod a+rx {path}"))
}

/// The fault of a manifest of ours.
fn of_manifest(
    surroundings: &Surroundings,
    layers: &Layers,
    half: Half,
    manifest: &Manifest,
) -> Option<Finding> {
    let (path, name) = (manifest.path.display(), called(half));
    let skipped = format!("The {name} loader skips it, so games run without Parafovea.");
    let layer = match &manifest.content {
        Err(Unusable::Unreadable(reason)) => {
            return Some(
                Finding::problem("manifest-unreadable", format!("{path} cannot be read: {reason}"), skipped)
                    .advise(format!("chmod a+r {path}")),
            );
        }
        Err(Unusable::Malformed(reason)) => {
            return Some(
                Finding::problem(
                    "manifest-malformed",
                    format!("{path} is not a layer manifest: {reason}"),
                    skipped,
                )
                .advise("remove that file, then: parafovea install"),
            );
        }
        Ok(of_file) => of_file.iter().find(|layer| layer.name == half.layer_name()),
    };
    let Some(layer) = layer else {
        return Some(
            Finding::problem(
                "manifest-foreign",
                format!("{path} is the manifest of another layer"),
                "It has the name of Parafovea's manifest, and the installer does not overwrite it.",
            )
            .advise("move that file away, then: parafovea install"),
        );
    };
    of_layer(surroundings, half, manifest, layer).map(|finding| advise_install(finding, surroundings, layers))
}

/// Manifests of the layer that both loaders find, outside of `data` (`$XDG_DATA_HOME`): with an installation in `data` as well, the layer would be
/// loaded twice. None for the home of a Flatpak, which has no view of the others.
pub fn installed_elsewhere(surroundings: &Surroundings, data: &Path) -> Vec<PathBuf> {
    let is_flatpak =
        surroundings.environment.home().is_some_and(|home| data.starts_with(home.join(FLATPAK_HOMES)));
    if is_flatpak { Vec::new() } else { elsewhere(&Layers::find(surroundings), data) }
}

/// Commands that remove the installations with these manifests, in a sentence.
pub fn removal<'a>(surroundings: &Surroundings, manifests: impl IntoIterator<Item = &'a Path>) -> String {
    let home = surroundings.environment.data_home();
    let system = surroundings.system(SYSTEM_DATA);
    let in_flatpak = flatpak::data(surroundings);
    let mut ways: Vec<String> = Vec::new();
    for manifest in manifests {
        let way = if home.is_some_and(|home| manifest.starts_with(home)) {
            "parafovea uninstall".to_owned()
        } else if manifest.starts_with(&system) {
            surroundings.as_root("uninstall --system")
        } else if let Some(data) = in_flatpak.as_deref().filter(|data| manifest.starts_with(data)) {
            surroundings.with_data(data, "uninstall")
        } else {
            "the package manager of the system".to_owned()
        };
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    ways.join(", or ")
}

/// The file itself, behind links.
fn real(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn elsewhere(layers: &Layers, data: &Path) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    for half in Half::BOTH {
        let own = real(&half.manifest_path(data));
        let found = layers.of(half).iter().filter(|manifest| {
            manifest.layers().iter().any(|layer| layer.name == half.layer_name())
                && real(&manifest.path) != own
        });
        paths.extend(found.map(|manifest| manifest.path.clone()));
    }
    paths
}

/// Adds the advice to install, with its fix, unless the layer is installed outside of the user's home.
pub(super) fn advise_install(finding: Finding, surroundings: &Surroundings, layers: &Layers) -> Finding {
    let is_elsewhere =
        surroundings.environment.data_home().is_some_and(|data| !elsewhere(layers, data).is_empty());
    if is_elsewhere {
        finding.advise(format!(
            "install the package of the system again, or without one: {}",
            surroundings.as_root("install --system")
        ))
    } else {
        finding.advise("parafovea install").fixed_if(surroundings.shipped.is_some(), Fix::Install)
    }
}

fn of_layer(surroundings: &Surroundings, half: Half, manifest: &Manifest, layer: &Layer) -> Option<Finding> {
    let (path, name) = (manifest.path.display(), called(half));
    let enabled_by = |(variable, value): &(String, Option<String>)| {
        variable == ENABLE_VARIABLE && value.as_ref().is_none_or(|value| value == "1")
    };
    if layer.disable != [DISABLE_VARIABLE] || !matches!(layer.enable.as_slice(), [one] if enabled_by(one)) {
        return Some(Finding::problem(
            "manifest-edited",
            format!("{path} uses variables other than {ENABLE_VARIABLE} and {DISABLE_VARIABLE}"),
            "The two halves are not enabled together, and one has no effect alone; loaders refuse a layer without a disabling variable.",
        ));
    }
    let Some(library) = layer.library_at(surroundings, &manifest.path) else {
        if fs::metadata(&layer.library).is_err_and(|error| error.kind() == ErrorKind::PermissionDenied) {
            return Some(Finding::problem(
                "library-unreadable",
                format!("{path} names the library {}, which this user may not read", layer.library),
                format!("The {name} loader skips this half, and the other has no effect alone."),
            ));
        }
        return Some(Finding::problem(
            "library-missing",
            format!("{path} names the library {}, which does not exist", layer.library),
            format!("The {name} loader skips this half, and the other has no effect alone."),
        ));
    };
    let negotiate = layer.negotiate.as_deref().unwrap_or_default();
    let is_layer = fs::read(&library).is_ok_and(|bytes| crate::install::is_layer(&bytes));
    if !is_layer || negotiate != half.negotiate() {
        return Some(Finding::problem(
            "library-wrong",
            format!("{path} names the library {}, which is not Parafovea's", library.display()),
            format!("The {name} loader does not find the function {} in it.", half.negotiate()),
        ));
    }
    None
}

/// The two halves are to be the same file: then they meet at once, and are of one version.
fn one_library(surroundings: &Surroundings, layers: &Layers) -> Option<Finding> {
    let [openxr, vulkan] = Half::BOTH.map(|half| layers.library(surroundings, half));
    let (openxr, vulkan) = (openxr?, vulkan?);
    if real(&openxr) == real(&vulkan) {
        return None;
    }
    let found = format!("the OpenXR half is {}, the Vulkan half {}", openxr.display(), vulkan.display());
    let is_same = matches!((fs::read(&openxr), fs::read(&vulkan)), (Ok(one), Ok(other)) if one == other);
    let finding = if is_same {
        Finding::warning(
            "library-copied",
            found,
            "These are two copies of one library: they work until only one of them is updated.",
        )
    } else {
        Finding::problem(
            "library-differs",
            found,
            "These are two different builds: with different interfaces, they have no effect.",
        )
    };
    Some(advise_install(finding, surroundings, layers))
}

/// Installed files, of the user or of all users, that differ from the files of this program.
fn is_outdated(surroundings: &Surroundings) -> Option<Finding> {
    let shipped = surroundings.shipped.as_ref()?;
    let differs = |data: &Path, offers_gaze| {
        library_path(data).is_file()
            && Half::BOTH.iter().all(|half| half.manifest_path(data).is_file())
            && plan_install(data, shipped, offers_gaze).is_ok_and(|steps| !steps.is_empty())
    };
    let finding = |of_whom: &str| {
        Finding::warning(
            "outdated",
            format!("the installed files{of_whom} differ from {} and the files beside it", shipped.display()),
            "Games use the installed files, not those of this program.",
        )
    };
    let data = surroundings.environment.data_home();
    if data.is_some_and(|data| differs(data, offers_gaze(&surroundings.environment))) {
        return Some(finding("").advise("parafovea install").fixed_by(Fix::Install));
    }
    // As `parafovea install --system` does, without a look at the settings of one user.
    differs(&surroundings.system(SYSTEM_DATA), true)
        .then(|| finding(" of all users").advise(surroundings.as_root("install --system")))
}

/// Files that anybody may change, though they are loaded into games.
fn writable(layers: &Layers, surroundings: &Surroundings) -> Vec<Finding> {
    let manifests = Half::BOTH.into_iter().flat_map(|half| layers.ours(half).map(|found| found.path.clone()));
    let libraries = Half::BOTH.into_iter().filter_map(|half| layers.library(surroundings, half));
    let mut paths: Vec<PathBuf> = manifests.chain(libraries).collect();
    paths.sort();
    paths.dedup();
    paths.iter().filter_map(|path| anybody_may_write(path, "loaded into games")).collect()
}

/// A finding where everybody may change the file, which is `used`.
pub(super) fn anybody_may_write(path: &Path, used: &str) -> Option<Finding> {
    use std::os::unix::fs::PermissionsExt;
    let mode = fs::metadata(path).ok()?.permissions().mode();
    (mode & 0o002 != 0).then(|| {
        Finding::warning(
            "anybody-may-write",
            format!("every user of this machine can change {}", path.display()),
            format!("It is {used}, so other users could change the behaviour of games."),
        )
        .advise(format!("chmod go-w {}", path.display()))
        .fixed_by(Fix::Restrict(path.to_owned()))
    })
}
