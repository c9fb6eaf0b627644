//! Failures that end a case early.

use openxr_sys as xr;

/// Reason why a case could not go on.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// An OpenXR call that had to succeed did not.
    #[error("{call} returned {}", name(*.result))]
    Xr { call: &'static str, result: xr::Result },
    /// A Vulkan call did not succeed.
    #[error("Vulkan: {0}")]
    Vulkan(#[from] ash::vk::Result),
    /// A file cannot be used.
    #[error("the lock of the queue: {0}")]
    File(#[from] std::io::Error),
    /// A loader is not installed.
    #[error("cannot load a loader library: {0}")]
    Library(#[from] libloading::Error),
    /// The OpenXR loader does not offer a function.
    #[error("no function {0}")]
    Function(String),
    /// The runtime or the device lacks a feature of the case.
    #[error("{0}")]
    Unsupported(String),
}

/// A result's name in the specification.
pub fn name(result: xr::Result) -> String {
    format!("XR_{result:?}")
}

/// Turns an error code into a failure, and hands on a success code.
pub fn succeeded(call: &'static str, result: xr::Result) -> Result<xr::Result, Failure> {
    if result.into_raw() >= 0 { Ok(result) } else { Err(Failure::Xr { call, result }) }
}
