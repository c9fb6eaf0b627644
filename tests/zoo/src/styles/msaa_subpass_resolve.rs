//! Four samples a pixel, resolved by a shader in a second subpass.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, Image, ImageSpec, PipelineSpec, Subpasses, SubpassesSpec};
use crate::scene::{Draw, FORWARD};
use crate::shader;
use crate::style::Style;
use crate::support::Needs;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "msaa-subpass-resolve",
    says: "four samples a pixel, resolved into the swapchain by a shader in a second subpass",
    needs: Needs { vulkan: vk::API_VERSION_1_2, ..Needs::NOTHING },
    direct: false,
    likeness: Some(6.0),
    passes: |size, _| {
        let scene = PassTruth::each_eye(size, COLOR, "scene, resolved in a second subpass");
        scene.into_iter().map(|pass| pass.samples(4)).collect()
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT
        | vk::ImageUsageFlags::INPUT_ATTACHMENT
        | vk::ImageUsageFlags::TRANSIENT_ATTACHMENT;
    let light = gpu.image(&ImageSpec::new(COLOR, app.size).samples(4).usage(usage))?;
    let depth = gpu.image(&ImageSpec::depth(app.size).samples(4))?;
    let spec = |color: &Image| SubpassesSpec {
        light: light.overwritten().discarded().sampled(),
        depth: depth.depth_cleared(1.0),
        color: color.overwritten(),
        view_mask: 0,
    };
    let passes = |images: &Vec<Image>| gpu.subpasses(&images.iter().map(spec).collect::<Vec<_>>());
    let eyes: Vec<Vec<Subpasses>> = app.color.iter().map(passes).collect::<Result<_>>()?;
    // The render passes of both eyes are compatible.
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].targets[0], &FORWARD)?;
    let resolve =
        PipelineSpec::new(shader!("post", "bare_vs"), shader!("input_samples", "resolve_fs"), Depth::NONE);
    let resolve = gpu.pipeline(&resolve, app.scene.layout, &eyes[0][0].targets[1])?;
    let set = app.scene.textured(gpu, &[])?;
    app.scene.with_input(gpu, set, &light);
    Ok(Box::new(move |frame| {
        for eye in EYES {
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin(gpu, frame.commands);
            app.draw(frame, &pipelines, eye);
            pass.next(gpu, frame.commands);
            app.scene.draw_screen(gpu, frame.commands, resolve, (set, frame.slot), &Draw::default());
            pass.end(gpu, frame.commands);
        }
        Ok(())
    }))
}
