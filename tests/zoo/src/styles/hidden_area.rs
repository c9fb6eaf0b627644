//! The area that a lens hides is covered first, at the near plane, by the runtime's mesh (XR_KHR_visibility_mask).

use crate::app::{App, EYES, Frame, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, PassSpec, PipelineSpec};
use crate::scene::FORWARD;
use crate::shader;
use crate::style::Style;
use crate::support::{Needs, OpenXr};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "hidden-area",
    says: "the area hidden by the lenses is covered first, by XR_KHR_visibility_mask",
    needs: Needs { openxr: OpenXr { hidden_area: true, ..OpenXr::NOTHING }, ..Needs::NOTHING },
    // The corners are black.
    likeness: Some(30.0),
    can_set_rates: true,
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, behind the hidden area"),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app.eye_passes(Kind::RenderPass, |color| {
        PassSpec::new(color.cleared([0.0, 0.0, 0.0, 1.0]), depth.depth_cleared(1.0))
    })?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let always = Depth { test: Some(vk::CompareOp::ALWAYS), write: true };
    let mut cover = PipelineSpec::new(shader!("fragments", "near_vs"), FORWARD.sky[1], always);
    (cover.fragment, cover.vertices, cover.color) = (None, true, false);
    let cover = gpu.pipeline(&cover, app.scene.layout, &eyes[0][0].target)?;
    let vertices = EYES.map(|eye| app.hidden[eye].len().max(1) * size_of::<[f32; 2]>());
    let buffer = gpu.buffer(vertices[0] + vertices[1], vk::BufferUsageFlags::VERTEX_BUFFER)?;
    Ok(Box::new(move |frame| {
        for eye in EYES {
            if frame.index == 0 {
                buffer.write(eye * vertices[0], bytemuck::cast_slice(&in_clip_space(app, frame, eye)));
            }
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin(gpu, frame.commands);
            // SAFETY: the pass was begun; the pipeline needs the buffer alone, which holds so many vertices.
            unsafe {
                gpu.cmd_bind_pipeline(frame.commands, vk::PipelineBindPoint::GRAPHICS, cover);
                let offset = (eye * vertices[0]) as u64;
                gpu.cmd_bind_vertex_buffers(frame.commands, 0, &[buffer.handle], &[offset]);
                gpu.cmd_draw(frame.commands, app.hidden[eye].len() as u32, 1, 0, 0);
            }
            app.draw(frame, &pipelines, eye);
            pass.end(gpu, frame.commands);
        }
        Ok(())
    }))
}

/// The hidden triangles, from the plane one metre ahead.
fn in_clip_space(app: &App, frame: &Frame, eye: usize) -> Vec<[f32; 2]> {
    let fov = frame.views[eye].fov;
    let [left, right, up, down] =
        [fov.angle_left, fov.angle_right, fov.angle_up, fov.angle_down].map(f32::tan);
    let clip =
        |[x, y]: &[f32; 2]| [2.0 * (x - left) / (right - left) - 1.0, 2.0 * (up - y) / (up - down) - 1.0];
    app.hidden[eye].iter().map(clip).collect()
}
