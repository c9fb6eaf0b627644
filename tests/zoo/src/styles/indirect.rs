//! Draws whose parameters are in a buffer.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::{BOXES, Draw, FORWARD, VERTICES};
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "indirect",
    says: "the boxes by vkCmdDrawIndirect",
    needs: Needs {
        features: &[Feature::MultiDrawIndirect, Feature::DrawIndirectFirstInstance],
        ..Needs::NOTHING
    },
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

/// Boxes in each of the draws.
const EACH: u32 = 30;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    // vertexCount, instanceCount, firstVertex, firstInstance of VkDrawIndirectCommand.
    let draws: Vec<[u32; 4]> = (0..BOXES / EACH).map(|draw| [VERTICES, EACH, 0, draw * EACH]).collect();
    let buffer = gpu.buffer(size_of_val(&draws[..]), vk::BufferUsageFlags::INDIRECT_BUFFER)?;
    buffer.write(0, bytemuck::cast_slice(&draws));
    let graphics = vk::PipelineBindPoint::GRAPHICS;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin(gpu, frame.commands);
            app.scene.bind(gpu, frame.commands, app.scene.set, frame.slot);
            let draw = Draw { view: eye as u32, far: pipelines.far, ..Draw::default() };
            app.scene.push(gpu, frame.commands, &draw);
            // SAFETY: the pass was begun, all that the pipelines need is bound, the buffer holds so many draws.
            unsafe {
                gpu.cmd_bind_pipeline(frame.commands, graphics, pipelines.boxes);
                gpu.cmd_draw_indirect(frame.commands, buffer.handle, 0, draws.len() as u32, 16);
                gpu.cmd_bind_pipeline(frame.commands, graphics, pipelines.sky);
                gpu.cmd_draw(frame.commands, 3, 1, 0, 0);
            }
            pass.end(gpu, frame.commands);
        }
        Ok(())
    }))
}
