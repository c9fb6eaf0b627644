//! Pipelines that draw tiles: an instance each, a strip of four vertices, no vertex input.

use super::pipeline_layout::PipelineLayout;
use super::{Gpu, GpuError, Owned, descriptor};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// A pipeline with its layout.
pub(crate) struct TilePipeline {
    pipeline: Owned<vk::Pipeline>,
    layout: PipelineLayout,
}

impl TilePipeline {
    pub(super) fn handle(&self) -> vk::Pipeline {
        self.pipeline.handle()
    }

    pub(super) fn layout(&self) -> vk::PipelineLayout {
        self.layout.handle()
    }
}

/// The use that a pipeline makes of the target's content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Output {
    /// Replaces colour, and leaves alpha.
    Color,
    /// Replaces colour and alpha.
    ColorAndAlpha,
    /// Adds colour to the content, of which a share of 1 - alpha stays; leaves alpha.
    Blended,
}

/// Properties of a pipeline that draws tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileShader {
    /// Entry point for vertices.
    pub(crate) vertex: &'static CStr,
    /// Entry point for fragments.
    pub(crate) fragment: &'static CStr,
    /// Whether set 0 is a [`super::ListSet`], else a [`super::UniformSet`].
    pub(crate) has_lists: bool,
    /// Whether sets 2 and 3 are of [`super::TextureSets`] too, else there are none.
    pub(crate) has_depth: bool,
    /// The use of the target's content.
    pub(crate) output: Output,
}

/// Makes a pipeline for `pass`.
pub(super) fn make_tile_pipeline(
    gpu: &Arc<Gpu>,
    pass: &Owned<vk::RenderPass>,
    spirv: &[u8],
    shader: &TileShader,
) -> Result<TilePipeline, GpuError> {
    let module = shader_module(gpu, spirv)?;
    let layout = pipeline_layout(gpu, shader)?;
    let stage = |flag, name| {
        vk::PipelineShaderStageCreateInfo::default().stage(flag).module(module.handle()).name(name)
    };
    let stages = [
        stage(vk::ShaderStageFlags::VERTEX, shader.vertex),
        stage(vk::ShaderStageFlags::FRAGMENT, shader.fragment),
    ];
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
    let blend_attachments = [blend(shader.output)];
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
    let pipeline = unsafe { graphics_pipeline(gpu, &info) }?;
    Ok(TilePipeline { pipeline, layout })
}

/// Makes a graphics pipeline with the device's cache.
///
/// # Safety
/// `info` is valid, by the valid usage of vkCreateGraphicsPipelines.
pub(super) unsafe fn graphics_pipeline(
    gpu: &Arc<Gpu>,
    info: &vk::GraphicsPipelineCreateInfo<'_>,
) -> Result<Owned<vk::Pipeline>, GpuError> {
    let cache = gpu.pipeline_cache()?;
    // SAFETY: the structure is valid, by the valid usage of vkCreateGraphicsPipelines; the device is live, and so is the cache until its compiler ends.
    unsafe {
        let handles = gpu
            .device
            .create_graphics_pipelines(cache, std::slice::from_ref(info), None)
            .map_err(|(_, result)| GpuError::Call { call: "vkCreateGraphicsPipelines", result })?;
        Ok(Owned::new(gpu, handles[0], |device, handle| device.destroy_pipeline(handle, None)))
    }
}

fn blend(output: Output) -> vk::PipelineColorBlendAttachmentState {
    let rgb = vk::ColorComponentFlags::R | vk::ColorComponentFlags::G | vk::ColorComponentFlags::B;
    let mask = if output == Output::ColorAndAlpha { vk::ColorComponentFlags::RGBA } else { rgb };
    vk::PipelineColorBlendAttachmentState::default()
        .color_write_mask(mask)
        .blend_enable(output == Output::Blended)
        .src_color_blend_factor(vk::BlendFactor::ONE)
        .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
        .src_alpha_blend_factor(vk::BlendFactor::ONE)
        .dst_alpha_blend_factor(vk::BlendFactor::ZERO)
}

pub(super) fn shader_module(gpu: &Arc<Gpu>, spirv: &[u8]) -> Result<Owned<vk::ShaderModule>, GpuError> {
    let words: Vec<u32> =
        spirv.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]])).collect();
    // SAFETY: the build has validated the code.
    unsafe { module_of_words(gpu, &words) }
}

/// # Safety
/// The words are valid SPIR-V for the device.
pub(super) unsafe fn module_of_words(
    gpu: &Arc<Gpu>,
    words: &[u32],
) -> Result<Owned<vk::ShaderModule>, GpuError> {
    let info = vk::ShaderModuleCreateInfo::default().code(words);
    // SAFETY: the device is live, and the code valid for it, as `# Safety` demands.
    unsafe {
        let handle = gpu
            .device
            .create_shader_module(&info, None)
            .map_err(GpuError::from_call("vkCreateShaderModule"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_shader_module(handle, None)))
    }
}

fn pipeline_layout(gpu: &Arc<Gpu>, shader: &TileShader) -> Result<PipelineLayout, GpuError> {
    let parameters = match shader.has_lists {
        true => descriptor::list_layout(gpu),
        false => descriptor::uniform_layout(gpu),
    }?;
    PipelineLayout::new(
        gpu,
        parameters,
        descriptor::texture_layout(gpu)?,
        if shader.has_depth { 3 } else { 1 },
    )
}
