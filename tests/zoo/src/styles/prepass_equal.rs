//! Depth first, in a pass of its own; then colour where depth is equal.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "prepass-equal",
    says: "a depth pre-pass, then colour with EQUAL tests",
    can_set_rates: true,
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, crate::gpu::DEPTH, eyes, "depth pre-pass"),
                PassTruth::new(size, COLOR, eyes, "scene, where depth is equal"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let cleared = depth.depth_cleared(1.0).stored();
    let before = gpu.pass(Kind::RenderPass, PassSpec::depth(cleared))?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| {
        PassSpec::new(color.overwritten(), cleared.loaded().discarded())
    })?;
    let mut first = PipelineSpec::new(FORWARD.boxes[0], FORWARD.boxes[1], Depth::LESS);
    first.fragment = None;
    let first = gpu.pipeline(&first, app.scene.layout, &before.target)?;
    let second = app.scene.pipelines_with(gpu, &eyes[0][0].target, &FORWARD, |spec| {
        if spec.depth.write {
            spec.depth = Depth { test: Some(vk::CompareOp::EQUAL), write: false };
        }
    })?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            before.begin(gpu, frame.commands);
            app.scene.draw_boxes(gpu, frame.commands, first, (app.scene.set, frame.slot), eye);
            before.end(gpu, frame.commands);
            app.show(frame, &eyes[eye][frame.color[eye]], &second, eye);
        }
        Ok(())
    }))
}
