//! Depth in swapchains, submitted beside colour (XR_KHR_composition_layer_depth).

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Kind, Pass, PassSpec, passes};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::support::{Needs, OpenXr};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "submitted-depth",
    says: "depth in swapchains, submitted with XR_KHR_composition_layer_depth",
    needs: Needs { openxr: OpenXr { depth: true, ..OpenXr::NOTHING }, ..Needs::NOTHING },
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    // By eye, image of depth, image of colour: the runtime may hand them out in any order.
    let mut eyes: Vec<Vec<Vec<Pass>>> = Vec::new();
    for eye in EYES {
        let spec = |depth: &crate::gpu::Image| {
            let depth = depth.depth_cleared(1.0).stored();
            passes(app.gpu, Kind::RenderPass, &app.color[eye], |color| {
                PassSpec::new(color.overwritten(), depth)
            })
        };
        eyes.push(app.depth[eye].iter().map(spec).collect::<Result<_>>()?);
    }
    let pipelines = app.scene.pipelines(app.gpu, &eyes[0][0][0].target, &FORWARD)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.depth[eye]][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
