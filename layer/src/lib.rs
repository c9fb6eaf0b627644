//! The shared library that the OpenXR loader and the Vulkan loader both load into an application.
//!
//! A frame's path: [`xr`] sees views, gaze and submission and hands a finished frame to [`passes`], which
//! draw with [`gpu`] on the device that [`vk`] tracked; [`link`] is where the two halves meet.

pub mod abi;
pub mod config;
pub mod gpu;
pub mod inputs;
pub mod link;
pub mod log;
pub mod passes;
mod registry;
pub mod vk;
pub mod xr;
