//! Framebuffers without views: they are named when a pass begins.

use super::render_pass;
use crate::gpu::Kind;
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use ash::vk;

pub const STYLE: Style = Style {
    name: "imageless",
    says: "imageless framebuffers, whose views are named when a pass begins",
    needs: Needs {
        vulkan: vk::API_VERSION_1_2,
        features: &[Feature::ImagelessFramebuffer],
        ..Needs::NOTHING
    },
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start: |app| render_pass::start(app, Kind::Imageless, |_| {}),
    ..Style::PLAIN
};
