//! An occlusion query on a stand-in, whose result of the frame before decides, by conditional rendering, on half of
//! the boxes.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Depth, ImageSpec, Kind, Made, PassSpec};
use crate::scene::{BOXES, Draw, FORWARD, VERTICES};
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "occlusion",
    says: "half of the boxes by conditional rendering, on the result of an occlusion query",
    needs: Needs {
        extensions: &[c"VK_EXT_conditional_rendering"],
        features: &[Feature::ConditionalRendering],
        ..Needs::NOTHING
    },
    passes: |size, _| PassTruth::each_eye(size, COLOR, "scene, with an occlusion query"),
    start,
    ..Style::PLAIN
};

/// Boxes that are always drawn.
const ALWAYS: u32 = BOXES / 2;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app
        .eye_passes(Kind::RenderPass, |color| PassSpec::new(color.overwritten(), depth.depth_cleared(1.0)))?;
    let pipelines = app.scene.pipelines(gpu, &eyes[0][0].target, &FORWARD)?;
    let invisible = app.scene.pipelines_with(gpu, &eyes[0][0].target, &FORWARD, |spec| {
        spec.color = false;
        spec.depth = Depth { write: false, ..spec.depth };
    })?;
    let usage = vk::BufferUsageFlags::CONDITIONAL_RENDERING_EXT | vk::BufferUsageFlags::TRANSFER_DST;
    let visible = gpu.buffer(8, usage)?;
    visible.write(0, bytemuck::bytes_of(&[1_u32; 2]));
    let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::OCCLUSION).query_count(2);
    // SAFETY: the structure outlives the call.
    let queries = unsafe { gpu.create_query_pool(&info, None) }?;
    gpu.keep(Made::QueryPool(queries));
    let conditional = ash::ext::conditional_rendering::Device::new(&gpu.instance, gpu);
    let graphics = vk::PipelineBindPoint::GRAPHICS;
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe { gpu.cmd_reset_query_pool(commands, queries, 0, 2) };
        for eye in EYES {
            let pass = &eyes[eye][frame.color[eye]];
            pass.begin(gpu, commands);
            app.scene.bind(gpu, commands, app.scene.set, frame.slot);
            let draw = Draw { view: eye as u32, far: pipelines.far, ..Draw::default() };
            app.scene.push(gpu, commands, &draw);
            let condition =
                vk::ConditionalRenderingBeginInfoEXT::default().buffer(visible.handle).offset(4 * eye as u64);
            // SAFETY: the pass was begun, all that the pipelines need is bound; the query was reset, the buffer has a
            // word for each eye.
            unsafe {
                gpu.cmd_bind_pipeline(commands, graphics, pipelines.boxes);
                gpu.cmd_draw(commands, VERTICES, ALWAYS, 0, 0);
                gpu.cmd_bind_pipeline(commands, graphics, invisible.boxes);
                gpu.cmd_begin_query(commands, queries, eye as u32, vk::QueryControlFlags::empty());
                gpu.cmd_draw(commands, VERTICES, BOXES - ALWAYS, 0, ALWAYS);
                gpu.cmd_end_query(commands, queries, eye as u32);
                (conditional.fp().cmd_begin_conditional_rendering_ext)(commands, &condition);
                gpu.cmd_bind_pipeline(commands, graphics, pipelines.boxes);
                gpu.cmd_draw(commands, VERTICES, BOXES - ALWAYS, 0, ALWAYS);
                (conditional.fp().cmd_end_conditional_rendering_ext)(commands);
                gpu.cmd_bind_pipeline(commands, graphics, pipelines.sky);
                gpu.cmd_draw(commands, 3, 1, 0, 0);
            }
            pass.end(gpu, commands);
        }
        let written = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
        gpu.barrier(commands, &[written], &[]);
        // SAFETY: outside of a render pass; both queries were ended.
        unsafe {
            let wait = vk::QueryResultFlags::WAIT;
            gpu.cmd_copy_query_pool_results(commands, queries, 0, 2, visible.handle, 0, 4, wait);
        }
        gpu.barrier(commands, &[written], &[]);
        Ok(())
    }))
}
