//! The scene in secondary command buffers, one for the boxes and one for the sky.

use crate::app::{App, EYES, Frame, Recorder};
use crate::gpu::{ImageSpec, Kind, Pass, PassSpec};
use crate::scene::{BOXES, Draw, FORWARD, IN_FLIGHT, Pipelines, VERTICES};
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "secondaries",
    says: "each pass holds two secondary command buffers",
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, in secondary command buffers"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let secondaries = gpu.command_buffers(4 * IN_FLIGHT as u32, vk::CommandBufferLevel::SECONDARY)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            let pass = &eyes[eye][frame.color[eye]];
            let first = 4 * frame.slot + 2 * eye;
            let [boxes, sky] = [secondaries[first], secondaries[first + 1]];
            scene(app, frame, pass, &pipelines, [boxes, sky], eye)?;
            pass.begin_for_secondaries(gpu, frame.commands);
            // SAFETY: the pass was begun for them; both were recorded for it.
            unsafe { gpu.cmd_execute_commands(frame.commands, &[boxes, sky]) };
            pass.end(gpu, frame.commands);
        }
        Ok(())
    }))
}

/// Records the scene for a pass and a view.
pub fn scene(
    app: &App,
    frame: &Frame,
    pass: &Pass,
    pipelines: &Pipelines,
    [boxes, sky]: [vk::CommandBuffer; 2],
    view: usize,
) -> Result<()> {
    let draw = Draw { view: view as u32, far: pipelines.far, ..Draw::default() };
    record(app, frame, pass, boxes, (pipelines.boxes, [VERTICES, BOXES]), &draw)?;
    record(app, frame, pass, sky, (pipelines.sky, [3, 1]), &draw)
}

/// Records a draw of so many vertices and instances for a pass.
fn record(
    app: &App,
    frame: &Frame,
    pass: &Pass,
    commands: vk::CommandBuffer,
    (pipeline, [vertices, instances]): (vk::Pipeline, [u32; 2]),
    draw: &Draw,
) -> Result<()> {
    let gpu = app.gpu;
    let inheritance = vk::CommandBufferInheritanceInfo::default()
        .render_pass(pass.target.render_pass)
        .framebuffer(pass.framebuffer);
    let info = vk::CommandBufferBeginInfo::default()
        .flags(
            vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT | vk::CommandBufferUsageFlags::RENDER_PASS_CONTINUE,
        )
        .inheritance_info(&inheritance);
    // SAFETY: the fence of this slot was waited for, so that nothing uses the command buffer.
    unsafe { gpu.begin_command_buffer(commands, &info) }?;
    gpu.set_viewport(commands, app.size);
    app.scene.bind(gpu, commands, app.scene.set, frame.slot);
    app.scene.push(gpu, commands, draw);
    // SAFETY: it is being recorded inside a pass that the pipeline fits, with all that this needs.
    unsafe {
        gpu.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipeline);
        gpu.cmd_draw(commands, vertices, instances, 0, 0);
        Ok(gpu.end_command_buffer(commands)?)
    }
}
