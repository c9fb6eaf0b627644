//! Off-screen and upside-down, by a viewport of negative height; then blitted the right way up.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::support::{Needs, OpenXr};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "flipped",
    says: "off-screen and upside-down, then blitted the right way up into the swapchain",
    needs: Needs { openxr: OpenXr { copied: true, ..OpenXr::NOTHING }, ..Needs::NOTHING },
    direct: false,
    likeness: Some(0.5),
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, upside-down"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let color = gpu.image(&ImageSpec::new(COLOR, app.size))?;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let spec = PassSpec::new(
        color.overwritten().after(vk::ImageLayout::TRANSFER_SRC_OPTIMAL),
        depth.depth_cleared(1.0),
    );
    let pass = gpu.pass(Kind::RenderPass, spec)?;
    let pipelines = app.scene.pipelines(gpu, &pass.target, &FORWARD)?;
    let [width, height] = app.size.map(|length| length as f32);
    let viewport = vk::Viewport { x: 0.0, y: height, width, height: -height, min_depth: 0.0, max_depth: 1.0 };
    Ok(Box::new(move |frame| {
        for eye in EYES {
            pass.begin(gpu, frame.commands);
            // SAFETY: the command buffer is being recorded; Vulkan 1.1 allows negative heights.
            unsafe { gpu.cmd_set_viewport(frame.commands, 0, &[viewport]) };
            app.draw(frame, &pipelines, eye);
            pass.end(gpu, frame.commands);
            gpu.blit_upside_down(frame.commands, &color, &app.color[eye][frame.color[eye]]);
        }
        Ok(())
    }))
}
