//! Fragments that write their depth themselves.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::{FORWARD, Shaders};
use crate::shader;
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "frag-depth",
    says: "the boxes' fragments write gl_FragDepth",
    likeness: Some(0.5),
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

const DEEP: Shaders = Shaders { boxes: [FORWARD.boxes[0], shader!("fragments", "depth_fs")], ..FORWARD };

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(app.gpu, &eyes[0][0].target, &DEEP)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
