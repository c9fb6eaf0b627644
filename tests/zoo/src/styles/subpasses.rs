//! As renderers for tiled GPUs do: scene and tone mapping in two subpasses of one framebuffer, both eyes at once.

use super::offscreen_tonemap::HDR;
use crate::app::{App, Recorder};
use crate::gpu::{Depth, ImageSpec, PipelineSpec, SubpassesSpec};
use crate::scene::{FAN, MULTIVIEW};
use crate::shader;
use crate::style::{Arrangement, Style};
use crate::support::{Feature, Needs};
use crate::truth::{Eyes, PassTruth};
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "subpasses",
    says: "scene and tone mapping as two subpasses of one multiview pass, by an input attachment",
    needs: Needs { vulkan: vk::API_VERSION_1_2, features: &[Feature::Multiview], ..Needs::NOTHING },
    arrangement: Arrangement::Array,
    direct: false,
    likeness: None,
    passes: |size, _| {
        vec![PassTruth::new(size, HDR, Eyes::Both, "scene, then tone mapping in a second subpass").layers(2)]
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT
        | vk::ImageUsageFlags::INPUT_ATTACHMENT
        | vk::ImageUsageFlags::TRANSIENT_ATTACHMENT;
    let light = gpu.image(&ImageSpec::new(HDR, app.size).layers(2).usage(usage))?;
    let depth = gpu.image(&ImageSpec::depth(app.size).layers(2))?;
    let spec = |color: &crate::gpu::Image| SubpassesSpec {
        light: light.overwritten().discarded().sampled(),
        depth: depth.depth_cleared(1.0),
        color: color.overwritten(),
        view_mask: 0b11,
    };
    let specs: Vec<_> = app.color[0].iter().map(spec).collect();
    let passes = gpu.subpasses(&specs)?;
    let pipelines = app.scene.pipelines(gpu, &passes[0].targets[0], &MULTIVIEW)?;
    let tone_map =
        PipelineSpec::new(shader!("multiview", "screen_vs"), shader!("input", "tonemap_fs"), Depth::NONE);
    let tone_map = gpu.pipeline(&tone_map, app.scene.layout, &passes[0].targets[1])?;
    let set = app.scene.textured(gpu, &[])?;
    app.scene.with_input(gpu, set, &light);
    Ok(Box::new(move |frame| {
        let pass = &passes[frame.color[0]];
        pass.begin(gpu, frame.commands);
        app.draw(frame, &pipelines, 0);
        pass.next(gpu, frame.commands);
        app.scene.bind(gpu, frame.commands, set, frame.slot);
        // SAFETY: the second subpass was begun, and all that the pipeline needs is bound.
        unsafe {
            gpu.cmd_bind_pipeline(frame.commands, vk::PipelineBindPoint::GRAPHICS, tone_map);
            gpu.cmd_draw(frame.commands, FAN, 1, 0, 0);
        }
        pass.end(gpu, frame.commands);
        Ok(())
    }))
}
