//! A strict, scripted OpenXR runtime without a headset, for tests.
//!
//! As a shared library (`libparafovea_mock_runtime.so`) it is found by the OpenXR loader through a manifest
//! ([`write_runtime_manifest`], `XR_RUNTIME_JSON`); one scenario file ([`scenario`]) describes the headset and the actions
//! of its wearer; the application's calls are recorded ([`record`]). `README.md` is the manual.

mod abi;
mod actions;
mod clock;
mod compositor;
mod debug_utils;
mod dispatch;
mod events;
mod fault;
mod frame;
mod handles;
mod injected;
mod instance;
mod layers;
mod manifest;
mod paths;
mod pose;
pub mod record;
mod recorder;
mod runtime;
pub mod scenario;
mod script;
mod session;
mod spaces;
mod swapchain;
mod system;
mod timespec;
mod turns;
mod views;
mod visibility_mask;
mod vulkan;

pub use dispatch::xrNegotiateLoaderRuntimeInterface;
pub use manifest::write_runtime_manifest;

/// The environment variable that names the scenario file.
pub const SCENARIO_VARIABLE: &str = "PARAFOVEA_MOCK_SCENARIO";
