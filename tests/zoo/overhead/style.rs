//! Ways to record render passes.

use clap::ValueEnum;

/// Way in which an application names the attachments of a pass.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Style {
    /// Render pass objects and framebuffers, as of Vulkan 1.0.
    RenderPass,
    /// vkCmdBeginRendering, as of Vulkan 1.3.
    DynamicRendering,
}
