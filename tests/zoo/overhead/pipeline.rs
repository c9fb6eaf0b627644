//! Render pass, descriptors and pipelines.

use crate::device::Device;
use crate::scene::{PUSH_BYTES, SIZE};
use crate::style::Style;
use anyhow::{Context, Result};
use ash::vk;

/// Format of all colour images.
pub const FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;

/// Format of the depth buffer; every device can use it.
pub const DEPTH_FORMAT: vk::Format = vk::Format::D16_UNORM;

const SHADERS: &str = "
    struct Constants { matrix: mat4x4f }
    var<immediate> constants: Constants;
    @group(0) @binding(0) var<uniform> material: vec4f;
    @vertex fn vertex(@location(0) at: vec4f) -> @builtin(position) vec4f {
        return constants.matrix * at + material;
    }
    @fragment fn fragment() -> @location(0) vec4f {
        return vec4f(1.0);
    }";

/// Two pipelines for the same target, which differ in their culling.
pub struct Pipeline<'a> {
    device: &'a Device,
    /// Null with dynamic rendering.
    pub render_pass: vk::RenderPass,
    /// One uniform buffer with a dynamic offset.
    pub set_layout: vk::DescriptorSetLayout,
    pub layout: vk::PipelineLayout,
    pub variants: [vk::Pipeline; 2],
}

impl<'a> Pipeline<'a> {
    /// Makes both.
    pub fn new(device: &'a Device, style: Style) -> Result<Self> {
        let vk = &device.functions;
        let push =
            [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::VERTEX).size(PUSH_BYTES)];
        let material = [vk::DescriptorSetLayoutBinding::default()
            .descriptor_type(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::VERTEX)];
        let material = vk::DescriptorSetLayoutCreateInfo::default().bindings(&material);
        let shaders = spirv(SHADERS)?;
        let shaders = vk::ShaderModuleCreateInfo::default().code(&shaders);
        // SAFETY: plain use of Vulkan: valid structures, and the handles live as long as this object.
        unsafe {
            let render_pass = match style {
                Style::RenderPass => render_pass(device)?,
                Style::DynamicRendering => vk::RenderPass::null(),
            };
            let set_layout = vk.create_descriptor_set_layout(&material, None)?;
            let set_layouts = [set_layout];
            let layout =
                vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts).push_constant_ranges(&push);
            let layout = vk.create_pipeline_layout(&layout, None)?;
            let shaders = vk.create_shader_module(&shaders, None)?;
            let variant = |culling| {
                let has_vertices = true;
                graphics_pipeline(
                    device,
                    Parts { render_pass, layout, shaders, culling, has_vertices, extent: SIZE },
                )
            };
            let variants = [variant(vk::CullModeFlags::NONE)?, variant(vk::CullModeFlags::BACK)?];
            vk.destroy_shader_module(shaders, None);
            Ok(Self { device, render_pass, set_layout, layout, variants })
        }
    }
}

/// WGSL as SPIR-V.
pub fn spirv(shaders: &str) -> Result<Vec<u32>> {
    let module = naga::front::wgsl::parse_str(shaders)?;
    let capabilities = naga::valid::Capabilities::IMMEDIATES;
    let info =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities).validate(&module)?;
    naga::back::spv::write_vec(&module, &info, &naga::back::spv::Options::default(), None)
        .context("SPIR-V of the shaders")
}

/// A render pass that clears colour and depth, and keeps colour.
///
/// # Safety
///
/// The caller destroys it before the device.
pub unsafe fn render_pass(device: &Device) -> Result<vk::RenderPass> {
    let attachment = |format, store, layout| {
        vk::AttachmentDescription::default()
            .format(format)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(store)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .final_layout(layout)
    };
    let colour_layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let depth_layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    let attachments = [
        attachment(FORMAT, vk::AttachmentStoreOp::STORE, colour_layout),
        attachment(DEPTH_FORMAT, vk::AttachmentStoreOp::DONT_CARE, depth_layout),
    ];
    let colour = [vk::AttachmentReference { attachment: 0, layout: colour_layout }];
    let depth = vk::AttachmentReference { attachment: 1, layout: depth_layout };
    let subpasses =
        [vk::SubpassDescription::default().color_attachments(&colour).depth_stencil_attachment(&depth)];
    // The last pass's writes to the images come before this one's clear.
    let stages = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let writes = vk::AccessFlags::COLOR_ATTACHMENT_WRITE | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let dependencies = [vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(stages)
        .src_access_mask(writes)
        .dst_stage_mask(stages)
        .dst_access_mask(writes | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ)];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: a valid structure.
    unsafe { Ok(device.functions.create_render_pass(&info, None)?) }
}

/// Differences between pipelines.
pub struct Parts {
    /// Null with dynamic rendering.
    pub render_pass: vk::RenderPass,
    pub layout: vk::PipelineLayout,
    /// With the entry points `vertex` and `fragment`.
    pub shaders: vk::ShaderModule,
    pub culling: vk::CullModeFlags,
    /// Whether there is a vertex buffer of `vec4f`.
    pub has_vertices: bool,
    /// Size of the viewport, pixels.
    pub extent: vk::Extent2D,
}

/// Makes a pipeline with depth test and dynamic scissor.
///
/// # Safety
///
/// The handles are live; the caller destroys the pipeline before the device.
pub unsafe fn graphics_pipeline(device: &Device, parts: Parts) -> Result<vk::Pipeline> {
    let Parts { render_pass, layout, shaders, culling, has_vertices, extent } = parts;
    let stage =
        |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(shaders).name(name);
    let stages =
        [stage(vk::ShaderStageFlags::VERTEX, c"vertex"), stage(vk::ShaderStageFlags::FRAGMENT, c"fragment")];
    let bindings = [vk::VertexInputBindingDescription::default().stride(16)];
    let attributes = [vk::VertexInputAttributeDescription::default().format(vk::Format::R32G32B32A32_SFLOAT)];
    let mut vertices = vk::PipelineVertexInputStateCreateInfo::default();
    if has_vertices {
        vertices = vertices.vertex_binding_descriptions(&bindings).vertex_attribute_descriptions(&attributes);
    }
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let (width, height) = (extent.width as f32, extent.height as f32);
    let viewports = [vk::Viewport { width, height, max_depth: 1.0, ..Default::default() }];
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissor_count(1);
    let rasterization =
        vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0).cull_mode(culling);
    let samples =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let blend =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blend);
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&[vk::DynamicState::SCISSOR]);
    let depth = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::LESS);
    let formats = [FORMAT];
    let mut rendering = vk::PipelineRenderingCreateInfo::default()
        .color_attachment_formats(&formats)
        .depth_attachment_format(DEPTH_FORMAT);
    let mut info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&vertices)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&samples)
        .depth_stencil_state(&depth)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(render_pass);
    if render_pass == vk::RenderPass::null() {
        info = info.push_next(&mut rendering);
    }
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
            vk.destroy_descriptor_set_layout(self.set_layout, None);
            vk.destroy_render_pass(self.render_pass, None);
        }
    }
}
