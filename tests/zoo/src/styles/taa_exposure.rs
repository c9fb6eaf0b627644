//! Temporal anti-aliasing, and exposure by the mean luminance of the picture: both eyes by that of the left one.

use super::offscreen_tonemap::HDR;
use crate::app::{App, Recorder};
use crate::gpu::{Depth, Gpu, Image, ImageSpec, Kind, Pass, PassSpec, PipelineSpec, Shader, Target};
use crate::scene::{Draw, FORWARD, Projection, Uniforms};
use crate::shader;
use crate::style::{History, Style};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

const LUMINANCE: vk::Format = vk::Format::R16_SFLOAT;

/// Width and height of the picture that is averaged.
const MEASURED: u32 = 32;

pub const STYLE: Style = Style {
    name: "taa-exposure",
    says: "temporal anti-aliasing and auto-exposure between the scene and the swapchain",
    direct: false,
    global: Some("auto-exposure"),
    history: History::Blended,
    likeness: None,
    can_set_rates: true,
    passes: |size, _| {
        let mut passes = Vec::new();
        for eyes in [Eyes::Left, Eyes::Right] {
            passes.push(PassTruth::new(size, HDR, eyes, "scene"));
            passes.push(PassTruth::new(size, HDR, eyes, "temporal anti-aliasing"));
            if eyes == Eyes::Left {
                let measured = [MEASURED, MEASURED];
                passes.push(PassTruth::new(measured, LUMINANCE, Eyes::None, "luminance for the exposure"));
            }
            passes.push(PassTruth::new(size, COLOR, eyes, "exposure and tone mapping"));
        }
        passes
    },
    start,
    ..Style::PLAIN
};

/// Images of an eye from frame to frame: two, which are new and old in turn.
struct Eye {
    histories: [Image; 2],
    accumulate: [Pass; 2],
    /// With the scene and the old picture.
    blended: [vk::DescriptorSet; 2],
    /// With the new picture and the luminance.
    exposed: [vk::DescriptorSet; 2],
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let light = gpu.image(&ImageSpec::new(HDR, app.size))?;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let scene = PassSpec::new(light.overwritten().sampled(), depth.depth_cleared(1.0));
    let scene = gpu.pass(Kind::RenderPass, scene)?;
    let levels = MEASURED.ilog2() + 1;
    let usage = vk::ImageUsageFlags::TRANSFER_DST;
    let spec = ImageSpec::new(LUMINANCE, [MEASURED, MEASURED]);
    let luminance = gpu.image(&ImageSpec { levels, usage: spec.usage | usage, ..spec })?;
    let largest = gpu.layer(&luminance, 0)?;
    let measure = gpu.pass(Kind::RenderPass, PassSpec::color(largest.overwritten().sampled()))?;
    let eyes = [eye(app, &light, &luminance)?, eye(app, &light, &luminance)?];
    let shown = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let pipelines = app.scene.pipelines(gpu, &scene.target, &FORWARD)?;
    let screen = |fragment, target: &Target| screen_pipeline(gpu, app.scene.layout, fragment, target);
    let accumulate = screen(shader!("taa", "accumulate_fs"), &eyes[0].accumulate[0].target)?;
    let log_luminance = screen(shader!("taa", "luminance_fs"), &measure.target)?;
    let expose = screen(shader!("taa", "expose_fs"), &shown[0][0].target)?;
    Ok(Box::new(move |frame| {
        let projection = Projection { jitter: jitter(frame.index, app.size), ..Projection::default() };
        app.scene.write(frame.slot, &Uniforms::new(frame.animated, frame.views, projection));
        let new = (frame.index % 2) as usize;
        for (index, eye) in eyes.iter().enumerate() {
            if frame.index == 0 {
                let [_, old] = eye.histories;
                let sampled = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
                gpu.transition(frame.commands, &old, vk::ImageLayout::UNDEFINED, sampled);
            }
            app.show(frame, &scene, &pipelines, index);
            let first = Draw { value: if frame.index == 0 { 1.0 } else { 0.0 }, ..Draw::default() };
            app.show_screen(frame, &eye.accumulate[new], accumulate, eye.blended[new], &first);
            if index == 0 {
                app.show_screen(frame, &measure, log_luminance, eye.exposed[new], &Draw::default());
                gpu.fill_levels(frame.commands, &luminance);
            }
            let to = &shown[index][frame.color[index]];
            app.show_screen(frame, to, expose, eye.exposed[new], &Draw::default());
        }
        Ok(())
    }))
}

fn eye(app: &App, light: &Image, luminance: &Image) -> Result<Eye> {
    let history = || app.gpu.image(&ImageSpec::new(HDR, app.size));
    let histories = [history()?, history()?];
    let pass = |image: Image| app.gpu.pass(Kind::RenderPass, PassSpec::color(image.overwritten().sampled()));
    // While a picture is drawn its binding is the other one's; luminance is not read then.
    let set = |textures: &[Image]| app.scene.textured(app.gpu, textures);
    Ok(Eye {
        histories,
        accumulate: [pass(histories[0])?, pass(histories[1])?],
        blended: [set(&[*light, histories[1]])?, set(&[*light, histories[0]])?],
        exposed: [set(&[histories[0], *light, *luminance])?, set(&[histories[1], *light, *luminance])?],
    })
}

fn screen_pipeline(
    gpu: &Gpu,
    layout: vk::PipelineLayout,
    fragment: Shader,
    target: &Target,
) -> Result<vk::Pipeline> {
    gpu.pipeline(&PipelineSpec::new(shader!("taa", "screen_vs"), fragment, Depth::NONE), layout, target)
}

/// A quarter of a pixel in four directions, in clip space.
pub fn jitter(frame: u64, size: [u32; 2]) -> [f32; 2] {
    let signs = [[1.0, 1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0]][(frame % 4) as usize];
    std::array::from_fn(|axis| signs[axis] * 0.5 / size[axis] as f32)
}
