//! A triangle that covers the whole image: each of its pixels is shaded once; hidden in part, where that is asked for.

use crate::device::{Asks, Device, SIDE, whole};
use ash::vk;

pub const SHADERS: &str = "
    @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    }
    @fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
        return vec4f(at.xy / 256.0, 0.0, 1.0);
    }";

/// Settings of the program.
pub struct Drawing {
    pub asks: Asks,
    /// Number of submits of the same command buffer.
    pub submits: u32,
    /// Whether the program counts by itself.
    pub own_query: bool,
    /// Whether depth is tested, and already nearer in every second block of 4 x 4 pixels, as in a template.
    pub hidden: bool,
    /// Whether the program has a pool of occlusion queries.
    pub own_occlusion: bool,
}

impl Default for Drawing {
    fn default() -> Self {
        Self { asks: Asks::Directly, submits: 1, own_query: false, hidden: false, own_occlusion: false }
    }
}

/// Draws, and returns the program's own count.
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
        let depth = drawing.hidden.then(|| Depth::new(&device));
        let layout = vk.create_pipeline_layout(&Default::default(), None).unwrap();
        let pipeline = pipeline(vk, layout, drawing.hidden);
        let occlusion = drawing.own_occlusion.then(|| {
            let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::OCCLUSION).query_count(1);
            vk.create_query_pool(&info, None).unwrap()
        });
        let query = drawing.own_query.then(|| query(vk));
        let commands = device.record(|buffer| {
            if let Some(query) = query {
                vk.cmd_reset_query_pool(buffer, query, 0, 1);
                vk.cmd_begin_query(buffer, query, 0, Default::default());
            }
            if let Some(occlusion) = occlusion {
                vk.cmd_reset_query_pool(buffer, occlusion, 0, 1);
                vk.cmd_begin_query(buffer, occlusion, 0, Default::default());
            }
            render(vk, buffer, image, view, depth.as_ref(), pipeline);
            if let Some(occlusion) = occlusion {
                vk.cmd_end_query(buffer, occlusion, 0);
            }
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
        if let Some(occlusion) = occlusion {
            vk.destroy_query_pool(occlusion, None);
        }
        if let Some(depth) = depth {
            vk.destroy_image_view(depth.view, None);
            vk.destroy_image(depth.image, None);
            vk.free_memory(depth.memory, None);
        }
        vk.destroy_pipeline(pipeline, None);
        vk.destroy_pipeline_layout(layout, None);
        vk.destroy_image_view(view, None);
        vk.destroy_image(image, None);
        vk.free_memory(memory, None);
        counted
    }
}

const DEPTH_FORMAT: vk::Format = vk::Format::D16_UNORM;

/// A depth buffer.
struct Depth {
    image: vk::Image,
    memory: vk::DeviceMemory,
    view: vk::ImageView,
}

impl Depth {
    /// # Safety
    ///
    /// The caller destroys it before the device.
    unsafe fn new(device: &Device) -> Self {
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let (image, memory) = device.image_of(DEPTH_FORMAT, usage);
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(DEPTH_FORMAT)
            .subresource_range(whole().aspect_mask(vk::ImageAspectFlags::DEPTH));
        // SAFETY: plain use of Vulkan.
        let view = unsafe { device.device.create_image_view(&info, None).unwrap() };
        Self { image, memory, view }
    }
}

/// Every second block of 4 x 4 pixels.
fn blocks() -> Vec<vk::ClearRect> {
    let side = SIDE as i32 / 4;
    let blocks = (0..side * side).map(|block| (block % side, block / side)).filter(|(x, y)| (x + y) % 2 == 0);
    let rect = |(x, y)| vk::Rect2D {
        offset: vk::Offset2D { x: x * 4, y: y * 4 },
        extent: vk::Extent2D { width: 4, height: 4 },
    };
    blocks.map(|block| vk::ClearRect { rect: rect(block), base_array_layer: 0, layer_count: 1 }).collect()
}

