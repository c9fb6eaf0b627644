//! The shared library that the OpenXR loader and the Vulkan loader both load into an application.
//!
//! A frame's path: [`xr`] sees views, gaze and submission and hands a finished frame to [`passes`], which
//! draw with [`gpu`] on the device that [`vk`] tracked; [`link`] is where the two halves meet.

// Unsafe code stays within four modules.
#![deny(unsafe_code)]

#[allow(unsafe_code)]
pub mod abi;
mod cache_file;
pub mod config;
#[allow(unsafe_code)]
pub mod gpu;
pub mod inputs;
pub mod link;
pub mod log;
pub mod mask;
pub mod passes;
pub mod planning;
mod registry;
pub mod scene;
pub mod status;
#[allow(unsafe_code)]
pub mod vk;
#[allow(unsafe_code)]
pub mod xr;
