//! Descriptors in a buffer (VK_EXT_descriptor_buffer) instead of sets.

use crate::app::{App, EYES, Recorder};
use crate::gpu::{Buffer, Depth, Gpu, ImageSpec, Kind, Made, PipelineSpec, Shader, Target};
use crate::scene::{BOXES, Draw, FORWARD, IN_FLIGHT, STAGES, STRIDE, Uniforms, VERTICES};
use crate::style::Style;
use crate::support::{Feature, Needs};
use crate::truth::PassTruth;
use crate::xr::COLOR;
use anyhow::Result;
use ash::vk;

pub const STYLE: Style = Style {
    name: "descriptor-buffers",
    says: "descriptors in a buffer, in dynamic rendering, in two passes",
    needs: Needs {
        extensions: &[c"VK_EXT_descriptor_buffer"],
        features: &[Feature::DynamicRendering, Feature::DescriptorBuffer, Feature::BufferDeviceAddress],
        ..Needs::DYNAMIC
    },
    passes: |size, _| PassTruth::halves(size, COLOR),
    start,
    ..Style::PLAIN
};

fn start<'a>(app: &'a App<'a>) -> Result<Recorder<'a>> {
    let gpu = app.gpu;
    let depth = gpu.image(&ImageSpec::depth(app.size))?;
    let eyes = app.halves(Kind::Dynamic, depth.depth_cleared(1.0))?;
    let api = ash::ext::descriptor_buffer::Device::new(&gpu.instance, gpu);
    let (set_layout, layout) = layouts(gpu)?;
    let boxes = pipeline(gpu, FORWARD.boxes, Depth::LESS, layout, &eyes[0][0][0].target)?;
    let sky = pipeline(gpu, FORWARD.sky, Depth::LAST, layout, &eyes[0][0][0].target)?;
    let (descriptors, stride) = descriptors(app, &api, set_layout)?;
    let graphics = vk::PipelineBindPoint::GRAPHICS;
    Ok(Box::new(move |frame| {
        let commands = frame.commands;
        let binding = vk::DescriptorBufferBindingInfoEXT::default()
            .address(gpu.address(&descriptors))
            .usage(vk::BufferUsageFlags::RESOURCE_DESCRIPTOR_BUFFER_EXT);
        // Once for all passes: a layer that binds its own in between must restore these.
        let offset = [stride * frame.slot as u64];
        // SAFETY: the command buffer is being recorded; the buffer holds a set of this layout for each slot.
        unsafe {
            api.cmd_bind_descriptor_buffers(commands, &[binding]);
            api.cmd_set_descriptor_buffer_offsets(commands, graphics, layout, 0, &[0], &offset);
        }
        for eye in EYES {
            let [first, second] = [0, 1].map(|half| &eyes[half][eye][frame.color[eye]]);
            let draw = Draw { view: eye as u32, far: 1.0, ..Draw::default() };
            first.begin(gpu, commands);
            // SAFETY: the pass was begun; offsets were set.
            unsafe {
                gpu.cmd_push_constants(commands, layout, STAGES, 0, bytemuck::bytes_of(&draw));
                gpu.cmd_bind_pipeline(commands, graphics, boxes);
                gpu.cmd_draw(commands, VERTICES, BOXES / 2, 0, 0);
            }
            first.end(gpu, commands);
            second.begin(gpu, commands);
            // SAFETY: as above; constants and pipeline stay bound from one pass to the next.
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

/// The uniforms at binding 0, not dynamic: a descriptor buffer has no dynamic offsets.
fn layouts(gpu: &Gpu) -> Result<(vk::DescriptorSetLayout, vk::PipelineLayout)> {
    let bindings = [vk::DescriptorSetLayoutBinding::default()
        .descriptor_type(vk::DescriptorType::UNIFORM_BUFFER)
        .descriptor_count(1)
        .stage_flags(STAGES)];
    let info = vk::DescriptorSetLayoutCreateInfo::default()
        .flags(vk::DescriptorSetLayoutCreateFlags::DESCRIPTOR_BUFFER_EXT)
        .bindings(&bindings);
    // SAFETY: the structure outlives the call.
    let set_layout = unsafe { gpu.create_descriptor_set_layout(&info, None) }?;
    gpu.keep(Made::SetLayout(set_layout));
    let layout = crate::scene::pipeline_layout(gpu, set_layout)?;
    Ok((set_layout, layout))
}

fn pipeline(
    gpu: &Gpu,
    [vertex, fragment]: [Shader; 2],
    depth: Depth,
    layout: vk::PipelineLayout,
    target: &Target,
) -> Result<vk::Pipeline> {
    let mut spec = PipelineSpec::new(vertex, fragment, depth);
    spec.flags = vk::PipelineCreateFlags::DESCRIPTOR_BUFFER_EXT;
    gpu.pipeline(&spec, layout, target)
}

/// A buffer with the descriptors of each slot, and the bytes from one to the next.
fn descriptors(
    app: &App,
    api: &ash::ext::descriptor_buffer::Device,
    set_layout: vk::DescriptorSetLayout,
) -> Result<(Buffer, u64)> {
    let gpu = app.gpu;
    let mut limits = vk::PhysicalDeviceDescriptorBufferPropertiesEXT::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut limits);
    // SAFETY: the physical device is of this instance, and has the extension; the layout is live.
    let (size, offset) = unsafe {
        gpu.instance.get_physical_device_properties2(gpu.physical, &mut properties);
        (
            api.get_descriptor_set_layout_size(set_layout),
            api.get_descriptor_set_layout_binding_offset(set_layout, 0),
        )
    };
    let stride = size.next_multiple_of(limits.descriptor_buffer_offset_alignment);
    let usage = vk::BufferUsageFlags::RESOURCE_DESCRIPTOR_BUFFER_EXT;
    let buffer = gpu.buffer((stride * IN_FLIGHT as u64) as usize, usage)?;
    let mut bytes = vec![0; limits.uniform_buffer_descriptor_size];
    for slot in 0..IN_FLIGHT {
        let uniforms = vk::DescriptorAddressInfoEXT::default()
            .address(gpu.address(&app.scene.uniforms) + (slot * STRIDE) as u64)
            .range(size_of::<Uniforms>() as u64);
        let data = vk::DescriptorDataEXT { p_uniform_buffer: &raw const uniforms };
        let info = vk::DescriptorGetInfoEXT::default().ty(vk::DescriptorType::UNIFORM_BUFFER).data(data);
        // SAFETY: the address is that of a live buffer; the bytes are as many as such a descriptor has.
        unsafe { api.get_descriptor(&info, &mut bytes) };
        buffer.write(slot * stride as usize + offset as usize, &bytes);
    }
    Ok((buffer, stride))
}
