//! The way of most samples: for each eye a VkRenderPass over its swapchain's image, depth beside it.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "render-pass",
    says: "a VkRenderPass for each eye, straight into its swapchain",
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start: |app| start(app, Kind::RenderPass, |_| {}),
    ..Style::PLAIN
};

/// A pass for each eye, of the given kind, with pipelines that `change` alters.
pub fn start<'a>(app: &'a App<'a>, kind: Kind, change: impl Fn(&mut PipelineSpec)) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app.eye_passes(kind, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines_with(app.gpu, &eyes[0][0].target, &FORWARD, change)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
