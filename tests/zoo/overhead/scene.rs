//! The scene: triangles without an area, each with the state changes that engines make around a draw.

use crate::buffer::Buffer;
use crate::device::Device;
use crate::pass;
use crate::pipeline::Pipeline;
use crate::style::Style;
use crate::target::Target;
use anyhow::Result;
use ash::vk;

/// Size of all targets, pixels: small, as nothing is drawn.
pub const SIZE: vk::Extent2D = vk::Extent2D { width: 64, height: 64 };

/// Bytes pushed before each draw: a matrix.
pub const PUSH_BYTES: u32 = 64;

/// After so many draws another pipeline and scissor are set; engines sort draws by pipeline.
const DRAWS_PER_PIPELINE: u32 = 10;

/// Materials, one after the other in a uniform buffer; each draw binds the next.
const MATERIALS: u32 = 64;

/// Distance of two materials, bytes: no device needs more.
const MATERIAL_BYTES: u32 = 256;

/// Two pipelines, their resources, and their target.
pub struct Scene<'a> {
    device: &'a Device,
    depth: Target<'a>,
    off_screen: Target<'a>,
    /// The swapchain images of each eye, where there are eyes.
    eyes: [Vec<Target<'a>>; 2],
    vertices: Buffer<'a>,
    _materials: Buffer<'a>,
    sets: vk::DescriptorPool,
    set: vk::DescriptorSet,
    pipeline: Pipeline<'a>,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
}

/// Amount of recorded work.
#[derive(Clone, Copy)]
pub struct Amount {
    /// Render passes, at least 1.
    pub passes: u32,
    /// Draw calls, spread over the passes.
    pub draws: u32,
}

impl<'a> Scene<'a> {
    /// Makes everything, for these swapchain images of the two eyes.
    pub fn new(device: &'a Device, style: Style, eyes: [&[vk::Image]; 2]) -> Result<Self> {
        let pipeline = Pipeline::new(device, style)?;
        let depth = Target::depth(device, SIZE)?;
        let complete = |target: Target<'a>| match style {
            Style::RenderPass => target.with_framebuffer(pipeline.render_pass, &depth),
            Style::DynamicRendering => Ok(target),
        };
        let off_screen = complete(Target::colour(device, SIZE)?)?;
        let eye = |images: &[vk::Image]| -> Result<Vec<Target<'a>>> {
            images.iter().map(|&image| complete(Target::of_swapchain(device, SIZE, image)?)).collect()
        };
        let eyes = [eye(eyes[0])?, eye(eyes[1])?];
        let vertices = Buffer::zeroed(device, 3 * 16, vk::BufferUsageFlags::VERTEX_BUFFER)?;
        let size = u64::from(MATERIALS * MATERIAL_BYTES);
        let materials = Buffer::zeroed(device, size, vk::BufferUsageFlags::UNIFORM_BUFFER)?;
        let vk = &device.functions;
        // SAFETY: plain use of Vulkan: valid structures, and the handles live as long as this object.
        unsafe {
            let sizes = [vk::DescriptorPoolSize {
                ty: vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC,
                descriptor_count: 1,
            }];
            let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
            let sets = vk.create_descriptor_pool(&info, None)?;
            let layouts = [pipeline.set_layout];
            let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(sets).set_layouts(&layouts);
            let set = vk.allocate_descriptor_sets(&info)?[0];
            let range = [vk::DescriptorBufferInfo { buffer: materials.handle, offset: 0, range: 16 }];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .descriptor_type(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC)
                .buffer_info(&range);
            vk.update_descriptor_sets(&[write], &[]);
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.family);
            let pool = vk.create_command_pool(&info, None)?;
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = vk.allocate_command_buffers(&info)?[0];
            let _materials = materials;
            Ok(Self {
                device,
                depth,
                off_screen,
                eyes,
                vertices,
                _materials,
                sets,
                set,
                pipeline,
                pool,
                commands,
            })
        }
    }

    /// Records everything again: offscreen passes, of which the last two draw to these images of the eyes if there are
    /// eyes. The last recording's submit must have completed.
    // Valgrind finds the function to count by its name.
    #[inline(never)]
    pub fn record(&self, amount: Amount, eyes: Option<[usize; 2]>) -> Result<vk::CommandBuffer> {
        let (vk, buffer) = (&self.device.functions, self.commands);
        // SAFETY: plain use of Vulkan; the caller vouches that the buffer is not in use.
        unsafe {
            vk.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())?;
            vk.begin_command_buffer(buffer, &vk::CommandBufferBeginInfo::default())?;
            for number in 0..amount.passes {
                let target = match (eyes, amount.passes - number) {
                    (Some(images), left @ 1..=2) => {
                        let eye = 2 - left as usize;
                        &self.eyes[eye][images[eye]]
                    }
                    _ => &self.off_screen,
                };
                pass::begin(self.device, buffer, self.pipeline.render_pass, target, &self.depth);
                let before =
                    |number: u32| u64::from(amount.draws) * u64::from(number) / u64::from(amount.passes);
                self.draw((before(number + 1) - before(number)) as u32);
                pass::end(self.device, buffer, self.pipeline.render_pass);
            }
            vk.end_command_buffer(buffer)?;
        }
        Ok(buffer)
    }

    /// # Safety
    ///
    /// The command buffer is recording, in a render pass.
    unsafe fn draw(&self, draws: u32) {
        let (vk, buffer) = (&self.device.functions, self.commands);
        let area = vk::Rect2D::default().extent(SIZE);
        let layout = self.pipeline.layout;
        let matrix = [0u8; PUSH_BYTES as usize];
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        for draw in 0..draws {
            // SAFETY: plain use of Vulkan; the caller vouches for the command buffer.
            unsafe {
                if draw % DRAWS_PER_PIPELINE == 0 {
                    let pipeline = self.pipeline.variants[(draw / DRAWS_PER_PIPELINE) as usize % 2];
                    vk.cmd_bind_pipeline(buffer, graphics, pipeline);
                    vk.cmd_set_scissor(buffer, 0, &[area]);
                }
                vk.cmd_bind_vertex_buffers(buffer, 0, &[self.vertices.handle], &[0]);
                let offset = draw % MATERIALS * MATERIAL_BYTES;
                vk.cmd_bind_descriptor_sets(buffer, graphics, layout, 0, &[self.set], &[offset]);
                vk.cmd_push_constants(buffer, layout, vk::ShaderStageFlags::VERTEX, 0, &matrix);
                vk.cmd_draw(buffer, 3, 1, 0, 0);
            }
        }
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
            vk.destroy_descriptor_pool(self.sets, None);
        }
    }
}
