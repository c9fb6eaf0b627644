//! Another part of a target of a fixed size in every frame, by its viewport, then scaled up into the swapchain: dynamic resolution as in
//! Unreal Engine and Source 2, where the render area stays the whole target.

use super::dynamic_resolution::part;
use super::upscaled::Scaled;
use crate::app::{App, EYES, Recorder};
use crate::scene::Draw;
use crate::style::Style;
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "viewport-scale",
    says: "each eye in another part of its target in every frame, by viewport, then scaled up into its swapchain",
    direct: false,
    // Its scene has other sizes.
    likeness: None,
    passes: |size, frame| {
        let eye = |eyes| {
            let scene = PassTruth::new(size, COLOR, eyes, "scene, in a part of the target");
            let scene = PassTruth { viewport: part(size, frame), ..scene };
            [scene, PassTruth::new(size, COLOR, eyes, "scaling")]
        };
        [eye(Eyes::Left), eye(Eyes::Right)].concat()
    },
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let Scaled { scene, pipelines, eyes, scale, set } = Scaled::new(app, app.size)?;
    Ok(Box::new(move |frame| {
        let drawn = part(app.size, frame.index);
        // The triangle reads the whole target: as much of it is outside of the eye buffer as was not drawn.
        let [width, height] =
            [0, 1].map(|axis| (app.size[axis] * app.size[axis]) as f32 / drawn[axis] as f32);
        let scaled = vk::Viewport { width, height, max_depth: 1.0, ..Default::default() };
        for eye in EYES {
            scene.begin(gpu, frame.commands);
            gpu.set_viewport(frame.commands, drawn);
            app.draw(frame, &pipelines, eye);
            scene.end(gpu, frame.commands);
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin(gpu, frame.commands);
            // SAFETY: the command buffer is being recorded.
            unsafe { gpu.cmd_set_viewport(frame.commands, 0, &[scaled]) };
            app.scene.draw_screen(gpu, frame.commands, scale, (set, frame.slot), &Draw::default());
            pass.end(gpu, frame.commands);
        }
        Ok(())
    }))
}
