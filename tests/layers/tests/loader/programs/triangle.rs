//! A triangle that covers the whole image: each of its pixels is shaded once.

use crate::device::{Asks, Device, SIDE, whole};
use ash::vk;

pub const SHADERS: &str = "
    @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    }
    @fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
        return vec4f(at.xy / 256.0, 0.0, 1.0);
    }";

/// What to draw, and how.
pub struct Drawing {
    pub asks: Asks,
    /// How often the same command buffer is submitted.
    pub submits: u32,
    /// Whether the program counts by itself.
    pub own_query: bool,
}

impl Default for Drawing {
    fn default() -> Self {
        Self { asks: Asks::Directly, submits: 1, own_query: false }
    }
}

/// Draws, and returns what the program itself counted.
pub fn draw(drawing: Drawing) -> Option<u64> {
    let features = vk::PhysicalDeviceFeatures::default().pipeline_statistics_query(drawing.own_query);
    let device = Device::new(vk::API_VERSION_1_3, features, drawing.asks);
    let (image, memory) = device.image();
    let vk = &device.device;
    // SAFETY: plain use of Vulkan.
    unsafe {
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(vk::Format::R8G8B8A8_UNORM)
            .subresource_range(whole());
        let view = vk.create_image_view(&info, None).unwrap();
        let layout = vk.create_pipeline_layout(&Default::default(), None).unwrap();
        let pipeline = pipeline(vk, layout);
        let query = drawing.own_query.then(|| query(vk));
        let commands = device.record(|buffer| {
            if let Some(query) = query {
                vk.cmd_reset_query_pool(buffer, query, 0, 1);
                vk.cmd_begin_query(buffer, query, 0, Default::default());
            }
            render(vk, buffer, image, view, pipeline);
            if let Some(query) = query {
                vk.cmd_end_query(buffer, query, 0);
            }
        });
        for submit in 0..drawing.submits {
            device.submit(&[commands], submit % 2 == 1);
            device.wait();
        }
        let counted = query.map(|query| {
            let mut result = [0u64];
            vk.get_query_pool_results(query, 0, &mut result, vk::QueryResultFlags::TYPE_64).unwrap();
            vk.destroy_query_pool(query, None);
            result[0]
        });
        vk.destroy_pipeline(pipeline, None);
        vk.destroy_pipeline_layout(layout, None);
        vk.destroy_image_view(view, None);
        vk.destroy_image(image, None);
        vk.free_memory(memory, None);
        counted
    }
}

unsafe fn query(device: &ash::Device) -> vk::QueryPool {
    let info = vk::QueryPoolCreateInfo::default()
        .query_type(vk::QueryType::PIPELINE_STATISTICS)
        .query_count(1)
        .pipeline_statistics(vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS);
    // SAFETY: plain use of Vulkan.
    unsafe { device.create_query_pool(&info, None).unwrap() }
}

unsafe fn render(
    device: &ash::Device,
    buffer: vk::CommandBuffer,
    image: vk::Image,
    view: vk::ImageView,
    pipeline: vk::Pipeline,
) {
    let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let stage = vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT;
    let barrier = [vk::ImageMemoryBarrier2::default()
        .new_layout(layout)
        .src_stage_mask(stage)
        .dst_stage_mask(stage)
        .dst_access_mask(vk::AccessFlags2::COLOR_ATTACHMENT_WRITE)
        .image(image)
        .subresource_range(whole())];
    let area = vk::Rect2D::default().extent(vk::Extent2D { width: SIDE, height: SIDE });
    let attachment = [vk::RenderingAttachmentInfo::default()
        .image_view(view)
        .image_layout(layout)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)];
    let rendering =
        vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&attachment);
    // SAFETY: plain use of Vulkan.
    unsafe {
        device.cmd_pipeline_barrier2(buffer, &vk::DependencyInfo::default().image_memory_barriers(&barrier));
        device.cmd_begin_rendering(buffer, &rendering);
        device.cmd_bind_pipeline(buffer, vk::PipelineBindPoint::GRAPHICS, pipeline);
        device.cmd_draw(buffer, 3, 1, 0, 0);
        device.cmd_end_rendering(buffer);
    }
}

unsafe fn pipeline(device: &ash::Device, layout: vk::PipelineLayout) -> vk::Pipeline {
    let module = naga::front::wgsl::parse_str(SHADERS).unwrap();
    let info = naga::valid::Validator::new(Default::default(), Default::default()).validate(&module).unwrap();
    let code = naga::back::spv::write_vec(&module, &info, &Default::default(), None).unwrap();
    let viewport =
        [vk::Viewport { width: SIDE as f32, height: SIDE as f32, max_depth: 1.0, ..Default::default() }];
    let scissor = [vk::Rect2D::default().extent(vk::Extent2D { width: SIDE, height: SIDE })];
    let blend =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let formats = [vk::Format::R8G8B8A8_UNORM];
    let mut rendering = vk::PipelineRenderingCreateInfo::default().color_attachment_formats(&formats);
    // SAFETY: plain use of Vulkan.
    unsafe {
        let shader = vk::ShaderModuleCreateInfo::default().code(&code);
        let shader = device.create_shader_module(&shader, None).unwrap();
        let stage =
            |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(shader).name(name);
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, c"vertex"),
            stage(vk::ShaderStageFlags::FRAGMENT, c"fragment"),
        ];
        let vertices = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewport).scissors(&scissor);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blend);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertices)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&samples)
            .color_blend_state(&blend)
            .layout(layout)
            .push_next(&mut rendering);
        let pipeline = device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None).unwrap()[0];
        device.destroy_shader_module(shader, None);
        pipeline
    }
}
