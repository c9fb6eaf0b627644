//! The OpenXR half: an OpenXR API layer that tracks instances, sessions and swapchains, and works on frames.
//!
//! The OpenXR loader calls [`negotiate()`] first. Only the functions in `dispatch` are hooked; for all others,
//! `xrGetInstanceProcAddr` gives the next layer's, so that they cost nothing.
//!
//! An instance is *inert* where Parafovea is not wanted (`DISABLE_PARAFOVEA`, elevated rights, `enabled = false`)
//! and then has no hooks. A session is *active* when its device is Vulkan, has our Vulkan half and takes our work,
//! else inert. A part that fails later is turned off for the session; the application goes on.

use std::ffi::CStr;

mod actions;
mod amended_layers;
mod dispatch;
mod frame;
mod functions;
mod gaze;
mod instance;
mod negotiate;
mod offer;
mod plan;
mod proc_addr;
mod session;
mod spaces;
mod structures;
mod submission;
mod swapchain;
mod vulkan_activation;
mod vulkan_device;

pub use negotiate::negotiate;

/// The layer's name, as its manifest gives it to the OpenXR loader.
pub const LAYER_NAME: &CStr = c"XR_APILAYER_PARAFOVEA_foveation";

#[cfg(test)]
mod tests;
