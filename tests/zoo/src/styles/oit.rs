//! Order-independent transparency: fragments of glass add to a storage buffer, which is laid over the scene.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{DEPTH, Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{BOXES, Draw, FORWARD, VERTICES};
use crate::shader;
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "oit",
    says: "glass summed up in a storage buffer by atomics, then laid over the scene",
    needs: Needs { features: &[Feature::FragmentStoresAndAtomics], ..Needs::NOTHING },
    direct: false,
    likeness: None,
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, COLOR, eyes, "scene"),
                PassTruth::new(size, DEPTH, eyes, "glass, into a storage buffer"),
                PassTruth::new(size, COLOR, eyes, "glass over the scene"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

/// Panes of glass, numbered on from the boxes.
const PANES: u32 = 24;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let (gpu, layout) = (app.gpu, app.scene.layout);
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let stored = depth.depth_cleared(1.0).stored();
    let opaque = app.eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), stored))?;
    let glass = gpu.pass(Kind::RenderPass, PassSpec::depth(stored.loaded().discarded()))?;
    let over = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten().loaded()))?;
    let pipelines = app.scene.pipelines(gpu, &opaque[0][0].target, &FORWARD)?;
    let tested = Depth { write: false, ..Depth::LESS };
    let panes = PipelineSpec::new(shader!("oit", "glass_vs"), shader!("oit", "glass_fs"), tested);
    let panes = gpu.pipeline(&panes, layout, &glass.target)?;
    let mut composite =
        PipelineSpec::new(shader!("oit", "screen_vs"), shader!("oit", "composite_fs"), Depth::NONE);
    composite.blend = Some(
        vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(true)
            .src_color_blend_factor(vk::BlendFactor::SRC_ALPHA)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .src_alpha_blend_factor(vk::BlendFactor::ZERO)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE),
    );
    let composite = gpu.pipeline(&composite, layout, &over[0][0].target)?;
    let [width, height] = app.size;
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
    let sums = gpu.buffer((width * height * 16) as usize, usage)?;
    let set = app.scene.textured(gpu, &[])?;
    app.scene.with_storage(gpu, set, sums.handle);
    let order = vk::MemoryBarrier::default()
        .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
        .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        for eye in EYES {
            app.show(frame, &opaque[eye][frame.color[eye]], &pipelines, eye);
            gpu.barrier(commands, &[order], &[]);
            // SAFETY: the command buffer is being recorded, outside of a render pass.
            unsafe { gpu.cmd_fill_buffer(commands, sums.handle, 0, vk::WHOLE_SIZE, 0) };
            gpu.barrier(commands, &[order], &[]);
            let draw = Draw { view: eye as u32, count: width, ..Draw::default() };
            glass.begin(gpu, commands);
            app.scene.bind(gpu, commands, set, frame.slot);
            app.scene.push(gpu, commands, &draw);
            // SAFETY: the pass was begun, and all that the pipeline needs is bound.
            unsafe {
                gpu.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, panes);
                gpu.cmd_draw(commands, VERTICES, PANES, 0, BOXES);
            }
            glass.end(gpu, commands);
            gpu.barrier(commands, &[order], &[]);
            app.show_screen(frame, &over[eye][frame.color[eye]], composite, set, &draw);
        }
        Ok(())
    }))
}
