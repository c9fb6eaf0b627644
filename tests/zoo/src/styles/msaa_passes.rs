//! Four samples a pixel through several passes: a depth pre-pass, the boxes, then the sky, each with the stored attachments of the one
//! before; then a command that resolves the image into the swapchain, and depth that is left to be sampled. Both eyes share depth.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{DEPTH, Depth, Image, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{Draw, FORWARD};
use crate::style::Style;
use crate::support::{Needs, OpenXr};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

const SAMPLES: u32 = 4;

/// The same with alpha to coverage: there fragment shaders decide which samples are covered, so that none may return early, and passes have
/// templates on the CPU too.
pub const COVERING: Style = Style {
    name: "msaa-passes-alpha",
    says: "as msaa-passes, with alpha to coverage",
    start: |app| start(app, true),
    ..STYLE
};

pub const STYLE: Style = Style {
    name: "msaa-passes",
    says: "four samples a pixel, a depth pre-pass and two passes that load its depth, resolved by a command",
    needs: Needs { openxr: OpenXr { copied: true, ..OpenXr::NOTHING }, ..Needs::NOTHING },
    direct: false,
    likeness: Some(6.0),
    can_set_rates: true,
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, DEPTH, eyes, "depth pre-pass"),
                PassTruth::new(size, COLOR, eyes, "boxes, where depth is equal"),
                PassTruth::new(size, COLOR, eyes, "sky"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat().into_iter().map(|pass| pass.samples(SAMPLES)).collect()
    },
    start: |app| start(app, false),
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>, alpha_to_coverage: bool) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = ImageSpec::new(DEPTH, app.size).samples(SAMPLES);
    let depth = gpu.image(&depth.usage(depth.usage & !vk::ImageUsageFlags::TRANSFER_SRC))?;
    let cleared = depth.depth_cleared(1.0).stored();
    let before = gpu.pass(Kind::RenderPass, PassSpec::depth(cleared))?;
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC;
    let spec = ImageSpec::new(COLOR, app.size).samples(SAMPLES).usage(usage);
    let eyes = EYES
        .map(|_| {
            let color = gpu.image(&spec)?;
            let drawn = color.cleared([0.0; 4]);
            let boxes = gpu.pass(Kind::RenderPass, PassSpec::new(drawn, cleared.loaded()))?;
            let sky = gpu.pass(Kind::RenderPass, PassSpec::new(drawn.loaded(), cleared.loaded()))?;
            Ok((color, boxes, sky))
        })
        .into_iter()
        .collect::<Result<Vec<_>>>()?;
    let mut first = PipelineSpec::new(FORWARD.boxes[0], FORWARD.boxes[1], Depth::LESS);
    first.fragment = None;
    let first = gpu.pipeline(&first, app.scene.layout, &before.target)?;
    let pipelines = app.scene.pipelines_with(gpu, &eyes[0].1.target, &FORWARD, |spec| {
        spec.alpha_to_coverage = alpha_to_coverage;
        if spec.depth.write {
            spec.depth = Depth { test: Some(vk::CompareOp::EQUAL), write: false };
        }
    })?;
    Ok(Box::new(move |frame| {
        let (commands, slot, set) = (frame.commands, frame.slot, app.scene.set);
        for (eye, (color, boxes, sky)) in EYES.into_iter().zip(&eyes) {
            before.begin(gpu, commands);
            app.scene.draw_boxes(gpu, commands, first, (set, slot), eye);
            before.end(gpu, commands);
            boxes.begin(gpu, commands);
            app.scene.draw_boxes(gpu, commands, pipelines.boxes, (set, slot), eye);
            boxes.end(gpu, commands);
            sky.begin(gpu, commands);
            let draw = Draw { view: eye as u32, far: pipelines.far, ..Draw::default() };
            app.scene.draw_screen(gpu, commands, pipelines.sky, (set, slot), &draw);
            sky.end(gpu, commands);
            let attachment = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
            gpu.transition(commands, &depth, attachment, vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL);
            resolve(app, commands, color, &app.color[eye][frame.color[eye]]);
        }
        Ok(())
    }))
}

/// Resolves a colour target into a picture that becomes one.
fn resolve(app: &App<'_>, commands: vk::CommandBuffer, from: &Image, to: &Image) {
    let gpu = app.gpu;
    let target = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let layouts = [vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL];
    gpu.transition(commands, from, target, layouts[0]);
    gpu.transition(commands, to, vk::ImageLayout::UNDEFINED, layouts[1]);
    let region = vk::ImageResolve::default()
        .src_subresource(from.subresource())
        .dst_subresource(to.subresource())
        .extent(vk::Extent3D { width: to.extent[0], height: to.extent[1], depth: 1 });
    // SAFETY: the command buffer is being recorded, outside of a render pass; the layouts are those.
    unsafe { gpu.cmd_resolve_image(commands, from.handle, layouts[0], to.handle, layouts[1], &[region]) };
    gpu.transition(commands, to, layouts[1], target);
}
