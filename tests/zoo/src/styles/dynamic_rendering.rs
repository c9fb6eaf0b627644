//! The same without VkRenderPass: vkCmdBeginRendering.

use super::render_pass;
use crate::gpu::Kind;
use crate::style::Style;
use crate::support::Needs;
use crate::truth::PassTruth;
use crate::xr::COLOR;

pub const STYLE: Style = Style {
    name: "dynamic-rendering",
    says: "vkCmdBeginRendering for each eye, straight into its swapchain",
    needs: Needs::DYNAMIC,
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start: |app| render_pass::start(app, Kind::Dynamic, |_| {}),
    ..Style::PLAIN
};
