//! Command buffers that are recorded once, for each eye and each of its swapchain's images.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "prerecorded",
    says: "command buffers that are recorded once and submitted in every frame",
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, recorded at the start"),
    start,
    ..Style::PLAIN
};

/// The one part of the uniforms that the recorded commands know.
const SLOT: usize = 0;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let mut recorded = Vec::new();
    for eye in EYES {
        let buffers = gpu.command_buffers(eyes[eye].len() as u32, vk::CommandBufferLevel::PRIMARY)?;
        for (commands, pass) in buffers.iter().zip(&eyes[eye]) {
            gpu.record(*commands, vk::CommandBufferUsageFlags::empty(), |commands| {
                pass.begin(gpu, commands);
                app.scene.draw(gpu, commands, &pipelines, SLOT, eye as u32);
                pass.end(gpu, commands);
                Ok(())
            })?;
        }
        recorded.push(buffers);
    }
    // A pass counts when it is submitted.
    let pass = gpu.take_begun()[0];
    Ok(Box::new(move |frame| {
        // SAFETY: this thread is the only one that uses the queue.
        unsafe { gpu.queue_wait_idle(gpu.queue) }?;
        app.scene.write(SLOT, &frame.uniforms);
        for eye in EYES {
            frame.after.borrow_mut().push(recorded[eye][frame.color[eye]]);
            gpu.note_pass(pass);
        }
        Ok(())
    }))
}
