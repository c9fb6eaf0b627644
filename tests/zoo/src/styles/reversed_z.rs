//! Depth 1 at the near plane and 0 at the far plane, as most engines have it.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec};
use crate::scene::{FORWARD, Pipelines, Projection, Uniforms};
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "reversed-z",
    says: "depth 1 near and 0 far, tested with GREATER",
    likeness: Some(0.5),
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(0.0)))?;
    let made = app.scene.pipelines_with(app.gpu, &eyes[0][0].target, &FORWARD, |spec| {
        let test = if spec.depth.write { vk::CompareOp::GREATER } else { vk::CompareOp::GREATER_OR_EQUAL };
        spec.depth = Depth { test: Some(test), ..spec.depth };
    })?;
    let pipelines = Pipelines { far: 0.0, ..made };
    Ok(Box::new(move |frame| {
        let projection = Projection { reversed: true, ..Projection::default() };
        app.scene.write(frame.slot, &Uniforms::new(frame.animated, frame.views, projection));
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
