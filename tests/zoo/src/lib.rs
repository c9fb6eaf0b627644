//! Applications as there are many: each *style* renders the same small scene in another way, with OpenXR and plain
//! Vulkan. They know nothing of any layer.
//!
//! A style also lists its ground truth: the render passes of a frame, and the eyes that they draw
//! ([`Style::passes`]).

mod app;
pub mod cases;
mod gpu;
mod look;
mod options;
mod random;
mod scene;
mod simulation;
mod style;
mod styles;
mod support;
mod swapchain;
mod truth;
mod xr;

pub use ash::vk::Format;
pub use gpu::Device;
pub use options::Options;
pub use style::{Arrangement, History, Style, Threads};
pub use styles::STYLES;
pub use support::{Feature, Needs, OpenXr, Queues};
pub use truth::{Eyes, PassSeen, PassTruth};
pub use xr::{End, churn, devices, run, shading_rates};

/// Prefix of the reason for a style that cannot run on this machine.
pub const SKIPPED: &str = "skipped: no device with ";

/// Prefix of the checksum of a window's last frame.
pub const WINDOW: &str = "window: ";

/// The style of this name; `random` and `new-targets` are some, too, of which nothing is known beforehand.
pub fn style(name: &str) -> Option<&'static Style> {
    STYLES
        .iter()
        .copied()
        .chain([&random::STYLE, &styles::new_targets::STYLE])
        .find(|style| style.name == name)
}
