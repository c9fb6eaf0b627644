//! A visibility buffer: indices of the visible faces, then a pass that shades each pixel once.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::Draw;
use crate::shader;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

const FACES: vk::Format = vk::Format::R32_UINT;

pub const STYLE: Style = Style {
    name: "visibility",
    says: "an integer visibility buffer, shaded by a full-screen pass into the swapchain",
    direct: false,
    likeness: Some(1.5),
    passes: |size, _| {
        let eye = |eyes| {
            [
                PassTruth::new(size, FACES, eyes, "visibility buffer"),
                PassTruth::new(size, COLOR, eyes, "full-screen shading"),
            ]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let (gpu, layout) = (app.gpu, app.scene.layout);
    let faces = gpu.image(&ImageSpec::new(FACES, app.size))?;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    // 0.0 has the bits of the integer 0.
    let target = PassSpec::new(faces.cleared([0.0; 4]).sampled(), depth.depth_cleared(1.0));
    let target = gpu.pass(Kind::RenderPass, target)?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| PassSpec::color(color.overwritten()))?;
    let boxes =
        PipelineSpec::new(shader!("visibility", "faces_vs"), shader!("visibility", "faces_fs"), Depth::LESS);
    let boxes = gpu.pipeline(&boxes, layout, &target.target)?;
    let shading = PipelineSpec::new(
        shader!("visibility", "screen_vs"),
        shader!("visibility", "resolve_fs"),
        Depth::NONE,
    );
    let shading = gpu.pipeline(&shading, layout, &eyes[0][0].target)?;
    let set = app.scene.textured(gpu, &[faces])?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            target.begin(gpu, frame.commands);
            app.scene.draw_boxes(gpu, frame.commands, boxes, (app.scene.set, frame.slot), eye);
            target.end(gpu, frame.commands);
            let draw = Draw { view: eye as u32, ..Draw::default() };
            app.show_screen(frame, &eyes[eye][frame.color[eye]], shading, set, &draw);
        }
        Ok(())
    }))
}
