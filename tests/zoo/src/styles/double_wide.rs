//! Both eyes beside each other in one swapchain and one pass, drawn one after the other.

use crate::app::{App, EYES, Recorder, wide};
use crate::gpu::{ImageSpec, Kind, PassSpec, passes};
use crate::scene::FORWARD;
use crate::style::{Arrangement, Style};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "double-wide",
    says: "one pass over both eyes beside each other, drawn one after the other",
    arrangement: Arrangement::DoubleWide,
    likeness: Some(0.01),
    can_set_rates: true,
    passes: |size, _| vec![PassTruth::new(wide(size), COLOR, Eyes::Both, "scene")],
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(wide(app.size)))?;
    let passes = passes(app.gpu, Kind::RenderPass, &app.color[0], |color| {
        PassSpec::new(color.overwritten(), depth.depth_cleared(1.0))
    })?;
    let pipelines = app.scene.pipelines(app.gpu, &passes[0].target, &FORWARD)?;
    Ok(Box::new(move |frame| {
        let pass = &passes[frame.color[0]];
        pass.begin(app.gpu, frame.commands);
        for eye in EYES {
            app.gpu.set_rect(frame.commands, [eye as u32 * app.size[0], 0], app.size);
            app.draw(frame, &pipelines, eye);
        }
        pass.end(app.gpu, frame.commands);
        Ok(())
    }))
}
