//! Render pass and pipelines.

use crate::device::Device;
use crate::scene::PUSH_BYTES;
use anyhow::{Context, Result};
use ash::vk;

/// Side of the target, in pixels: small, as nothing is drawn.
pub const SIDE: u32 = 64;

const SHADERS: &str = "
    struct Constants { matrix: mat4x4f }
    var<immediate> constants: Constants;
    @vertex fn vertex(@location(0) at: vec4f) -> @builtin(position) vec4f {
        return constants.matrix * at;
    }
    @fragment fn fragment() -> @location(0) vec4f {
        return vec4f(1.0);
    }";

/// Two pipelines for the same target, which differ in their culling.
pub struct Pipeline<'a> {
    device: &'a Device,
    pub render_pass: vk::RenderPass,
    pub layout: vk::PipelineLayout,
    pub variants: [vk::Pipeline; 2],
}

impl<'a> Pipeline<'a> {
    /// The target's format; every device can draw to it.
    pub const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

    /// Makes both.
    pub fn new(device: &'a Device) -> Result<Self> {
        let vk = &device.functions;
        let push =
            [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::VERTEX).size(PUSH_BYTES)];
        let layout = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&push);
        let shaders = spirv()?;
        let shaders = vk::ShaderModuleCreateInfo::default().code(&shaders);
        // SAFETY: plain use of Vulkan: valid structures, and the handles live as long as this object.
        unsafe {
            let render_pass = render_pass(device)?;
            let layout = vk.create_pipeline_layout(&layout, None)?;
            let shaders = vk.create_shader_module(&shaders, None)?;
            let variant = |culling| variant(device, render_pass, layout, shaders, culling);
            let variants = [variant(vk::CullModeFlags::NONE)?, variant(vk::CullModeFlags::BACK)?];
            vk.destroy_shader_module(shaders, None);
            Ok(Self { device, render_pass, layout, variants })
        }
    }
}

fn spirv() -> Result<Vec<u32>> {
    let module = naga::front::wgsl::parse_str(SHADERS)?;
    let capabilities = naga::valid::Capabilities::IMMEDIATES;
    let info =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities).validate(&module)?;
    naga::back::spv::write_vec(&module, &info, &naga::back::spv::Options::default(), None)
        .context("SPIR-V of the shaders")
}

unsafe fn render_pass(device: &Device) -> Result<vk::RenderPass> {
    let attachments = [vk::AttachmentDescription::default()
        .format(Pipeline::FORMAT)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .final_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)];
    let colour =
        [vk::AttachmentReference { attachment: 0, layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL }];
    let subpasses = [vk::SubpassDescription::default().color_attachments(&colour)];
    // The last submit's writes to the image come before this one's clear.
    let stage = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT;
    let dependencies = [vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(stage)
        .src_access_mask(vk::AccessFlags::COLOR_ATTACHMENT_WRITE)
        .dst_stage_mask(stage)
        .dst_access_mask(vk::AccessFlags::COLOR_ATTACHMENT_WRITE)];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: a valid structure.
    unsafe { Ok(device.functions.create_render_pass(&info, None)?) }
}

unsafe fn variant(
    device: &Device,
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    shaders: vk::ShaderModule,
    culling: vk::CullModeFlags,
) -> Result<vk::Pipeline> {
    let stage =
        |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(shaders).name(name);
    let stages =
        [stage(vk::ShaderStageFlags::VERTEX, c"vertex"), stage(vk::ShaderStageFlags::FRAGMENT, c"fragment")];
    let bindings = [vk::VertexInputBindingDescription::default().stride(16)];
    let attributes = [vk::VertexInputAttributeDescription::default().format(vk::Format::R32G32B32A32_SFLOAT)];
    let vertices = vk::PipelineVertexInputStateCreateInfo::default()
        .vertex_binding_descriptions(&bindings)
        .vertex_attribute_descriptions(&attributes);
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewports =
        [vk::Viewport { width: SIDE as f32, height: SIDE as f32, max_depth: 1.0, ..Default::default() }];
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissor_count(1);
    let rasterization =
        vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0).cull_mode(culling);
    let samples =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let blend =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blend);
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&[vk::DynamicState::SCISSOR]);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&vertices)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&samples)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(render_pass);
    // SAFETY: valid structures, of live handles.
    let made =
        unsafe { device.functions.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
    let made = made.map_err(|(_, error)| error)?;
    made.first().copied().context("vkCreateGraphicsPipelines made none")
}

impl Drop for Pipeline<'_> {
    fn drop(&mut self) {
        let vk = &self.device.functions;
        // SAFETY: the handles are this object's own; the scene, which has it as a part, has waited.
        unsafe {
            for pipeline in self.variants {
                vk.destroy_pipeline(pipeline, None);
            }
            vk.destroy_pipeline_layout(self.layout, None);
            vk.destroy_render_pass(self.render_pass, None);
        }
    }
}
