//! The loaders of the system, by the names of their files. Games may bring an OpenXR loader of their own.

use super::{Finding, Surroundings};
use std::path::Path;

/// The first OpenXR loader that loads each layer that it should: "Fix bug in loading API layers that could result in not loading
/// an available and enabled layer" (change log of OpenXR-SDK-Source for 1.0.6, pull request 155).
const OLDEST_OPENXR: [u32; 3] = [1, 0, 6];

/// The first Vulkan loader of which each release speaks version 2 of the interface to layers (`LoaderLayerInterface.md`, "Layer
/// Interface Version 2").
const OLDEST_VULKAN: [u32; 3] = [1, 1, 0];

pub(super) fn examine(surroundings: &Surroundings) -> Vec<Finding> {
    let openxr = match surroundings.library("libopenxr_loader.so.1") {
        None => Finding::note(
            "no-openxr-loader",
            "the system has no OpenXR loader (libopenxr_loader.so.1)",
            "Most games include their own and do not need it.",
        )
        .advise("if a game does not start without it, install it (Debian, Ubuntu: libopenxr-loader1)"),
        Some(path) => by_version(&path, "OpenXR", OLDEST_OPENXR, "It may skip some layers."),
    };
    let vulkan = match surroundings.library("libvulkan.so.1") {
        None if surroundings.probed.vulkan.is_ok() => Finding::note(
            "vulkan-loader-elsewhere",
            "the Vulkan loader is outside of the usual folders of libraries",
            "Its version is not checked.",
        ),
        None => Finding::problem(
            "no-vulkan-loader",
            "the system has no Vulkan loader (libvulkan.so.1)",
            "Games that use Vulkan do not start.",
        )
        .advise("install it (Debian, Ubuntu: libvulkan1)"),
        Some(path) => {
            by_version(&path, "Vulkan", OLDEST_VULKAN, "It may not support this layer's interface.")
        }
    };
    vec![openxr, vulkan]
}

fn by_version(path: &Path, name: &str, oldest: [u32; 3], effect: &str) -> Finding {
    let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let Some(version) = version(&real) else {
        return Finding::good("loader", format!("{name} loader: {}", real.display()));
    };
    let text = version.map(|part| part.to_string()).join(".");
    if version < oldest {
        let oldest = oldest.map(|part| part.to_string()).join(".");
        return Finding::problem(
            "old-loader",
            format!("the {name} loader {} has version {text}", real.display()),
            effect,
        )
        .advise(format!("update it to {oldest} or newer"));
    }
    Finding::good("loader", format!("{name} loader {text}: {}", real.display()))
}

/// The version in a name such as `libvulkan.so.1.3.239`.
fn version(path: &Path) -> Option<[u32; 3]> {
    let (_, version) = path.file_name()?.to_str()?.split_once(".so.")?;
    let mut parts = version.split('.').map(|part| part.parse().ok());
    Some([parts.next()??, parts.next()??, parts.next()??])
}
