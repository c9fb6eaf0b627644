//! Answers of Vulkan and OpenXR, as the program `parafovea-probe` prints it in JSON. Each answer is of a run of its own, so
//! that a runtime that hangs or crashes takes nothing else with it.

use serde::{Deserialize, Serialize};

/// Beginning of the line with the answer; all other lines are of loaders, layers and drivers. The rest is a `Result` in JSON.
pub const ANSWER_PREFIX: &str = "parafovea-probe: ";

/// The answers; an error is one line.
#[derive(Clone, Debug)]
pub struct Probed {
    /// Layers that the loaders list, with Parafovea enabled.
    pub layers: Result<LoaderLayers, String>,
    /// Version and devices of Vulkan.
    pub vulkan: Result<VulkanAnswer, String>,
    /// Devices that are created with the layer; an error is a crash, a hang or a failure of the program.
    pub created: Result<Vec<CreatedDevice>, String>,
    /// The same without the layer.
    pub created_without_layer: Result<Vec<CreatedDevice>, String>,
    /// OpenXR runtime.
    pub openxr: Result<RuntimeAnswer, String>,
}

impl Default for Probed {
    /// Nothing was probed.
    fn default() -> Self {
        let nobody = || "not probed".to_owned();
        Self {
            layers: Err(nobody()),
            vulkan: Err(nobody()),
            created: Err(nobody()),
            created_without_layer: Err(nobody()),
            openxr: Err(nobody()),
        }
    }
}

/// Names of the layers that the loaders list.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoaderLayers {
    /// OpenXR API layers; `None` without a loader.
    pub openxr: Option<Vec<String>>,
    /// Vulkan layers; `None` without a loader.
    pub vulkan: Option<Vec<String>>,
}

/// The answer of Vulkan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VulkanAnswer {
    /// The version of Vulkan that the loader speaks: major, minor, patch.
    pub version: [u32; 3],
    /// The devices.
    pub devices: Vec<Device>,
}

/// A device of Vulkan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Device {
    /// Its name.
    pub name: String,
    /// The driver and its version, as text; empty if it reports none.
    pub driver: String,
    /// It is a CPU.
    pub is_cpu: bool,
    /// The version of Vulkan that it speaks: major, minor, patch.
    pub version: [u32; 3],
    /// Rates that attachments can ask for at one sample, such as `4x4`; empty without the extension
    /// `VK_KHR_fragment_shading_rate` or its feature `attachmentFragmentShadingRate`.
    pub rates: Vec<String>,
    /// Smallest and largest size of the texels of such attachments, pixels.
    pub texel: [[u32; 2]; 2],
    /// Whether each layer or view of a picture can have rates of its own.
    #[serde(default)]
    pub layered: bool,
    /// Most samples a pixel that rates go together with; 0: not known.
    #[serde(default)]
    pub samples: u32,
    /// `VkDriverId`; 0: not known.
    #[serde(default)]
    pub driver_id: u32,
    /// The driver's version, as Mesa encodes it: major, minor, patch.
    #[serde(default)]
    pub driver_version: [u32; 3],
}

/// A device that was created, and destroyed again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CreatedDevice {
    /// Its name.
    pub name: String,
    /// Reason why it could not be created; `None` where it was.
    pub failure: Option<String>,
    /// Whether the layer is on it, and ready to work.
    pub has_layer: bool,
}

/// The answer of the OpenXR runtime.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RuntimeAnswer {
    /// The runtime's name; empty where there is no instance.
    pub name: String,
    /// Its version: major, minor, patch.
    pub version: [u32; 3],
    /// Extensions that it offers.
    pub extensions: Vec<String>,
    /// The headset's name; `None` where it has none at this moment.
    pub system: Option<String>,
    /// Whether the headset tracks eyes, where it is known (`XrSystemEyeGazeInteractionPropertiesEXT`).
    pub tracks_eyes: Option<bool>,
    /// Reason why it goes no further, such as the result of a call; empty where all was answered.
    pub failure: String,
}
