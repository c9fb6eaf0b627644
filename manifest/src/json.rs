//! The manifests by which the two loaders find the layer.
//!
//! Sources: OpenXR loader specification, "API Layer Manifest File Format", and the loader's
//! `manifest_file.cpp`; Vulkan loader, `LoaderLayerInterface.md`, "Layer Manifest File Format".

use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Turns both halves on where it is set. The OpenXR loader asks only whether it is set, the Vulkan loader
/// whether it is `1`.
pub const ENABLE_VARIABLE: &str = "PARAFOVEA";

/// Turns both halves off if it is set, regardless of other variables.
pub const DISABLE_VARIABLE: &str = "DISABLE_PARAFOVEA";

/// The extension by which applications get the gaze.
pub const EYE_GAZE_EXTENSION: &str = "XR_EXT_eye_gaze_interaction";

/// Major and minor version of Vulkan that the layer works with. Loaders drop an implicit layer whose version is
/// below the application's.
pub const VULKAN_VERSION: [u32; 2] = [1, 4];

/// The two layers in the one library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// The OpenXR API layer.
    OpenXr,
    /// The Vulkan layer.
    Vulkan,
}

/// Activation of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activation {
    /// By itself, where [`ENABLE_VARIABLE`] is set and [`DISABLE_VARIABLE`] is not.
    Implicit,
    /// By its name, in an application or a variable of the loader.
    Explicit,
}

