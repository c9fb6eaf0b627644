//! New targets, views, render passes and framebuffers for every frame, each time of another size.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, Made, PassSpec};
use crate::scene::{FORWARD, IN_FLIGHT};
use crate::style::Style;
use crate::support::{Needs, OpenXr};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

/// Not among the styles, whose pictures are compared: part of the churn.
pub const STYLE: Style = Style {
    name: "new-targets",
    says: "new targets and render passes for every frame, each time of another size, scaled into the swapchain",
    needs: Needs { openxr: OpenXr { copied: true, ..OpenXr::NOTHING }, ..Needs::NOTHING },
    direct: false,
    likeness: None,
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
        // SAFETY: no other thread uses the queue. Where it fails the device is lost, and with it the objects' use.
        let _ = unsafe { self.app.gpu.device_wait_idle() };
        (0..IN_FLIGHT).for_each(|slot| self.destroy(slot));
    }
}

/// Between 0.6 and 1 of the size in each direction.
fn scaled(size: [u32; 2], frame: u64) -> [u32; 2] {
    let tenths = [10, 8, 6, 7, 9][(frame % 5) as usize];
    size.map(|length| length * tenths / 10)
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let pass = |size: [u32; 2]| {
        let (color, depth) = (gpu.image(&ImageSpec::new(COLOR, size))?, gpu.image(&ImageSpec::depth(size))?);
        let shown = color.overwritten().after(vk::ImageLayout::TRANSFER_SRC_OPTIMAL);
        Ok::<_, anyhow::Error>((
            color,
            gpu.pass(Kind::RenderPass, PassSpec::new(shown, depth.depth_cleared(1.0)))?,
        ))
    };
    let (_, model) = pass(app.size)?;
    let pipelines = app.scene.pipelines(gpu, &model.target, &FORWARD)?;
    let mut fresh = Fresh { app, by_slot: Default::default() };
    Ok(Box::new(move |frame| {
        // The fence of this slot was waited for.
        fresh.destroy(frame.slot);
        let kept = gpu.made();
        for eye in EYES {
            let (color, pass) = pass(scaled(app.size, frame.index))?;
            app.show(frame, &pass, &pipelines, eye);
            gpu.scale(frame.commands, &color, &app.color[eye][frame.color[eye]]);
        }
        fresh.by_slot[frame.slot] = gpu.take_made(kept);
        Ok(())
    }))
}
