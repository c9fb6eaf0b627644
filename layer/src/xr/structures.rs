//! The extending structures that this layer looks for.

use crate::abi::pnext::{Chain, Structure, chain};
use openxr_sys as xr;
use std::ffi::c_void;

/// The graphics binding of a Vulkan session; `XR_KHR_vulkan_enable2` has the same.
pub type VulkanBinding = xr::GraphicsBindingVulkanKHR;

macro_rules! structures {
    ($($structure:ident: $number:ident;)*) => {
        $(
            // SAFETY: openxr-sys declares it repr(C) with `ty` and `next` first, and the specification
            // gives it this type.
            unsafe impl Structure for xr::$structure {
                fn number() -> i32 {
                    xr::StructureType::$number.into_raw()
                }
            }
        )*
    };
}

structures! {
    GraphicsBindingVulkanKHR: GRAPHICS_BINDING_VULKAN_KHR;
    VulkanSwapchainFormatListCreateInfoKHR: VULKAN_SWAPCHAIN_FORMAT_LIST_CREATE_INFO_KHR;
    CompositionLayerProjection: COMPOSITION_LAYER_PROJECTION;
    CompositionLayerQuad: COMPOSITION_LAYER_QUAD;
    CompositionLayerCylinderKHR: COMPOSITION_LAYER_CYLINDER_KHR;
    CompositionLayerEquirectKHR: COMPOSITION_LAYER_EQUIRECT_KHR;
    CompositionLayerEquirect2KHR: COMPOSITION_LAYER_EQUIRECT2_KHR;
    CompositionLayerCubeKHR: COMPOSITION_LAYER_CUBE_KHR;
    CompositionLayerImageLayoutFB: COMPOSITION_LAYER_IMAGE_LAYOUT_FB;
    CompositionLayerDepthInfoKHR: COMPOSITION_LAYER_DEPTH_INFO_KHR;
    SystemEyeGazeInteractionPropertiesEXT: SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT;
    EyeGazeSampleTimeEXT: EYE_GAZE_SAMPLE_TIME_EXT;
    SpaceVelocity: SPACE_VELOCITY;
    SpaceVelocities: SPACE_VELOCITIES;
}

/// The chain that extends `structure`, without itself.
///
/// # Safety
///
/// `next` is a valid chain, as the specification demands of every structure that is passed, for `'a`.
pub unsafe fn extending<'a>(next: *const c_void) -> Chain<'a> {
    // SAFETY: the chain is valid, as `# Safety` demands; OpenXR structures begin with a type and a pointer.
    unsafe { chain(next) }
}
