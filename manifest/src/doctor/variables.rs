//! Variables of the environment that turn the layer off, or half of it.
//!
//! Source for the Vulkan loader's variables: `LoaderLayerInterface.md`, "Layer Filtering" and "Linux Layer Discovery".

use super::{Finding, Surroundings};
use crate::json::{DISABLE_VARIABLE, ENABLE_VARIABLE};
use crate::loader_filters::{DISABLE_LAYERS, disabling_word};
use std::ffi::OsStr;

pub(super) fn examine(surroundings: &Surroundings) -> Vec<Finding> {
    [disabled, half_enabled, filtered, other_folders, relative_homes]
        .into_iter()
        .filter_map(|check| check(surroundings))
        .collect()
}

fn disabled(surroundings: &Surroundings) -> Option<Finding> {
    surroundings.set(DISABLE_VARIABLE)?;
    Some(
        Finding::problem(
            "disabled",
            format!("the variable {DISABLE_VARIABLE} is set"),
            "It turns the layer off in all programs started from here, regardless of other settings.",
        )
        .advise(format!(
            "unset {DISABLE_VARIABLE}; look for it in the start-up files of the shell and the desktop session"
        )),
    )
}

fn half_enabled(surroundings: &Surroundings) -> Option<Finding> {
    let value = surroundings.set(ENABLE_VARIABLE).filter(|value| *value != OsStr::new("1"))?;
    Some(
        Finding::problem(
            "half-enabled",
            format!("{ENABLE_VARIABLE} is {:?} instead of 1", value.to_string_lossy()),
            "With any value, the OpenXR loader loads its half of the layer, but the Vulkan loader needs the value 1. One half alone has no effect.",
        )
        .advise(format!("{ENABLE_VARIABLE}=1 turns the layer on; to turn it off, unset the variable")),
    )
}

fn filtered(surroundings: &Surroundings) -> Option<Finding> {
    let by = disabling_word(|name| surroundings.variable(name).map(OsStr::to_owned))?;
    Some(
        Finding::problem(
            "filtered",
            format!("{DISABLE_LAYERS} contains {by:?}, which matches this layer"),
            "The Vulkan loader skips the Vulkan half, and the OpenXR half has no effect alone.",
        )
        .advise("remove it from that variable, or start programs by `parafovea run`, which overrules it"),
    )
}

/// `VK_IMPLICIT_LAYER_PATH` replaces all other folders.
fn other_folders(surroundings: &Surroundings) -> Option<Finding> {
    let folders = surroundings.variable("VK_IMPLICIT_LAYER_PATH")?;
    Some(
        Finding::warning(
            "other-folders",
            format!("VK_IMPLICIT_LAYER_PATH is {:?}", folders.to_string_lossy()),
            "Newer Vulkan loaders search only this folder for implicit layers.",
        )
        .advise("use VK_ADD_IMPLICIT_LAYER_PATH, which adds to the usual folders"),
    )
}

/// The specification of base directories has a path that is not absolute ignored; loaders do not all do so.
fn relative_homes(surroundings: &Surroundings) -> Option<Finding> {
    let names = ["HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME"];
    let is_relative = |name: &&str| {
        surroundings.variable(name).is_some_and(|path| !path.to_string_lossy().starts_with('/'))
    };
    let name = names.into_iter().find(is_relative)?;
    Some(
        Finding::problem(
            "relative-home",
            format!("{name} is not an absolute path"),
            "Loaders and Parafovea then search different folders, depending on the working directory.",
        )
        .advise(format!("make {name} an absolute path, or unset it")),
    )
}
