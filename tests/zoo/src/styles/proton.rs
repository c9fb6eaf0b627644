//! As Direct3D games look through Proton: dynamic rendering, pipelines linked from libraries, off-screen, and a copy
//! into the swapchain.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, Making, PassSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::support::{Feature, Needs, OpenXr};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "proton",
    says: "dynamic rendering off-screen, pipelines linked from libraries, copied into the swapchain",
    needs: Needs {
        extensions: &[c"VK_KHR_pipeline_library", c"VK_EXT_graphics_pipeline_library"],
        features: &[Feature::DynamicRendering, Feature::GraphicsPipelineLibrary],
        openxr: OpenXr { copied: true, ..OpenXr::NOTHING },
        ..Needs::DYNAMIC
    },
    direct: false,
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let color = gpu.image(&ImageSpec::new(COLOR, app.size))?;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let spec = PassSpec::new(
        color.overwritten().after(vk::ImageLayout::TRANSFER_SRC_OPTIMAL),
        depth.depth_cleared(1.0),
    );
    let pass = gpu.pass(Kind::Dynamic, spec)?;
    let pipelines = app.scene.pipelines_with(gpu, &pass.target, &FORWARD, |spec| {
        spec.making = Making::Libraries;
    })?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            app.show(frame, &pass, &pipelines, eye);
            let to = &app.color[eye][frame.color[eye]];
            gpu.copy(frame.commands, &color, to);
        }
        Ok(())
    }))
}