impl Half {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::OpenXr, Self::Vulkan];

    /// The loader's name for it.
    pub const fn layer_name(self) -> &'static str {
        match self {
            Self::OpenXr => "XR_APILAYER_PARAFOVEA_foveation",
            Self::Vulkan => "VK_LAYER_PARAFOVEA_foveation",
        }
    }

    /// The function that the library exports for the loader's first call. It is not named as the loader names
    /// it, so that it cannot be mistaken for that of another layer in the same process.
    pub const fn negotiate(self) -> &'static str {
        match self {
            Self::OpenXr => "parafovea_xrNegotiateLoaderApiLayerInterface",
            Self::Vulkan => "parafovea_vkNegotiateLoaderLayerInterfaceVersion",
        }
    }

    /// Path of the implicit manifest below a data directory (`$XDG_DATA_HOME`, one of `$XDG_DATA_DIRS`), for the loader.
    pub fn manifest_path(self, data: &Path) -> PathBuf {
        data.join(match self {
            Self::OpenXr => "openxr/1/api_layers/implicit.d/parafovea.json",
            Self::Vulkan => "vulkan/implicit_layer.d/parafovea.json",
        })
    }

    /// The manifest. Both loaders look for a `library` that is a bare name on the library path, for a relative
    /// path below the manifest's folder.
    pub fn manifest(self, library: &str, activation: Activation) -> String {
        format!("{:#}\n", self.value(library, activation))
    }

    /// The implicit manifest for a user who gives the gaze to applications (`gaze.offer`): the OpenXR loader lists the extension wherever the
    /// layer is enabled.
    pub fn manifest_with_eye_gaze(self, library: &str) -> String {
        let mut file = self.value(library, Activation::Implicit);
        if self == Self::OpenXr {
            // The newest revision of the extension.
            file[self.section()]["instance_extensions"] =
                json!([{ "name": EYE_GAZE_EXTENSION, "extension_version": "2" }]);
        }
        format!("{file:#}\n")
    }

    /// Whether a manifest lists eye gaze among the layer's extensions.
    pub fn lists_eye_gaze(self, text: &str) -> bool {
        serde_json::from_str::<Value>(text).is_ok_and(|value| {
            let extensions = value[self.section()]["instance_extensions"].as_array();
            extensions
                .is_some_and(|list| list.iter().any(|extension| extension["name"] == EYE_GAZE_EXTENSION))
        })
    }

    fn value(self, library: &str, activation: Activation) -> Value {
        let mut layer = json!({
            "name": self.layer_name(),
            "library_path": library,
            "implementation_version": "1",
            "description": "Parafovea: foveated rendering for existing OpenXR applications",
        });
        let mut file = match self {
            Self::OpenXr => {
                // Taken by loaders of 1.0 and of 1.1; the layer negotiates the version that it speaks.
                layer["api_version"] = "1.0".into();
                layer["functions"] = json!({ "xrNegotiateLoaderApiLayerInterface": self.negotiate() });
                json!({ "file_format_version": "1.0.0" })
            }
            Self::Vulkan => {
                layer["type"] = "GLOBAL".into();
                let [major, minor] = VULKAN_VERSION;
                layer["api_version"] = format!("{major}.{minor}.0").into();
                layer["functions"] = json!({ "vkNegotiateLoaderLayerInterfaceVersion": self.negotiate() });
                // The first version of the format that knows this function.
                json!({ "file_format_version": "1.1.0" })
            }
        };
        if activation == Activation::Implicit {
            let variable = |name: &str| match self {
                Self::OpenXr => name.into(),
                Self::Vulkan => json!({ name: "1" }),
            };
            layer["enable_environment"] = variable(ENABLE_VARIABLE);
            layer["disable_environment"] = variable(DISABLE_VARIABLE);
        }
        file[self.section()] = layer;
        file
    }

    /// Whether `text` is a manifest of this layer, of this version or another.
    pub fn is_manifest(self, text: &str) -> bool {
        serde_json::from_str::<Value>(text)
            .is_ok_and(|value| value[self.section()]["name"] == self.layer_name())
    }

    /// The member of the manifest that describes the layer.
    const fn section(self) -> &'static str {
        match self {
            Self::OpenXr => "api_layer",
            Self::Vulkan => "layer",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(half: Half, activation: Activation) -> Value {
        serde_json::from_str(&half.manifest("/lib/libparafovea.so", activation)).unwrap()
    }

    #[test]
    fn the_openxr_manifest_is_what_the_loader_demands() {
        assert_eq!(
            value(Half::OpenXr, Activation::Implicit),
            json!({
                "file_format_version": "1.0.0",
                "api_layer": {
                    "name": "XR_APILAYER_PARAFOVEA_foveation",
                    "library_path": "/lib/libparafovea.so",
                    "api_version": "1.0",
                    "implementation_version": "1",
                    "description": "Parafovea: foveated rendering for existing OpenXR applications",
                    "functions": {
                        "xrNegotiateLoaderApiLayerInterface": "parafovea_xrNegotiateLoaderApiLayerInterface",
                    },
                    "enable_environment": "PARAFOVEA",
                    "disable_environment": "DISABLE_PARAFOVEA",
                },
            })
        );
    }

    #[test]
    fn the_vulkan_manifest_is_what_the_loader_demands() {
        assert_eq!(
            value(Half::Vulkan, Activation::Implicit),
            json!({
                "file_format_version": "1.1.0",
                "layer": {
                    "name": "VK_LAYER_PARAFOVEA_foveation",
                    "type": "GLOBAL",
                    "library_path": "/lib/libparafovea.so",
                    "api_version": "1.4.0",
                    "implementation_version": "1",
                    "description": "Parafovea: foveated rendering for existing OpenXR applications",
                    "functions": {
                        "vkNegotiateLoaderLayerInterfaceVersion":
                            "parafovea_vkNegotiateLoaderLayerInterfaceVersion",
                    },
                    "enable_environment": { "PARAFOVEA": "1" },
                    "disable_environment": { "DISABLE_PARAFOVEA": "1" },
                },
            })
        );
    }

    #[test]
    fn a_manifest_with_eye_gaze_has_one_extension_more() {
        for half in Half::BOTH {
            let plain = half.manifest("x.so", Activation::Implicit);
            let listing = half.manifest_with_eye_gaze("x.so");
            assert!(!half.lists_eye_gaze(&plain) && !half.lists_eye_gaze("{}"));
            assert_eq!(half.lists_eye_gaze(&listing), half == Half::OpenXr);
            let mut value: Value = serde_json::from_str(&listing).unwrap();
            let extensions = value[half.section()].as_object_mut().unwrap().remove("instance_extensions");
            assert_eq!(value, serde_json::from_str::<Value>(&plain).unwrap());
            // The loader's own spelling: a number as a string.
            let expected = json!([{ "name": EYE_GAZE_EXTENSION, "extension_version": "2" }]);
            assert_eq!(extensions, (half == Half::OpenXr).then_some(expected));
        }
    }

    #[test]
    fn an_explicit_manifest_has_no_variables_and_is_else_the_same() {
        for half in Half::BOTH {
            let mut implicit = value(half, Activation::Implicit);
            let layer = implicit[half.section()].as_object_mut().unwrap();
            assert!(layer.remove("enable_environment").is_some());
            assert!(layer.remove("disable_environment").is_some());
            assert_eq!(implicit, value(half, Activation::Explicit));
        }
    }

    #[test]
    fn a_manifest_is_known_by_its_layer() {
        for half in Half::BOTH {
            assert!(half.is_manifest(&half.manifest("x.so", Activation::Explicit)));
        }
        let openxr = Half::OpenXr.manifest("x.so", Activation::Implicit);
        assert!(!Half::Vulkan.is_manifest(&openxr));
        for text in ["", "[]", "{}", "{\"layer\": 1}", "{\"layer\": {\"name\": \"VK_LAYER_other\"}}"] {
            assert!(!Half::Vulkan.is_manifest(text), "{text}");
        }
    }

    #[test]
    fn a_path_with_quotes_stays_what_it_is() {
        let path = "/home/a \"b\"\\c/é.so";
        let text = Half::Vulkan.manifest(path, Activation::Implicit);
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap()["layer"]["library_path"], path);
    }
}
