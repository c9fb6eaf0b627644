//! Activation of the Vulkan half inside the process, for a user who named the OpenXR layer explicitly and set nothing for the Vulkan loader.
//!
//! The Vulkan loader reads its variables at every vkCreateInstance, so setting them before the application's
//! is enough; an instance that it made before stays without us. Measured with loader 1.3.239.

use crate::abi::own_folder::own_folder;
use crate::vk::LAYER_NAME;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};
use std::sync::Once;

/// Candidate folders of the manifest of the Vulkan half, relative to the folder of this library: beside it, or as
/// installed below a prefix.
static FOLDERS: [&str; 3] = [".", "vulkan/explicit_layer.d", "../share/vulkan/explicit_layer.d"];

/// Makes the Vulkan loader load the Vulkan half with the next instance, unless the environment already requests it.
pub fn activate() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let variable = |name: &str| std::env::var_os(name);
        if is_requested(variable) {
            return;
        }
        let Some(folder) = own_folder().and_then(|folder| manifest_folder(&folder)) else {
            tracing::info!("the Vulkan half is not enabled: its manifest was not found near this library");
            return;
        };
        for (name, value) in settings(variable, &folder) {
            // SAFETY: no other thread of this library touches the environment. Other threads of the
            // application may read it through C, which is a race that every setenv has; it is taken here
            // only on explicit use, once, while xrCreateInstance runs.
            unsafe { std::env::set_var(name, value) };
        }
        tracing::info!("Vulkan half enabled in this process, from {}", folder.display());
    });
}

/// Whether the environment brings the Vulkan half in: by its implicit manifest, or by name.
fn is_requested(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    let names = variable("VK_INSTANCE_LAYERS").unwrap_or_default();
    let is_named = names.as_bytes().split(|&byte| byte == b':').any(|name| name == LAYER_NAME.to_bytes());
    is_named || variable("PARAFOVEA").is_some()
}

/// The variables to set. The user's values are kept, behind ours. A `VK_LAYER_PATH` of the user's makes the loader ignore
/// `VK_ADD_LAYER_PATH`.
fn settings(variable: impl Fn(&str) -> Option<OsString>, folder: &Path) -> [(&'static str, OsString); 2] {
    let prepend = |name: &'static str, first: &OsStr| {
        let mut value = first.as_bytes().to_vec();
        if let Some(rest) = variable(name).filter(|rest| !rest.is_empty()) {
            value.push(b':');
            value.extend_from_slice(rest.as_bytes());
        }
        (name, OsString::from_vec(value))
    };
    let path = if variable("VK_LAYER_PATH").is_some() { "VK_LAYER_PATH" } else { "VK_ADD_LAYER_PATH" };
    [
        prepend(path, folder.as_os_str()),
        prepend("VK_INSTANCE_LAYERS", OsStr::from_bytes(LAYER_NAME.to_bytes())),
    ]
}

/// The first of [`FOLDERS`] with a manifest that names the Vulkan half.
fn manifest_folder(library_folder: &Path) -> Option<PathBuf> {
    let names_us = |file: &Path| {
        let name = LAYER_NAME.to_bytes();
        std::fs::read(file).is_ok_and(|text| text.windows(name.len()).any(|window| window == name))
    };
    let has_manifest = |folder: &PathBuf| {
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        files
            .filter(|file| file.extension().is_some_and(|extension| extension == "json"))
            .any(|file| names_us(&file))
    };
    FOLDERS.iter().map(|folder| library_folder.join(folder)).find(has_manifest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn environment(set: &'static [(&str, &str)]) -> impl Fn(&str) -> Option<OsString> + Copy {
        |name| set.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value))
    }

    #[test]
    fn the_users_values_stay_behind_ours() {
        let folder = Path::new("/lib");
        let user = environment(&[("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")]);
        assert_eq!(
            settings(user, folder),
            [
                ("VK_ADD_LAYER_PATH", OsString::from("/lib")),
                ("VK_INSTANCE_LAYERS", "VK_LAYER_PARAFOVEA_foveation:VK_LAYER_KHRONOS_validation".into()),
            ]
        );
        let [path, _] = settings(environment(&[("VK_LAYER_PATH", "/mine")]), folder);
        assert_eq!(path, ("VK_LAYER_PATH", OsString::from("/lib:/mine")));
    }

    #[test]
    fn is_left_to_an_environment_that_brings_it_in() {
        assert!(is_requested(environment(&[("PARAFOVEA", "1")])));
        assert!(is_requested(environment(&[("VK_INSTANCE_LAYERS", "A:VK_LAYER_PARAFOVEA_foveation")])));
        assert!(!is_requested(environment(&[("VK_INSTANCE_LAYERS", "VK_LAYER_PARAFOVEA_foveation_2")])));
    }

    #[test]
    fn a_manifest_is_known_by_the_layer_that_it_names() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(manifest_folder(folder.path()), None);
        std::fs::write(folder.path().join("other.json"), "{\"name\": \"VK_LAYER_other\"}").unwrap();
        assert_eq!(manifest_folder(folder.path()), None);
        std::fs::write(folder.path().join("ours.json"), "VK_LAYER_PARAFOVEA_foveation").unwrap();
        assert_eq!(manifest_folder(folder.path()), Some(folder.path().join(".")));
    }
}
