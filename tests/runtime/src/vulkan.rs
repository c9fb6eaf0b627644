//! Vulkan: the application's device as the runtime uses it.

mod device;
pub(crate) mod enable;
pub(crate) mod enable2;
pub(crate) mod format;
mod images;
pub(crate) mod render;

pub(crate) use device::Gpu;
pub(crate) use images::{Images, Shape};

use crate::fault::Fault;
use ash::vk;

/// A failed Vulkan call as a failure of the runtime.
pub(crate) fn failed(call: &'static str) -> impl Fn(vk::Result) -> Fault {
    move |error| Fault::runtime(format!("{call}: {error:?}"))
}
