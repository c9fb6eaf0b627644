//! The rate attachment: render passes and pipelines obey a map of shading rates (`VK_KHR_fragment_shading_rate`).
//!
//! *Attach by candidate, decide by content*: the application's objects and commands are rewritten from their creation on, so that its
//! colour passes carry a rate attachment and its pipelines obey it. The content of the rate images decides the rates: by default all of it
//! is 1x1, which changes nothing.

pub mod attach;
pub mod capabilities;
pub mod commands;
pub mod create;
pub mod framebuffer;
mod full_rate;
pub mod image;
mod images;
pub mod memory;
pub mod pipeline;
pub mod pipelines;
mod refused;
pub mod render_pass;
pub mod rendering;
pub mod shader_objects;

pub use attach::RateAttachments;
pub use capabilities::NoRates;

use ash::vk;

/// The format of rate images, which is the only one that the specification requires.
const FORMAT: vk::Format = vk::Format::R8_UINT;
