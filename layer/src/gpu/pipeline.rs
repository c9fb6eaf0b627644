//! Pipelines that draw tiles: an instance each, a strip of four vertices, no vertex input, alpha masked off.

use super::{Gpu, GpuError, Owned, color_pass, descriptor};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// A pipeline with its layout.
pub(crate) struct TilePipeline {
    pipeline: Owned<vk::Pipeline>,
    layout: Owned<vk::PipelineLayout>,
}

impl TilePipeline {
    pub(super) fn handle(&self) -> vk::Pipeline {
        self.pipeline.handle()
    }

    pub(super) fn layout(&self) -> vk::PipelineLayout {
        self.layout.handle()
    }
}

/// Makes a pipeline that draws to attachments of `format` with the entry points `vertex` and `fragment` of a
/// module of SPIR-V.
pub(crate) fn tile_pipeline(
    gpu: &Arc<Gpu>,
    format: vk::Format,
    spirv: &[u8],
    vertex: &CStr,
    fragment: &CStr,
) -> Result<TilePipeline, GpuError> {
    let module = shader_module(gpu, spirv)?;
    let layout = pipeline_layout(gpu)?;
    let pass = color_pass(gpu, format)?;
    let stage = |flag, name| {
        vk::PipelineShaderStageCreateInfo::default().stage(flag).module(module.handle()).name(name)
    };
    let stages =
        [stage(vk::ShaderStageFlags::VERTEX, vertex), stage(vk::ShaderStageFlags::FRAGMENT, fragment)];
    let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_STRIP);
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
    let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
        .polygon_mode(vk::PolygonMode::FILL)
        .cull_mode(vk::CullModeFlags::NONE)
        .line_width(1.0);
    let multisample =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let rgb = vk::ColorComponentFlags::R | vk::ColorComponentFlags::G | vk::ColorComponentFlags::B;
    let blend_attachments = [vk::PipelineColorBlendAttachmentState::default().color_write_mask(rgb)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blend_attachments);
    let dynamic_states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic_states);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&vertex_input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&multisample)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout.handle())
        .render_pass(pass.handle())
        .subpass(0);
    // SAFETY: everything named is live; the build has validated the module and the entry points' interface.
    let pipeline = unsafe {
        let handles = gpu
            .device
            .create_graphics_pipelines(vk::PipelineCache::null(), &[info], None)
            .map_err(|(_, result)| GpuError::Call { call: "vkCreateGraphicsPipelines", result })?;
        Owned::new(gpu, handles[0], |device, handle| device.destroy_pipeline(handle, None))
    };
    Ok(TilePipeline { pipeline, layout })
}

pub(super) fn shader_module(gpu: &Arc<Gpu>, spirv: &[u8]) -> Result<Owned<vk::ShaderModule>, GpuError> {
    let words: Vec<u32> =
        spirv.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]])).collect();
    let info = vk::ShaderModuleCreateInfo::default().code(&words);
    // SAFETY: the device is live, and the build has validated the code.
    unsafe {
        let handle = gpu
            .device
            .create_shader_module(&info, None)
            .map_err(GpuError::from_call("vkCreateShaderModule"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_shader_module(handle, None)))
    }
}

fn pipeline_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::PipelineLayout>, GpuError> {
    let (uniform, texture) = (descriptor::uniform_layout(gpu)?, descriptor::texture_layout(gpu)?);
    let sets = [uniform.handle(), texture.handle()];
    let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
    // SAFETY: the device and both layouts are live.
    unsafe {
        let handle = gpu
            .device
            .create_pipeline_layout(&info, None)
            .map_err(GpuError::from_call("vkCreatePipelineLayout"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_pipeline_layout(handle, None)))
    }
}