/// # Safety
/// The device is alive, with the feature pipelineStatisticsQuery.
unsafe fn query(device: &ash::Device) -> vk::QueryPool {
    let info = vk::QueryPoolCreateInfo::default()
        .query_type(vk::QueryType::PIPELINE_STATISTICS)
        .query_count(1)
        .pipeline_statistics(vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS);
    // SAFETY: plain use of Vulkan.
    unsafe { device.create_query_pool(&info, None).unwrap() }
}

/// # Safety
/// The arguments are valid for the device, and none of them is in use.
unsafe fn render(
    device: &ash::Device,
    buffer: vk::CommandBuffer,
    image: vk::Image,
    view: vk::ImageView,
    depth: Option<&Depth>,
    pipeline: vk::Pipeline,
) {
    let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let stage = vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT;
    let mut barriers = vec![
        vk::ImageMemoryBarrier2::default()
            .new_layout(layout)
            .src_stage_mask(stage)
            .dst_stage_mask(stage)
            .dst_access_mask(vk::AccessFlags2::COLOR_ATTACHMENT_WRITE)
            .image(image)
            .subresource_range(whole()),
    ];
    let depth_layout = vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL;
    let tests = vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS;
    barriers.extend(depth.map(|depth| {
        vk::ImageMemoryBarrier2::default()
            .new_layout(depth_layout)
            .src_stage_mask(tests)
            .src_access_mask(vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE)
            .dst_stage_mask(tests)
            .dst_access_mask(vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE)
            .image(depth.image)
            .subresource_range(whole().aspect_mask(vk::ImageAspectFlags::DEPTH))
    }));
    let depth_attachment = depth.map(|depth| {
        let far = vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 } };
        vk::RenderingAttachmentInfo::default()
            .image_view(depth.view)
            .image_layout(depth_layout)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::DONT_CARE)
            .clear_value(far)
    });
    let area = vk::Rect2D::default().extent(vk::Extent2D { width: SIDE, height: SIDE });
    let attachment = [vk::RenderingAttachmentInfo::default()
        .image_view(view)
        .image_layout(layout)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)];
    let mut rendering =
        vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&attachment);
    if let Some(depth) = &depth_attachment {
        rendering = rendering.depth_attachment(depth);
    }
    // SAFETY: plain use of Vulkan.
    unsafe {
        device.cmd_pipeline_barrier2(buffer, &vk::DependencyInfo::default().image_memory_barriers(&barriers));
        device.cmd_begin_rendering(buffer, &rendering);
        if depth.is_some() {
            let near = vk::ClearAttachment {
                aspect_mask: vk::ImageAspectFlags::DEPTH,
                color_attachment: 0,
                clear_value: vk::ClearValue::default(),
            };
            device.cmd_clear_attachments(buffer, &[near], &blocks());
        }
        device.cmd_bind_pipeline(buffer, vk::PipelineBindPoint::GRAPHICS, pipeline);
        device.cmd_draw(buffer, 3, 1, 0, 0);
        device.cmd_end_rendering(buffer);
    }
}

/// # Safety
/// `layout` is of the device.
unsafe fn pipeline(device: &ash::Device, layout: vk::PipelineLayout, tests_depth: bool) -> vk::Pipeline {
    let module = naga::front::wgsl::parse_str(SHADERS).unwrap();
    let info = naga::valid::Validator::new(Default::default(), Default::default()).validate(&module).unwrap();
    let code = naga::back::spv::write_vec(&module, &info, &Default::default(), None).unwrap();
    let viewport =
        [vk::Viewport { width: SIDE as f32, height: SIDE as f32, max_depth: 1.0, ..Default::default() }];
    let scissor = [vk::Rect2D::default().extent(vk::Extent2D { width: SIDE, height: SIDE })];
    let blend =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let formats = [vk::Format::R8G8B8A8_UNORM];
    let mut rendering = vk::PipelineRenderingCreateInfo::default()
        .color_attachment_formats(&formats)
        .depth_attachment_format(if tests_depth { DEPTH_FORMAT } else { vk::Format::UNDEFINED });
    let depth = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(tests_depth)
        .depth_compare_op(vk::CompareOp::LESS);
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
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .layout(layout)
            .push_next(&mut rendering);
        let pipeline = device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None).unwrap()[0];
        device.destroy_shader_module(shader, None);
        pipeline
    }
}
