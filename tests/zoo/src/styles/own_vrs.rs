//! An application that has fragment shading rates of its own: 2x2 by its pipelines.

use super::render_pass;
use crate::gpu::Kind;
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use ash::vk;

pub const STYLE: Style = Style {
    name: "own-vrs",
    says: "shades at 2x2 itself, by VK_KHR_fragment_shading_rate",
    needs: Needs {
        vulkan: vk::API_VERSION_1_2,
        extensions: &[c"VK_KHR_fragment_shading_rate"],
        features: &[Feature::PipelineFragmentShadingRate],
        ..Needs::NOTHING
    },
    direct: false,
    likeness: Some(14.0),
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, at a rate of its own"),
    start: |app| render_pass::start(app, Kind::RenderPass, |spec| spec.rate = Some([2, 2])),
    ..Style::PLAIN
};
