//! Both eyes by one draw: each instance goes to one of two viewports beside each other.

use crate::app::{App, EYES, Recorder, wide};
use crate::gpu::{ImageSpec, Kind, PassSpec, passes};
use crate::scene::{BOXES, Draw, FORWARD, Shaders, VERTICES};
use crate::shader;
use crate::style::{Arrangement, Style};
use crate::support::{Feature, Needs};
use crate::truth::{Eyes, PassTruth};
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "stereo-viewports",
    says: "instanced stereo: each draw goes to two viewports beside each other",
    needs: Needs {
        extensions: &[c"VK_EXT_shader_viewport_index_layer"],
        features: &[Feature::MultiViewport],
        ..Needs::NOTHING
    },
    arrangement: Arrangement::DoubleWide,
    likeness: Some(0.01),
    passes: |size, _| vec![PassTruth::new(wide(size), COLOR, Eyes::Both, "scene")],
    start,
    ..Style::PLAIN
};

const STEREO: Shaders = Shaders {
    boxes: [shader!("stereo", "boxes_vs"), FORWARD.boxes[1]],
    sky: [shader!("stereo", "sky_vs"), FORWARD.sky[1]],
    ..FORWARD
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(wide(app.size)))?;
    let passes = passes(gpu, Kind::RenderPass, &app.color[0], |color| {
        PassSpec::new(color.overwritten(), depth.depth_cleared(1.0))
    })?;
    let pipelines = app.scene.pipelines_with(gpu, &passes[0].target, &STEREO, |spec| spec.viewports = 2)?;
    let [width, height] = app.size;
    let viewports = EYES.map(|eye| {
        let viewport = vk::Viewport { width: width as f32, height: height as f32, ..Default::default() };
        vk::Viewport { x: eye as f32 * width as f32, max_depth: 1.0, ..viewport }
    });
    let scissors = EYES.map(|eye| vk::Rect2D {
        offset: vk::Offset2D { x: eye as i32 * width as i32, y: 0 },
        extent: vk::Extent2D { width, height },
    });
    let graphics = vk::PipelineBindPoint::GRAPHICS;
    Ok(Box::new(move |frame| {
        let (commands, pass) = (frame.commands, &passes[frame.color[0]]);
        pass.begin(gpu, commands);
        app.scene.bind(gpu, commands, app.scene.set, frame.slot);
        app.scene.push(gpu, commands, &Draw { far: pipelines.far, ..Draw::default() });
        // SAFETY: the pass was begun, and all that the pipelines need is bound.
        unsafe {
            gpu.cmd_set_viewport(commands, 0, &viewports);
            gpu.cmd_set_scissor(commands, 0, &scissors);
            gpu.cmd_bind_pipeline(commands, graphics, pipelines.boxes);
            gpu.cmd_draw(commands, VERTICES, 2 * BOXES, 0, 0);
            gpu.cmd_bind_pipeline(commands, graphics, pipelines.sky);
            gpu.cmd_draw(commands, 3, 2, 0, 0);
        }
        pass.end(gpu, commands);
        Ok(())
    }))
}
