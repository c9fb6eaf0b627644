//! Variables by which users, launchers and applications filter the Vulkan loader's layers, since loader 1.3.234; exceptions since 1.3.262.
//!
//! Blender sets `VK_LOADER_LAYERS_DISABLE` at its start, in its own process.
//!
//! Source: `LoaderLayerInterface.md`, "Layer Filtering".

use crate::json::Half;
use std::ffi::OsString;

/// Layers that stay out.
pub const DISABLE_LAYERS: &str = "VK_LOADER_LAYERS_DISABLE";

/// Exceptions from that.
pub const ALLOW_LAYERS: &str = "VK_LOADER_LAYERS_ALLOW";

/// Layers that are loaded in any case, except implicit ones whose own variable turns them off.
pub const ENABLE_LAYERS: &str = "VK_LOADER_LAYERS_ENABLE";

/// The word of `VK_LOADER_LAYERS_DISABLE` that turns the Vulkan half off; None without one, or where other variables overrule it.
pub fn disabling_word(variable: impl Fn(&str) -> Option<OsString>) -> Option<String> {
    let filters = |name| variable(name).unwrap_or_default().to_string_lossy().into_owned();
    let disabled = filters(DISABLE_LAYERS);
    // The second word has its meaning in this variable alone.
    let by =
        disabled.split(',').find(|word| matches_layer(word) || word.eq_ignore_ascii_case("~implicit~"))?;
    let overrules = |name| filters(name).split(',').any(matches_layer);
    (!overrules(ALLOW_LAYERS) && !overrules(ENABLE_LAYERS)).then(|| by.to_owned())
}

/// A value of `VK_LOADER_LAYERS_ENABLE` that has the Vulkan half loaded, besides the layers of the given value. Ours comes first: the loader reads
/// sixteen names.
pub fn enabling(value: Option<OsString>) -> OsString {
    let value = value.unwrap_or_default();
    if value.to_string_lossy().split(',').any(matches_layer) {
        return value;
    }
    let mut enabling = OsString::from(Half::Vulkan.layer_name());
    if !value.is_empty() {
        enabling.push(",");
        enabling.push(value);
    }
    enabling
}

/// Whether a filter of the loader means our layer: its name, or part of it with `*` at the ends; upper and lower case are the same, and
/// spaces count (Vulkan loader, `loader_environment.c`, `determine_filter_type` and `check_name_matches_filter_environment_var`).
fn matches_layer(filter: &str) -> bool {
    let (name, filter) = (Half::Vulkan.layer_name().to_ascii_lowercase(), filter.to_ascii_lowercase());
    if ["~all~", "*", "**"].contains(&filter.as_str()) {
        return true;
    }
    match (filter.strip_prefix('*'), filter.strip_suffix('*')) {
        (Some(rest), Some(_)) => name.contains(rest.strip_suffix('*').unwrap_or(rest)),
        (Some(end), None) => name.ends_with(end),
        (None, Some(begin)) => name.starts_with(begin),
        (None, None) => name == filter,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_means_the_layer_as_the_loader_reads_it() {
        for glob in [
            "~ALL~",
            "*",
            "**",
            "VK_LAYER_PARAFOVEA*",
            "vk_layer_parafovea*",
            "*FOVEATION",
            "*PARAFOVEA*",
            "*_foveation",
            "VK_LAYER_PARAFOVEA_foveation",
        ] {
            assert!(matches_layer(glob), "{glob}");
        }
        for glob in
            ["", "~explicit~", "~implicit~", "VK_LAYER_PARAFOVEA", "*MESA*", "PARAFOVEA*", " *", "~all~ "]
        {
            assert!(!matches_layer(glob), "{glob}");
        }
    }

    #[test]
    fn the_layer_is_enabled_beside_others_in_spite_of_any_filter() {
        let enabling = |value: &str| enabling(Some(value.into())).into_string().unwrap();
        assert_eq!(super::enabling(None), "VK_LAYER_PARAFOVEA_foveation");
        assert_eq!(enabling(""), "VK_LAYER_PARAFOVEA_foveation");
        assert_eq!(enabling("*MESA*"), "VK_LAYER_PARAFOVEA_foveation,*MESA*");
        assert_eq!(enabling("*parafovea*"), "*parafovea*");
        let word = |enabled: Option<OsString>| {
            disabling_word(|name| match name {
                DISABLE_LAYERS => Some("~implicit~".into()),
                ENABLE_LAYERS => enabled.clone(),
                _ => None,
            })
        };
        assert_eq!(word(None).as_deref(), Some("~implicit~"));
        assert_eq!(word(Some(super::enabling(None))), None);
    }
}
