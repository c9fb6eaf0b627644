//! The shared library that the OpenXR loader and the Vulkan loader both load into an application.
//!
//! The path of a frame: [`xr`] locates gaze and views; [`planner`] makes the plan with `parafovea_core::plan`; [`link`] passes it to [`vk`].
//! At vkQueueSubmit, [`pass_detection`] recognises the passes of the scene, and [`rate_map`] resolves the plan for the [`backend`] of the
//! device. At xrEndFrame, [`kernels`] compose the images of virtual swapchains with [`gpu`]. `layer/README.md` lists the calls.

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
