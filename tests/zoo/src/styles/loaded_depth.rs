//! The scene in two passes for each eye: the second loads colour and depth of the first.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind};
use crate::scene::{BOXES, Draw, FORWARD, VERTICES};
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "loaded-depth",
    says: "half of the boxes in a second pass, which loads colour and depth",
    can_set_rates: true,
    passes: |size, _| PassTruth::halves(size, COLOR),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let [first, second] = app.halves(Kind::RenderPass, depth.depth_cleared(1.0))?;
    // The render passes of both differ in loads alone: they are compatible.
    let pipelines = app.scene.pipelines(gpu, &first[0][0].target, &FORWARD)?;
    let graphics = vk::PipelineBindPoint::GRAPHICS;
    let half = BOXES / 2;
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        for eye in EYES {
            let passes = [&first[eye][frame.color[eye]], &second[eye][frame.color[eye]]];
            for (pass, from) in passes.into_iter().zip([0, half]) {
                pass.begin(gpu, commands);
                app.scene.bind(gpu, commands, app.scene.set, frame.slot);
                let draw = Draw { view: eye as u32, far: pipelines.far, ..Draw::default() };
                app.scene.push(gpu, commands, &draw);
                // SAFETY: the pass was begun, and all that the pipelines need is bound.
                unsafe {
                    gpu.cmd_bind_pipeline(commands, graphics, pipelines.boxes);
                    gpu.cmd_draw(commands, VERTICES, half, 0, from);
                    if from > 0 {
                        gpu.cmd_bind_pipeline(commands, graphics, pipelines.sky);
                        gpu.cmd_draw(commands, 3, 1, 0, 0);
                    }
                }
                pass.end(gpu, commands);
            }
        }
        Ok(())
    }))
}
