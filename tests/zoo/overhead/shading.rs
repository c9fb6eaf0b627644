//! One triangle over the whole image of each eye, every pixel of which costs a chosen amount.

use crate::device::Device;
use crate::headset::{Headset, Session};
use crate::pass;
use crate::pipeline::{Parts, graphics_pipeline, render_pass, spirv};
use crate::style::Style;
use crate::target::Target;
use anyhow::Result;
use ash::vk;
use clap::Args;

/// The loop depends on the pixel and cannot be shortened: each round is two multiplications, an addition and a fraction for
/// each of four channels.
const SHADERS: &str = "
    struct Constants { iterations: u32 }
    var<immediate> constants: Constants;
    @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
    }
    @fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
        var colour = fract(vec4f(at.x, at.y, at.x + at.y, 1.0) / 256.0);
        for (var i = 0u; i < constants.iterations; i++) {
            colour = fract(colour * 3.7 + colour.yzwx * colour.zwxy);
        }
        return colour;
    }";

/// A workload of shaded pixels.
#[derive(Args)]
pub struct Shading {
    /// Frames to show, then it ends.
    #[arg(long, default_value_t = 40)]
    frames: u32,
    /// Rounds of arithmetic for each pixel; without it, nothing is drawn.
    #[arg(long)]
    iterations: Option<u32>,
    /// Size of an eye's image, pixels: WxH, or the side of a square.
    #[arg(long, value_name = "WxH", default_value = "1024", value_parser = parse_size)]
    size: vk::Extent2D,
    /// Way to record render passes.
    #[arg(long, value_enum, default_value_t = Style::RenderPass)]
    style: Style,
}

fn parse_size(text: &str) -> Result<vk::Extent2D, String> {
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    let side = |text: &str| match text.parse::<u32>() {
        Ok(side @ 16..=8192) => Ok(side),
        _ => Err(format!("{text:?} is not a number from 16 to 8192")),
    };
    Ok(vk::Extent2D { width: side(width)?, height: side(height)? })
}

/// Shows its frames.
pub fn run(shading: &Shading) -> Result<()> {
    let headset = Headset::new()?;
    let device = Device::new(shading.style, Some(&headset))?;
    let mut session = headset.begin_session(&device, shading.size)?;
    let picture = Picture::new(&device, shading, &session)?;
    for _ in 0..shading.frames {
        let frame = session.begin_frame()?;
        device.submit(picture.record(shading.iterations, frame.images)?)?;
        session.end_frame(&frame)?;
        device.wait()?;
    }
    Ok(())
}

struct Picture<'a> {
    device: &'a Device,
    eyes: [Vec<Target<'a>>; 2],
    depth: Target<'a>,
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
}

impl<'a> Picture<'a> {
    fn new(device: &'a Device, shading: &Shading, session: &Session) -> Result<Self> {
        let vk = &device.functions;
        let extent = shading.size;
        let depth = Target::depth(device, extent)?;
        let push = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::FRAGMENT).size(4)];
        let layout = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&push);
        let shaders = spirv(SHADERS)?;
        let shaders = vk::ShaderModuleCreateInfo::default().code(&shaders);
        // SAFETY: plain use of Vulkan: valid structures, and the handles live as long as this object.
        unsafe {
            let render_pass = match shading.style {
                Style::RenderPass => render_pass(device)?,
                Style::DynamicRendering => vk::RenderPass::null(),
            };
            let layout = vk.create_pipeline_layout(&layout, None)?;
            let shaders = vk.create_shader_module(&shaders, None)?;
            let culling = vk::CullModeFlags::NONE;
            let parts = Parts { render_pass, layout, shaders, culling, has_vertices: false, extent };
            let pipeline = graphics_pipeline(device, parts)?;
            vk.destroy_shader_module(shaders, None);
            let eye = |images: &[vk::Image]| -> Result<Vec<Target<'a>>> {
                let target = |&image| -> Result<Target<'a>> {
                    let target = Target::of_swapchain(device, extent, image)?;
                    match shading.style {
                        Style::RenderPass => target.with_framebuffer(render_pass, &depth),
                        Style::DynamicRendering => Ok(target),
                    }
                };
                images.iter().map(target).collect()
            };
            let eyes = [eye(&session.eyes[0].images)?, eye(&session.eyes[1].images)?];
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.family);
            let pool = vk.create_command_pool(&info, None)?;
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = vk.allocate_command_buffers(&info)?[0];
            Ok(Self { device, eyes, depth, render_pass, layout, pipeline, pool, commands })
        }
    }

    /// Records a frame to these images of the eyes. The last frame must have completed.
    fn record(&self, iterations: Option<u32>, images: [usize; 2]) -> Result<vk::CommandBuffer> {
        let (vk, buffer) = (&self.device.functions, self.commands);
        // SAFETY: plain use of Vulkan; the caller vouches that the buffer is not in use.
        unsafe {
            vk.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())?;
            vk.begin_command_buffer(buffer, &vk::CommandBufferBeginInfo::default())?;
            for (eye, image) in self.eyes.iter().zip(images) {
                let target = &eye[image];
                pass::begin(self.device, buffer, self.render_pass, target, &self.depth);
                if let Some(iterations) = iterations {
                    let area = vk::Rect2D::default().extent(target.extent);
                    let stage = vk::ShaderStageFlags::FRAGMENT;
                    vk.cmd_bind_pipeline(buffer, vk::PipelineBindPoint::GRAPHICS, self.pipeline);
                    vk.cmd_set_scissor(buffer, 0, &[area]);
                    vk.cmd_push_constants(buffer, self.layout, stage, 0, &iterations.to_ne_bytes());
                    vk.cmd_draw(buffer, 3, 1, 0, 0);
                }
                pass::end(self.device, buffer, self.render_pass);
            }
            vk.end_command_buffer(buffer)?;
        }
        Ok(buffer)
    }
}

impl Drop for Picture<'_> {
    fn drop(&mut self) {
        let vk = &self.device.functions;
        // SAFETY: the handles are this object's own, or null. Waiting fails only for a lost device, which uses nothing any
        // more.
        unsafe {
            let _ = vk.device_wait_idle();
            vk.destroy_command_pool(self.pool, None);
            vk.destroy_pipeline(self.pipeline, None);
            vk.destroy_pipeline_layout(self.layout, None);
            vk.destroy_render_pass(self.render_pass, None);
        }
    }
}
