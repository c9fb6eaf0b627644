//! Another part of the swapchain's image in every frame, as dynamic resolution does it.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{ImageSpec, Kind, PassSpec};
use crate::scene::FORWARD;
use crate::style::Style;
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;

pub const STYLE: Style = Style {
    name: "dynamic-resolution",
    says: "renders and submits another part of the swapchain's image in every frame",
    // Its pictures have other sizes.
    likeness: None,
    can_set_rates: true,
    passes: |size, frame| {
        let scene = PassTruth::each_eye(size, COLOR, "scene, in a part of the image");
        let part = part(size, frame);
        scene.into_iter().map(|pass| PassTruth { area: part, viewport: part, ..pass }).collect()
    },
    start,
    ..Style::PLAIN
};

/// Between 0.6 and 1 of the size in each direction.
pub fn part(size: [u32; 2], frame: u64) -> [u32; 2] {
    let tenths = [10, 9, 8, 7, 6, 7, 8, 9][(frame % 8) as usize];
    size.map(|length| length * tenths / 10)
}

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let depth = app.gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(app.gpu, &eyes[0][0].target, &FORWARD)?;
    Ok(Box::new(move |frame| {
        let area = part(app.size, frame.index);
        for eye in EYES {
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin_area(app.gpu, frame.commands, area);
            app.draw(frame, &pipelines, eye);
            pass.end(app.gpu, frame.commands);
        }
        frame.shown.set(area);
        Ok(())
    }))
}
