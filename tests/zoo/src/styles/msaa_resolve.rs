//! Four samples a pixel, resolved into the swapchain at the end of the pass, and stored in vain.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::{FORWARD, Shaders};
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "msaa-resolve",
    says: "four samples a pixel, resolved into the swapchain at the end of the pass, and stored in vain",
    direct: false,
    likeness: Some(6.0),
    can_set_rates: true,
    passes: four_samples,
    start: |app| start(app, &FORWARD, false),
    ..Style::PLAIN
};

/// A pass with four samples for each eye.
pub fn four_samples(size: [u32; 2], _: u64) -> Vec<PassTruth> {
    let scene = PassTruth::each_eye(size, COLOR, "scene, resolved at its end");
    scene.into_iter().map(|pass| pass.samples(4)).collect()
}

/// The scene with four samples a pixel, which are stored in vain, or with alpha to coverage discarded.
pub fn start<'a>(app: &'a App<'a>, shaders: &Shaders, alpha_to_coverage: bool) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let transient = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSIENT_ATTACHMENT;
    let color = gpu.image(&ImageSpec::new(COLOR, app.size).samples(4).usage(transient))?;
    let depth = gpu.image(&ImageSpec::depth(app.size).samples(4))?;
    // Both are in use: hotham 0.2 stores its transient colour.
    let samples = if alpha_to_coverage { color.overwritten().discarded() } else { color.overwritten() };
    let eyes = app.eye_passes(Kind::RenderPass, |image| {
        PassSpec::new(samples, depth.depth_cleared(1.0)).resolved(image.overwritten())
    })?;
    let cover = |spec: &mut PipelineSpec| {
        // The sky has no holes.
        spec.alpha_to_coverage = alpha_to_coverage && spec.depth.write == Depth::LESS.write;
    };
    let pipelines = app.scene.pipelines_with(gpu, &eyes[0][0].target, shaders, cover)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
