//! Descriptors in a heap (VK_EXT_descriptor_heap) and push data instead of sets and push constants, as DXVK has them.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{
    Depth, Gpu, HeapBinding, ImageSpec, Kind, Making, PipelineSpec, Shader, Target, UniformHeap,
};
use crate::scene::{BOXES, Draw, FORWARD, IN_FLIGHT, STRIDE, Uniforms, VERTICES};
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "descriptor-heaps",
    says: "descriptors in a heap and push data, in dynamic rendering, in two passes",
    needs: Needs {
        extensions: &[c"VK_EXT_descriptor_heap", c"VK_KHR_maintenance5"],
        features: &[
            Feature::DynamicRendering,
            Feature::DescriptorHeap,
            Feature::Maintenance5,
            Feature::BufferDeviceAddress,
        ],
        ..Needs::DYNAMIC
    },
    passes: |size, _| PassTruth::halves(size, COLOR),
    // Another lavapipe than that of the other styles rounds a value in 40,000 otherwise.
    likeness: Some(0.001),
    start,
    ..Style::PLAIN
};

/// Offset of the number of the uniforms in push data.
const NUMBER: u32 = size_of::<Draw>() as u32;

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app.halves(Kind::Dynamic, depth.depth_cleared(1.0))?;
    let heap = UniformHeap::new(gpu, &app.scene.uniforms, (IN_FLIGHT, STRIDE, size_of::<Uniforms>()))?;
    let binding = HeapBinding { push_offset: NUMBER, stride: heap.stride };
    let boxes = pipeline(gpu, FORWARD.boxes, Depth::LESS, binding, &eyes[0][0][0].target)?;
    let sky = pipeline(gpu, FORWARD.sky, Depth::LAST, binding, &eyes[0][0][0].target)?;
    let graphics = vk::PipelineBindPoint::GRAPHICS;
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        // Once for all passes: a layer that binds its own in between must restore these.
        // SAFETY: the command buffer is being recorded.
        unsafe {
            heap.bind(commands);
            heap.push(commands, NUMBER, &(frame.slot as u32).to_ne_bytes());
        }
        for eye in EYES {
            let [first, second] = [0, 1].map(|half| &eyes[half][eye][frame.color[eye]]);
            let draw = Draw { view: eye as u32, far: 1.0, ..Draw::default() };
            first.begin(gpu, commands);
            // SAFETY: the pass was begun; the heap is bound.
            unsafe {
                heap.push(commands, 0, bytemuck::bytes_of(&draw));
                gpu.cmd_bind_pipeline(commands, graphics, boxes);
                gpu.cmd_draw(commands, VERTICES, BOXES / 2, 0, 0);
            }
            first.end(gpu, commands);
            second.begin(gpu, commands);
            // SAFETY: as above; data and pipeline stay bound from one pass to the next.
            unsafe {
                gpu.cmd_draw(commands, VERTICES, BOXES / 2, 0, BOXES / 2);
                gpu.cmd_bind_pipeline(commands, graphics, sky);
                gpu.cmd_draw(commands, 3, 1, 0, 0);
            }
            second.end(gpu, commands);
        }
        Ok(())
    }))
}

fn pipeline(
    gpu: &Gpu,
    [vertex, fragment]: [Shader; 2],
    depth: Depth,
    binding: HeapBinding,
    target: &Target,
) -> Result<vk::Pipeline> {
    let mut spec = PipelineSpec::new(vertex, fragment, depth);
    spec.making = Making::Heap(binding);
    gpu.pipeline(&spec, vk::PipelineLayout::null(), target)
}
