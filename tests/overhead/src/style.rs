//! How passes are recorded.

use clap::ValueEnum;

/// How an application names a pass's attachments.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Style {
    /// Render pass objects and framebuffers, as of Vulkan 1.0.
    RenderPass,
    /// vkCmdBeginRendering, as of Vulkan 1.3.
    DynamicRendering,
}
