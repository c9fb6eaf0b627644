//! The scene in high dynamic range off-screen, then tone-mapped into the swapchain.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{Draw, FORWARD};
use crate::shader;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

/// The format of light before it is tone-mapped.
pub const HDR: vk::Format = vk::Format::R16G16B16A16_SFLOAT;

pub const STYLE: Style = Style {
    name: "offscreen-tonemap",
    says: "each eye in a half-float image, then tone-mapped into its swapchain",
    direct: false,
    likeness: None,
    can_set_rates: true,
    passes: |size, _| {
        let eye = |eyes| {
            [PassTruth::new(size, HDR, eyes, "scene"), PassTruth::new(size, COLOR, eyes, "tone mapping")]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let (light, depth) =
        (gpu.image(&ImageSpec::new(HDR, app.size))?, gpu.image(&ImageSpec::depth(app.size))?);
    let scene =
        gpu.pass(Kind::RenderPass, PassSpec::new(light.overwritten().sampled(), depth.depth_cleared(1.0)))?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let pipelines = app.scene.pipelines(gpu, &scene.target, &FORWARD)?;
    let spec = PipelineSpec::new(shader!("post", "screen_vs"), shader!("post", "tonemap_fs"), Depth::NONE);
    let tone_map = gpu.pipeline(&spec, app.scene.layout, &eyes[0][0].target)?;
    let set = app.scene.textured_by_template(gpu, &[light])?;
    Ok(Box::new(move |frame| {
        if let Some(window) = &frame.window {
            app.show(frame, &scene, &pipelines, 0);
            gpu.read_back(frame.commands, &light, window);
            return Ok(());
        }
        for eye in EYES {
            app.show(frame, &scene, &pipelines, eye);
            app.show_screen(frame, &eyes[eye][frame.color[eye]], tone_map, set, &Draw::default());
        }
        Ok(())
    }))
}
