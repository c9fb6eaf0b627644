//! The Vulkan half: a Vulkan layer (loader interface version 2) that tracks instances and devices.
//!
//! The Vulkan loader calls [`negotiate()`] first, which hands out the functions of `proc_addr`; everything else is reached through them. Only
//! the functions in `dispatch` are hooked. All other functions that record commands are the next layer's, so that they cost nothing.
//!
//! States: *inert*, see [`Enablement`](crate::abi::Enablement): calls pass, nothing is offered to the OpenXR half. *Armed*, from
//! vkCreateDevice: the device is offered through [`crate::link`]. *Active*: an OpenXR session is bound to it.

use std::ffi::CStr;

#[macro_use]
mod hook;
#[macro_use]
mod functions;

mod armed;
mod candidates;
mod chain;
mod device;
mod device_slots;
mod dispatch;
mod dispatch_key;
pub(crate) mod frame;
mod hooks;
pub(crate) mod instance;
mod layouts;
mod link_table;
mod memory_model;
mod negotiate;
pub(crate) mod newer;
pub(crate) mod objects;
mod perception;
mod planned_texels;
mod pre_submit;
mod queue_locks;
pub(crate) mod quirks;
mod recording;
mod runtime_section;
pub(crate) mod shaders;
mod submit;
pub(crate) mod table;
mod timing;

pub use chain::NegotiateLayerInterface;
pub use negotiate::negotiate;
pub use runtime_section::in_runtime_section;
pub use shaders::{Effects, FragmentShaders};

/// The layer's name, as its manifest gives it to the Vulkan loader.
pub const LAYER_NAME: &CStr = c"VK_LAYER_PARAFOVEA_foveation";

#[cfg(test)]
mod tests;
