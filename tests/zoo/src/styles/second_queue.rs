//! The scene on another queue than the session's, which waits for it: of the same family, or of another one, whose images it takes over.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::{FORWARD, IN_FLIGHT};
use crate::style::Style;
use crate::support::{Needs, Queues};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "second-queue",
    says: "the scene on another queue than the one that the session is bound to",
    needs: Needs { queues: Queues::Two, ..Needs::NOTHING },
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, on the second queue"),
    start,
    ..Style::PLAIN
};

pub const OF_ANOTHER_FAMILY: Style = Style {
    name: "second-family",
    says: "the scene on a queue of another family than that of the session",
    needs: Needs { queues: Queues::TwoFamilies, ..Needs::NOTHING },
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, on a queue of the second family"),
    ..STYLE
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    // The passes overwrite the images, so that nothing has to be given to the second family.
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let buffers =
        gpu.command_buffers_of(gpu.families[1], IN_FLIGHT as u32, vk::CommandBufferLevel::PRIMARY)?;
    let done = (0..IN_FLIGHT).map(|_| gpu.semaphore()).collect::<Result<Vec<_>>>()?;
    Ok(Box::new(move |frame| {
        let commands = buffers[frame.slot];
        gpu.record(commands, vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT, |commands| {
            for eye in EYES {
                let pass = &eyes[eye][frame.color[eye]];
                pass.begin(gpu, commands);
                app.scene.draw(gpu, commands, &pipelines, frame.slot, eye as u32);
                pass.end(gpu, commands);
                gpu.give_back(commands, &app.color[eye][frame.color[eye]]);
            }
            Ok(())
        })?;
        for eye in EYES {
            gpu.give_back(frame.commands, &app.color[eye][frame.color[eye]]);
        }
        gpu.submit_aside(commands, done[frame.slot])?;
        frame.waits.borrow_mut().push(done[frame.slot]);
        Ok(())
    }))
}
