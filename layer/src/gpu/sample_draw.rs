//! Full-screen triangles to images of several samples of the application's, which keep their content.

use super::compute::{ComputeLayout, ComputeSet};
use super::framebuffer::framebuffer;
use super::image::{attachment_view, depth_view};
use super::pipeline::{graphics_pipeline, shader_module};
use super::{Gpu, GpuError, ImagePart, Owned};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// State that is dynamic in pipelines here, so that binding them leaves it: all of Vulkan 1.0 (Vulkan specification, "Dynamic State").
const DYNAMIC: [vk::DynamicState; 9] = [
    vk::DynamicState::VIEWPORT,
    vk::DynamicState::SCISSOR,
    vk::DynamicState::LINE_WIDTH,
    vk::DynamicState::DEPTH_BIAS,
    vk::DynamicState::BLEND_CONSTANTS,
    vk::DynamicState::DEPTH_BOUNDS,
    vk::DynamicState::STENCIL_COMPARE_MASK,
    vk::DynamicState::STENCIL_WRITE_MASK,
    vk::DynamicState::STENCIL_REFERENCE,
];

/// Whether binding a pipeline of [`SamplePass`] leaves this state as it was, but for viewports and scissors.
pub(crate) fn is_left(state: vk::DynamicState) -> bool {
    DYNAMIC.contains(&state)
}

/// The aspect that is drawn to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleAspect {
    /// Colour, in COLOR_ATTACHMENT_OPTIMAL.
    Color,
    /// Depth, in DEPTH_STENCIL_ATTACHMENT_OPTIMAL; stencil stays.
    Depth,
}

impl SampleAspect {
    /// The layout before and after.
    pub(crate) fn layout(self) -> vk::ImageLayout {
        match self {
            Self::Color => vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            Self::Depth => vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        }
    }
}

/// A render pass and a pipeline for images of one format and number of samples.
pub(crate) struct SamplePass {
    // In the order in which each may be destroyed.
    pipeline: Owned<vk::Pipeline>,
    pass: Owned<vk::RenderPass>,
}

impl SamplePass {
    /// Of two entry points of a module of SPIR-V, for vertices and for fragments; discarded fragments stay.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        layout: &ComputeLayout,
        (spirv, entries): (&[u8], [&CStr; 2]),
        (format, samples): (vk::Format, vk::SampleCountFlags),
        aspect: SampleAspect,
    ) -> Result<Self, GpuError> {
        let pass = render_pass(gpu, format, samples, aspect)?;
        let pipeline = pipeline(gpu, layout, &pass, (spirv, entries), samples, aspect)?;
        Ok(Self { pipeline, pass })
    }
}

/// Layers of an image of the application's.
pub(crate) struct SampleTarget {
    // In the order in which each may be destroyed.
    framebuffers: Vec<(Owned<vk::Framebuffer>, Owned<vk::ImageView>)>,
    extent: vk::Extent2D,
}

