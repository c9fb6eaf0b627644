//! Scaled up by compute into an image that no pass draws to, as temporal upscalers do, and tone-mapped from there into the swapchain.

use super::upscaled::small;
use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{Draw, FORWARD};
use crate::shader;
use crate::style::{History, Style};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

/// Of the compute shader.
const WORKGROUP: u32 = 8;

pub const STYLE: Style = Style {
    name: "compute-upscaled",
    says: "each eye at 0.67 of its size, scaled up by compute, then tone-mapped into its swapchain",
    direct: false,
    likeness: None,
    can_set_rates: true,
    history: History::Unknown,
    passes: |size, _| {
        let scene = |eyes| PassTruth::new(small(size), HDR, eyes, "scene");
        [Eyes::Left, Eyes::Right]
            .into_iter()
            .flat_map(|eyes| [scene(eyes), PassTruth::new(size, COLOR, eyes, "tone mapping")])
            .collect()
    },
    start,
    ..Style::PLAIN
};

/// Of the scene, and of the image that compute writes.
const HDR: vk::Format = vk::Format::R16G16B16A16_SFLOAT;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let (gpu, shared) = (app.gpu, &app.scene);
    let color = gpu.image(&ImageSpec::new(HDR, small(app.size)))?;
    let depth = gpu.image(&ImageSpec::depth(small(app.size)))?;
    let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
    let upscaled = gpu.image(&ImageSpec::new(HDR, app.size).usage(usage))?;
    let scene = PassSpec::new(color.overwritten().sampled(), depth.depth_cleared(1.0));
    let scene = gpu.pass(Kind::RenderPass, scene)?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let pipelines = shared.pipelines(gpu, &scene.target, &FORWARD)?;
    let upscale = gpu.compute_pipeline(shader!("upscale", "main"), shared.layout)?;
    let tonemap = PipelineSpec::new(shader!("post", "screen_vs"), shader!("post", "tonemap_fs"), Depth::NONE);
    let tonemap = gpu.pipeline(&tonemap, shared.layout, &eyes[0][0].target)?;
    let drawn = shared.textured(gpu, &[color])?;
    shared.with_storage_image(gpu, drawn, &upscaled);
    let scaled = shared.textured(gpu, &[upscaled])?;
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        let point = vk::PipelineBindPoint::COMPUTE;
        let [width, height] = app.size.map(|side| side.div_ceil(WORKGROUP));
        for eye in EYES {
            app.show(frame, &scene, &pipelines, eye);
            // Passes wait for reads by fragments alone.
            let read = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
            gpu.transition(commands, &color, read, read);
            gpu.transition(commands, &upscaled, vk::ImageLayout::UNDEFINED, vk::ImageLayout::GENERAL);
            // SAFETY: the command buffer is being recorded; all bound objects are live.
            unsafe {
                gpu.cmd_bind_pipeline(commands, point, upscale);
                gpu.cmd_bind_descriptor_sets(commands, point, shared.layout, 0, &[drawn], &[0]);
                gpu.cmd_dispatch(commands, width, height, 1);
            }
            gpu.transition(commands, &upscaled, vk::ImageLayout::GENERAL, read);
            app.show_screen(frame, &eyes[eye][frame.color[eye]], tonemap, scaled, &Draw::default());
        }
        Ok(())
    }))
}
