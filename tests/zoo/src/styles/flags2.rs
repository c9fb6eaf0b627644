//! Pipelines whose flags are in VkPipelineCreateFlags2CreateInfoKHR.

use super::render_pass;
use crate::gpu::{Kind, Making};
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;

pub const STYLE: Style = Style {
    name: "flags2",
    says: "pipelines with VkPipelineCreateFlags2CreateInfoKHR, in dynamic rendering",
    needs: Needs {
        extensions: &[c"VK_KHR_maintenance5"],
        features: &[Feature::DynamicRendering, Feature::Maintenance5],
        ..Needs::DYNAMIC
    },
    headers: 260,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start: |app| render_pass::start(app, Kind::Dynamic, |spec| spec.making = Making::Flags2),
    ..Style::PLAIN
};
