//! New image views and framebuffers for every frame.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, Made, Pass, PassSpec};
use crate::scene::{FORWARD, IN_FLIGHT};
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "new-views",
    says: "new image views and framebuffers for every frame",
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

/// Objects of a frame, destroyed when the device is done with it.
struct Fresh<'a> {
    app: &'a App<'a>,
    by_slot: [Vec<Made>; IN_FLIGHT],
}

impl Fresh<'_> {
    fn destroy(&mut self, slot: usize) {
        self.by_slot[slot].drain(..).rev().for_each(|made| self.app.gpu.destroy(made));
    }
}

impl Drop for Fresh<'_> {
    fn drop(&mut self) {
        // SAFETY: no other thread uses the queue. Where it fails the device is lost, and with it the views' use.
        let _ = unsafe { self.app.gpu.device_wait_idle() };
        (0..IN_FLIGHT).for_each(|slot| self.destroy(slot));
    }
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let model =
        gpu.pass(Kind::RenderPass, PassSpec::new(app.color[0][0].overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(gpu, &model.target, &FORWARD)?;
    let mut fresh = Fresh { app, by_slot: Default::default() };
    Ok(Box::new(move |frame| {
        // The fence of this slot was waited for.
        fresh.destroy(frame.slot);
        for eye in EYES {
            let color = gpu.viewed(&app.color[eye][frame.color[eye]])?;
            fresh.by_slot[frame.slot].push(Made::View(color.view));
            let depth = gpu.viewed(&depth)?;
            fresh.by_slot[frame.slot].push(Made::View(depth.view));
            let views = [color.view, depth.view];
            let framebuffer = gpu.framebuffer(model.target.render_pass, &views, app.size)?;
            fresh.by_slot[frame.slot].push(Made::Framebuffer(framebuffer));
            let spec = PassSpec::new(color.overwritten(), depth.depth_cleared(1.0));
            let pass = Pass::with_framebuffer(spec, &model.target, framebuffer);
            app.show(frame, &pass, &pipelines, eye);
        }
        Ok(())
    }))
}
