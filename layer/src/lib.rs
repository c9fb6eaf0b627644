//! The shared library that the OpenXR loader and the Vulkan loader both load into an application.
//!
//! A frame's path: [`xr`] sees views, gaze and submission and hands a finished frame to [`kernels`], which
//! draw with [`gpu`] on the device that [`vk`] tracked; [`link`] is where the two halves meet.

// Unsafe code stays within five modules.
#![deny(unsafe_code)]

#[allow(unsafe_code)]
pub mod abi;
#[allow(unsafe_code)]
pub mod backend;
mod cache_file;
pub mod config;
#[allow(unsafe_code)]
pub mod gpu;
pub mod inputs;
pub mod kernels;
pub mod link;
pub mod log;
pub mod pass_detection;
pub mod planner;
pub mod rate_map;
mod registry;
pub mod status;
#[allow(unsafe_code)]
pub mod vk;
#[allow(unsafe_code)]
pub mod xr;
