//! Compute work that moves the lights comes first, on a second queue where there is one.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::{Draw, FORWARD, IN_FLIGHT, STAGES};
use crate::shader;
use crate::style::Style;
use crate::support::{Needs, Queues};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "async-compute",
    says: "compute work on a second queue, where there is one, moves the lights before the scene",
    needs: Needs { queues: Queues::SecondIfThere, ..Needs::NOTHING },
    likeness: Some(0.5),
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, after compute work"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let (gpu, scene) = (app.gpu, &app.scene);
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let lights = gpu.compute_pipeline(shader!("lights", "main"), scene.layout)?;
    let set = scene.textured(gpu, &[])?;
    scene.with_storage(gpu, set, scene.uniforms.handle);
    let buffers = gpu.command_buffers(IN_FLIGHT as u32, vk::CommandBufferLevel::PRIMARY)?;
    let done = (0..IN_FLIGHT).map(|_| gpu.semaphore()).collect::<Result<Vec<_>>>()?;
    let point = vk::PipelineBindPoint::COMPUTE;
    Ok(Box::new(move |frame| {
        scene.write(frame.slot, &frame.uniforms.dark());
        let draw = Draw { value: frame.uniforms.phase(), count: frame.slot as u32, ..Draw::default() };
        let commands = buffers[frame.slot];
        gpu.record(commands, vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT, |commands| {
            // SAFETY: the command buffer is being recorded; all bound objects are live.
            unsafe {
                gpu.cmd_bind_pipeline(commands, point, lights);
                gpu.cmd_bind_descriptor_sets(commands, point, scene.layout, 0, &[set], &[0]);
                gpu.cmd_push_constants(commands, scene.layout, STAGES, 0, bytemuck::bytes_of(&draw));
                gpu.cmd_dispatch(commands, 1, 1, 1);
            }
            Ok(())
        })?;
        gpu.submit_aside(commands, done[frame.slot])?;
        frame.waits.borrow_mut().push(done[frame.slot]);
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
