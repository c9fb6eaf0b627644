//! The scene's image is cleared by a pass of its own, and its highlights are drawn back onto it by a pass without depth, as Bevy's bloom does.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{Draw, FORWARD};
use crate::shader;
use crate::style::Style;
use crate::styles::offscreen_tonemap::HDR;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "bloom",
    says: "each eye in a half-float image that a pass clears, with a half-size copy blended back onto it, then tone-mapped",
    direct: false,
    likeness: None,
    can_set_rates: true,
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, HDR, Eyes::None, "clear"),
                PassTruth::new(size, HDR, eyes, "scene"),
                PassTruth::new(half(size), HDR, eyes, "scaling"),
                PassTruth::new(size, HDR, eyes, "bloom"),
                PassTruth::new(size, COLOR, eyes, "tone mapping"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

fn half(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(2))
}

/// The new colour in addition to the old one.
const ADDED: vk::PipelineColorBlendAttachmentState = vk::PipelineColorBlendAttachmentState {
    blend_enable: vk::TRUE,
    src_color_blend_factor: vk::BlendFactor::ONE,
    dst_color_blend_factor: vk::BlendFactor::ONE,
    color_blend_op: vk::BlendOp::ADD,
    src_alpha_blend_factor: vk::BlendFactor::ZERO,
    dst_alpha_blend_factor: vk::BlendFactor::ONE,
    alpha_blend_op: vk::BlendOp::ADD,
    color_write_mask: vk::ColorComponentFlags::RGBA,
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let light = gpu.image(&ImageSpec::new(HDR, app.size))?;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let small = gpu.image(&ImageSpec::new(HDR, half(app.size)))?;
    let clear = gpu.pass(Kind::RenderPass, PassSpec::color(light.cleared([0.0; 4])))?;
    let drawn = light.cleared([0.0; 4]).loaded().sampled();
    let scene = gpu.pass(Kind::RenderPass, PassSpec::new(drawn, depth.depth_cleared(1.0)))?;
    let shrink = gpu.pass(Kind::RenderPass, PassSpec::color(small.overwritten().sampled()))?;
    let bloom = gpu.pass(Kind::RenderPass, PassSpec::color(light.overwritten().sampled().loaded()))?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let pipelines = app.scene.pipelines(gpu, &scene.target, &FORWARD)?;
    let screen = |fragment| PipelineSpec::new(shader!("post", "screen_vs"), fragment, Depth::NONE);
    let copy = gpu.pipeline(&screen(shader!("post", "scale_fs")), app.scene.layout, &shrink.target)?;
    let add = PipelineSpec { blend: Some(ADDED), ..screen(shader!("post", "scale_fs")) };
    let add = gpu.pipeline(&add, app.scene.layout, &bloom.target)?;
    let tone_map =
        gpu.pipeline(&screen(shader!("post", "tonemap_fs")), app.scene.layout, &eyes[0][0].target)?;
    let of_light = app.scene.textured(gpu, &[light])?;
    let of_small = app.scene.textured(gpu, &[small])?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            clear.begin(gpu, frame.commands);
            clear.end(gpu, frame.commands);
            app.show(frame, &scene, &pipelines, eye);
            app.show_screen(frame, &shrink, copy, of_light, &Draw::default());
            app.show_screen(frame, &bloom, add, of_small, &Draw::default());
            app.show_screen(frame, &eyes[eye][frame.color[eye]], tone_map, of_light, &Draw::default());
        }
        Ok(())
    }))
}