impl SampleTarget {
    /// Over the layers of `part`, of an image of at least `extent` pixels, which has one level, format and samples of `pass`.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        pass: &SamplePass,
        part: ImagePart,
        format: vk::Format,
        (extent, aspect): (vk::Extent2D, SampleAspect),
    ) -> Result<Self, GpuError> {
        let of_layer = |layer| {
            let layer = part.first_layer + layer;
            let view = match aspect {
                SampleAspect::Color => attachment_view(gpu, part.image, format, layer)?,
                SampleAspect::Depth => depth_view(gpu, part.image, format, layer)?,
            };
            Ok((framebuffer(gpu, &pass.pass, &view, extent)?, view))
        };
        let framebuffers = (0..part.layers).map(of_layer).collect::<Result<_, GpuError>>()?;
        Ok(Self { framebuffers, extent })
    }

    /// Draws three vertices to each layer, with one of the sets, the last one where they are too few.
    ///
    /// # Safety
    /// The command buffer is being recorded outside of a render pass, for a queue that draws; `pass`, `layout` and the sets are the ones
    /// that this was made with, or have the same layout.
    pub(super) unsafe fn draw(
        &self,
        device: &ash::Device,
        commands: vk::CommandBuffer,
        pass: &SamplePass,
        (layout, sets): (vk::PipelineLayout, &[ComputeSet]),
    ) {
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: self.extent };
        let (width, height) = (self.extent.width as f32, self.extent.height as f32);
        let viewport = vk::Viewport { x: 0.0, y: 0.0, width, height, min_depth: 0.0, max_depth: 1.0 };
        // SAFETY: the command buffer is recording outside of a render pass, as `# Safety` demands; the pipeline is live.
        unsafe {
            device.cmd_bind_pipeline(commands, graphics, pass.pipeline.handle());
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[area]);
        }
        for (layer, (framebuffer, _)) in (0..).zip(&self.framebuffers) {
            let Some(set) = sets.get(layer as usize).or(sets.last()) else { return };
            let info = vk::RenderPassBeginInfo::default()
                .render_pass(pass.pass.handle())
                .framebuffer(framebuffer.handle())
                .render_area(area);
            // SAFETY: as above; set and framebuffer are live, and made for the bound pipeline and its pass.
            unsafe {
                device.cmd_bind_descriptor_sets(commands, graphics, layout, 0, &[set.handle()], &[]);
                device.cmd_begin_render_pass(commands, &info, vk::SubpassContents::INLINE);
                device.cmd_draw(commands, 3, 1, 3 * layer, 0);
                device.cmd_end_render_pass(commands);
            }
        }
    }
}

/// A render pass over one attachment that is loaded and stored, in one layout before and after; barriers order it with the rest.
fn render_pass(
    gpu: &Arc<Gpu>,
    format: vk::Format,
    samples: vk::SampleCountFlags,
    aspect: SampleAspect,
) -> Result<Owned<vk::RenderPass>, GpuError> {
    let layout = aspect.layout();
    let attachments = [vk::AttachmentDescription::default()
        .format(format)
        .samples(samples)
        .load_op(vk::AttachmentLoadOp::LOAD)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::LOAD)
        .stencil_store_op(vk::AttachmentStoreOp::STORE)
        .initial_layout(layout)
        .final_layout(layout)];
    let reference = [vk::AttachmentReference { attachment: 0, layout }];
    let subpass = vk::SubpassDescription::default().pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS);
    let subpasses = [match aspect {
        SampleAspect::Color => subpass.color_attachments(&reference),
        SampleAspect::Depth => subpass.depth_stencil_attachment(&reference[0]),
    }];
    let info = vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses);
    // SAFETY: the device is live.
    unsafe {
        let handle =
            gpu.device.create_render_pass(&info, None).map_err(GpuError::from_call("vkCreateRenderPass"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_render_pass(handle, None)))
    }
}

fn pipeline(
    gpu: &Arc<Gpu>,
    layout: &ComputeLayout,
    pass: &Owned<vk::RenderPass>,
    (spirv, [vertex, fragment]): (&[u8], [&CStr; 2]),
    samples: vk::SampleCountFlags,
    aspect: SampleAspect,
) -> Result<Owned<vk::Pipeline>, GpuError> {
    let module = shader_module(gpu, spirv)?;
    let stage = |flag, name| {
        vk::PipelineShaderStageCreateInfo::default().stage(flag).module(module.handle()).name(name)
    };
    let stages =
        [stage(vk::ShaderStageFlags::VERTEX, vertex), stage(vk::ShaderStageFlags::FRAGMENT, fragment)];
    let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
    let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
        .polygon_mode(vk::PolygonMode::FILL)
        .cull_mode(vk::CullModeFlags::NONE)
        .line_width(1.0);
    let multisample = vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(samples);
    let tests = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::ALWAYS);
    let write =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&write);
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&DYNAMIC);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&vertex_input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&multisample)
        .dynamic_state(&dynamic)
        .layout(layout.handle())
        .render_pass(pass.handle())
        .subpass(0);
    let info = match aspect {
        SampleAspect::Color => info.color_blend_state(&blend),
        SampleAspect::Depth => info.depth_stencil_state(&tests),
    };
    // SAFETY: everything named is live; the build has validated the module and the entry points' interface.
    unsafe { graphics_pipeline(gpu, &info) }
}
