//! Other passes before the scene: a shadow map, a mirror with the shape of the view, the faces of a cube map.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{DEPTH, Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

const SHADOW: [u32; 2] = [96, 96];
const FACE: [u32; 2] = [48, 48];
const FACES: u32 = 6;

pub const STYLE: Style = Style {
    name: "distractors",
    says: "a shadow map, a mirror and a cube map before the scene",
    can_set_rates: true,
    passes: |size, _| {
        let mut passes = vec![
            PassTruth::new(SHADOW, DEPTH, Eyes::None, "shadow map"),
            PassTruth::new(mirror_size(size), COLOR, Eyes::None, "mirror"),
        ];
        passes.extend((0..FACES).map(|_| PassTruth::new(FACE, COLOR, Eyes::None, "face of a cube map")));
        passes.extend(PassTruth::each_eye(size, COLOR, "scene"));
        passes
    },
    start,
    ..Style::PLAIN
};

fn mirror_size(size: [u32; 2]) -> [u32; 2] {
    size.map(|length| length * 3 / 4)
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let shadow = gpu.image(&ImageSpec::new(DEPTH, SHADOW))?;
    let shadow = PassSpec::depth(shadow.depth_cleared(1.0).stored().sampled());
    let shadow = gpu.pass(Kind::RenderPass, shadow)?;
    let mirror_depth = gpu.image(&ImageSpec::depth(mirror_size(app.size)))?;
    let mirror = gpu.image(&ImageSpec::new(COLOR, mirror_size(app.size)))?;
    let mirror = PassSpec::new(mirror.overwritten().sampled(), mirror_depth.depth_cleared(1.0));
    let mirror = gpu.pass(Kind::RenderPass, mirror)?;
    let cube_flags = vk::ImageCreateFlags::CUBE_COMPATIBLE;
    let cube = gpu.image(&ImageSpec { flags: cube_flags, ..ImageSpec::new(COLOR, FACE).layers(FACES) })?;
    let cube_depth = gpu.image(&ImageSpec::depth(FACE))?;
    let mut faces = Vec::new();
    for face in 0..FACES {
        let face = gpu.layer(&cube, face)?;
        let spec = PassSpec::new(face.overwritten().sampled(), cube_depth.depth_cleared(1.0));
        faces.push(gpu.pass(Kind::RenderPass, spec)?);
    }
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let mut caster = PipelineSpec::new(FORWARD.boxes[0], FORWARD.boxes[1], Depth::LESS);
    caster.fragment = None;
    let caster = gpu.pipeline(&caster, app.scene.layout, &shadow.target)?;
    // Mirror, faces and eyes have the same formats: their render passes are compatible.
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    Ok(Box::new(move |frame| {
        shadow.begin(gpu, frame.commands);
        app.scene.draw_boxes(gpu, frame.commands, caster, (app.scene.set, frame.slot), 0);
        shadow.end(gpu, frame.commands);
        app.show(frame, &mirror, &pipelines, 0);
        for face in &faces {
            app.show(frame, face, &pipelines, 0);
        }
        for eye in EYES {
            app.show(frame, &eyes[eye][frame.color[eye]], &pipelines, eye);
        }
        Ok(())
    }))
}
