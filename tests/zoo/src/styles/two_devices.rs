//! A second VkDevice beside the session's, with a pass of its own in the shape of an eye: for a window, for example.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Gpu, ImageSpec, Kind, Pass, PassSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "two-devices",
    says: "a second VkDevice that renders a picture of its own, which no eye sees",
    passes: |size, _| {
        let mut passes = vec![PassTruth::new(size, COLOR, Eyes::None, "on another device")];
        passes.extend(PassTruth::each_eye(size, COLOR, "scene"));
        passes
    },
    start,
    ..Style::PLAIN
};

/// The other device, and its draws.
struct Other {
    pass: Pass,
    commands: vk::CommandBuffer,
    gpu: Gpu,
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(app.gpu, &eyes[0][0].target, &FORWARD)?;
    let gpu = app.gpu.another()?;
    let image = gpu.image(&ImageSpec::new(COLOR, app.size))?;
    let pass = gpu.pass(Kind::RenderPass, PassSpec::color(image.cleared([0.1, 0.2, 0.3, 1.0])))?;
    let commands = gpu.command_buffers(1, vk::CommandBufferLevel::PRIMARY)?[0];
    let other = Other { pass, commands, gpu };
    Ok(Box::new(move |frame| {
        other.render()?;
        other.gpu.take_begun().into_iter().for_each(|seen| {
            app.gpu.note_pass(seen);
        });
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}

impl Other {
    fn render(&self) -> Result<()> {
        // SAFETY: this thread is the only one that uses the queue.
        unsafe { self.gpu.queue_wait_idle(self.gpu.queue) }?;
        self.gpu.record(self.commands, vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT, |commands| {
            self.pass.begin(&self.gpu, commands);
            self.pass.end(&self.gpu, commands);
            Ok(())
        })?;
        let commands = [self.commands];
        let info = vk::SubmitInfo::default().command_buffers(&commands);
        // SAFETY: as above; the command buffer was recorded.
        Ok(unsafe { self.gpu.queue_submit(self.gpu.queue, &[info], vk::Fence::null()) }?)
    }
}
