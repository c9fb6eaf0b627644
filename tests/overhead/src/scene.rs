//! What is drawn: triangles without an area, each with the state changes that engines make around a draw.

use crate::device::Device;
use crate::pipeline::{Pipeline, SIDE};
use anyhow::Result;
use ash::vk;

/// Bytes pushed before each draw: a matrix.
pub const PUSH_BYTES: u32 = 64;

/// After so many draws another pipeline and scissor are set; engines sort draws by pipeline.
const DRAWS_PER_PIPELINE: u32 = 50;

/// A target, two pipelines and a vertex buffer.
pub struct Scene<'a> {
    device: &'a Device,
    image: vk::Image,
    image_memory: vk::DeviceMemory,
    view: vk::ImageView,
    framebuffer: vk::Framebuffer,
    vertices: vk::Buffer,
    vertices_memory: vk::DeviceMemory,
    pipeline: Pipeline<'a>,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
}

impl<'a> Scene<'a> {
    /// Makes everything.
    pub fn new(device: &'a Device) -> Result<Self> {
        let pipeline = Pipeline::new(device)?;
        let vk = &device.functions;
        // SAFETY: plain use of Vulkan: valid structures, and the handles live as long as this object.
        unsafe {
            let info = vk::ImageCreateInfo::default()
                .image_type(vk::ImageType::TYPE_2D)
                .format(Pipeline::FORMAT)
                .extent(vk::Extent3D { width: SIDE, height: SIDE, depth: 1 })
                .mip_levels(1)
                .array_layers(1)
                .samples(vk::SampleCountFlags::TYPE_1)
                .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
            let image = vk.create_image(&info, None)?;
            let needs = vk.get_image_memory_requirements(image);
            let image_memory = device.allocate(needs, vk::MemoryPropertyFlags::empty())?;
            vk.bind_image_memory(image, image_memory, 0)?;
            let range = vk::ImageSubresourceRange::default()
                .aspect_mask(vk::ImageAspectFlags::COLOR)
                .level_count(1)
                .layer_count(1);
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(Pipeline::FORMAT)
                .subresource_range(range);
            let view = vk.create_image_view(&info, None)?;
            let views = [view];
            let info = vk::FramebufferCreateInfo::default()
                .render_pass(pipeline.render_pass)
                .attachments(&views)
                .width(SIDE)
                .height(SIDE)
                .layers(1);
            let framebuffer = vk.create_framebuffer(&info, None)?;
            let (vertices, vertices_memory) = vertices(device)?;
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.family);
            let pool = vk.create_command_pool(&info, None)?;
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = vk.allocate_command_buffers(&info)?[0];
            Ok(Self {
                device,
                image,
                image_memory,
                view,
                framebuffer,
                vertices,
                vertices_memory,
                pipeline,
                pool,
                commands,
            })
        }
    }

    /// Records so many draws anew. The last recording's submit must have completed.
    pub fn record(&self, draws: u32) -> Result<vk::CommandBuffer> {
        let (vk, buffer) = (&self.device.functions, self.commands);
        let area = vk::Rect2D::default().extent(vk::Extent2D { width: SIDE, height: SIDE });
        let clear = [vk::ClearValue::default()];
        let pass = vk::RenderPassBeginInfo::default()
            .render_pass(self.pipeline.render_pass)
            .framebuffer(self.framebuffer)
            .render_area(area)
            .clear_values(&clear);
        let layout = self.pipeline.layout;
        let matrix = [0u8; PUSH_BYTES as usize];
        // SAFETY: plain use of Vulkan; the caller vouches that the buffer is not in use.
        unsafe {
            vk.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())?;
            vk.begin_command_buffer(buffer, &vk::CommandBufferBeginInfo::default())?;
            vk.cmd_begin_render_pass(buffer, &pass, vk::SubpassContents::INLINE);
            for draw in 0..draws {
                if draw % DRAWS_PER_PIPELINE == 0 {
                    let pipeline = self.pipeline.variants[(draw / DRAWS_PER_PIPELINE) as usize % 2];
                    vk.cmd_bind_pipeline(buffer, vk::PipelineBindPoint::GRAPHICS, pipeline);
                    vk.cmd_set_scissor(buffer, 0, &[area]);
                }
                vk.cmd_bind_vertex_buffers(buffer, 0, &[self.vertices], &[0]);
                vk.cmd_push_constants(buffer, layout, vk::ShaderStageFlags::VERTEX, 0, &matrix);
                vk.cmd_draw(buffer, 3, 1, 0, 0);
            }
            vk.cmd_end_render_pass(buffer);
            vk.end_command_buffer(buffer)?;
        }
        Ok(buffer)
    }
}

/// Three vertices at one point.
unsafe fn vertices(device: &Device) -> Result<(vk::Buffer, vk::DeviceMemory)> {
    let vk = &device.functions;
    let info = vk::BufferCreateInfo::default().size(3 * 16).usage(vk::BufferUsageFlags::VERTEX_BUFFER);
    let host = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
    // SAFETY: plain use of Vulkan; the mapping is at least as large as the buffer.
    unsafe {
        let buffer = vk.create_buffer(&info, None)?;
        let memory = device.allocate(vk.get_buffer_memory_requirements(buffer), host)?;
        vk.bind_buffer_memory(buffer, memory, 0)?;
        let mapped = vk.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())?;
        mapped.cast::<[f32; 12]>().write([0.0; 12]);
        vk.unmap_memory(memory);
        Ok((buffer, memory))
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        let vk = &self.device.functions;
        // SAFETY: the handles are this object's own. Waiting fails only for a lost device, which uses nothing
        // any more.
        unsafe {
            let _ = vk.device_wait_idle();
            vk.destroy_command_pool(self.pool, None);
            vk.destroy_framebuffer(self.framebuffer, None);
            vk.destroy_image_view(self.view, None);
            vk.destroy_image(self.image, None);
            vk.free_memory(self.image_memory, None);
            vk.destroy_buffer(self.vertices, None);
            vk.free_memory(self.vertices_memory, None);
        }
    }
}
