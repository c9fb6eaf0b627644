//! A G-buffer of colour, normal, motion and depth, then lighting over the full screen.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{DEPTH, Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{Draw, FORWARD};
use crate::shader;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

const ALBEDO: vk::Format = vk::Format::R8G8B8A8_SRGB;
const NORMAL: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
const MOTION: vk::Format = vk::Format::R16G16_SFLOAT;

pub const STYLE: Style = Style {
    name: "deferred",
    says: "a G-buffer with depth, lit by a full-screen pass into the swapchain",
    direct: false,
    likeness: Some(1.5),
    can_set_rates: true,
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, ALBEDO, eyes, "G-buffer"),
                PassTruth::new(size, COLOR, eyes, "full-screen lighting"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let albedo = gpu.image(&ImageSpec::new(ALBEDO, app.size))?;
    let normal = gpu.image(&ImageSpec::new(NORMAL, app.size))?;
    let motion = gpu.image(&ImageSpec::new(MOTION, app.size))?;
    let depth = gpu.image(&ImageSpec::new(DEPTH, app.size))?;
    let layers = gpu.pass(
        Kind::RenderPass,
        PassSpec {
            colors: [albedo, normal, motion].map(|image| image.cleared([0.0; 4]).sampled()).to_vec(),
            depth: Some(depth.depth_cleared(1.0).stored().sampled()),
            ..PassSpec::default()
        },
    )?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let boxes = PipelineSpec::new(FORWARD.boxes[0], shader!("deferred", "layers_fs"), Depth::LESS);
    let boxes = gpu.pipeline(&boxes, app.scene.layout, &layers.target)?;
    let lighting =
        PipelineSpec::new(shader!("deferred", "screen_vs"), shader!("deferred", "lighting_fs"), Depth::NONE);
    let lighting = gpu.pipeline(&lighting, app.scene.layout, &eyes[0][0].target)?;
    let set = app.scene.textured(gpu, &[albedo, normal, depth, motion])?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            layers.begin(gpu, frame.commands);
            app.scene.draw_boxes(gpu, frame.commands, boxes, (app.scene.set, frame.slot), eye);
            layers.end(gpu, frame.commands);
            let draw = Draw { view: eye as u32, ..Draw::default() };
            app.show_screen(frame, &eyes[eye][frame.color[eye]], lighting, set, &draw);
        }
        Ok(())
    }))
}
