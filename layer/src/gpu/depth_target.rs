//! A depth image of ours that full-screen triangles are drawn to, and that is copied from.

use super::compute::ComputeLayout;
use super::framebuffer::framebuffer;
use super::image::{ImageDescription, OwnedImage, depth_view};
use super::pipeline::{graphics_pipeline, shader_module};
use super::{Gpu, GpuError, ImagePart, Owned};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// Properties of a [`DepthTarget`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthTargetDescription {
    pub(crate) format: vk::Format,
    pub(crate) samples: vk::SampleCountFlags,
    pub(crate) extent: vk::Extent2D,
    pub(crate) layers: u32,
    /// Depth that it is cleared to, 0..=1.
    pub(crate) cleared: f32,
    /// Depth of everything that is drawn, 0..=1.
    pub(crate) drawn: f32,
}

/// A depth image, and the pipeline that draws to it.
pub(crate) struct DepthTarget {
    // In the order in which each may be destroyed.
    pipeline: Owned<vk::Pipeline>,
    framebuffers: Vec<(Owned<vk::Framebuffer>, Owned<vk::ImageView>)>,
    pass: Owned<vk::RenderPass>,
    image: OwnedImage,
    description: DepthTargetDescription,
}

impl DepthTarget {
    /// Makes the image, whose content is undefined, and a pipeline of two entry points of a module of SPIR-V, for vertices and for
    /// fragments, which draws all fragments that the latter does not discard.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        layout: &ComputeLayout,
        spirv: &[u8],
        entries: [&CStr; 2],
        description: &DepthTargetDescription,
    ) -> Result<Self, GpuError> {
        let &DepthTargetDescription { format, samples, extent, layers, .. } = description;
        let image = OwnedImage::new(
            gpu,
            &ImageDescription {
                format,
                samples,
                extent,
                array_layers: layers,
                usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC,
                mutable: false,
                view_formats: &[],
            },
        )?;
        let pass = render_pass(gpu, format, samples)?;
        let of_layer = |layer| {
            let view = depth_view(gpu, image.handle(), format, layer)?;
            Ok((framebuffer(gpu, &pass, &view, extent)?, view))
        };
        let framebuffers = (0..layers).map(of_layer).collect::<Result<_, GpuError>>()?;
        let pipeline = pipeline(gpu, layout, &pass, spirv, entries, description)?;
        Ok(Self { pipeline, framebuffers, pass, image, description: *description })
    }

    /// The depth of all its layers.
    pub(crate) fn part(&self) -> ImagePart {
        let aspects = vk::ImageAspectFlags::DEPTH;
        let layers = self.description.layers;
        ImagePart { image: self.image.handle(), aspects, level: 0, first_layer: 0, layers }
    }

    /// Draws all layers, three vertices each.
    ///
    /// # Safety
    /// The command buffer is being recorded outside of a render pass, for a queue that draws; `set` has the layout that this was
    /// made with.
    pub(super) unsafe fn draw(
        &self,
        device: &ash::Device,
        commands: vk::CommandBuffer,
        layout: vk::PipelineLayout,
        set: vk::DescriptorSet,
    ) {
        let clear = vk::ClearDepthStencilValue { depth: self.description.cleared, stencil: 0 };
        let clears = [vk::ClearValue { depth_stencil: clear }];
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: self.description.extent };
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: the command buffer is recording outside of a render pass, and the set fits, as `# Safety` demands; the rest is live and made for each other.
        unsafe {
            device.cmd_bind_pipeline(commands, graphics, self.pipeline.handle());
            device.cmd_bind_descriptor_sets(commands, graphics, layout, 0, &[set], &[]);
            for (layer, (framebuffer, _)) in (0..).zip(&self.framebuffers) {
                let info = vk::RenderPassBeginInfo::default()
                    .render_pass(self.pass.handle())
                    .framebuffer(framebuffer.handle())
                    .render_area(area)
                    .clear_values(&clears);
                device.cmd_begin_render_pass(commands, &info, vk::SubpassContents::INLINE);
                device.cmd_draw(commands, 3, 1, 3 * layer, 0);
                device.cmd_end_render_pass(commands);
            }
        }
    }
}

/// A render pass over one depth attachment, cleared at first, in TRANSFER_SRC_OPTIMAL after it, in order with copies from it before
/// and after.
fn render_pass(
    gpu: &Arc<Gpu>,
    format: vk::Format,
    samples: vk::SampleCountFlags,
) -> Result<Owned<vk::RenderPass>, GpuError> {
    let attachments = [vk::AttachmentDescription::default()
        .format(format)
        .samples(samples)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(vk::ImageLayout::UNDEFINED)
        .final_layout(vk::ImageLayout::TRANSFER_SRC_OPTIMAL)];
    let layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    let reference = vk::AttachmentReference { attachment: 0, layout };
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .depth_stencil_attachment(&reference)];
    let tests = vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let uses =
        vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let dependencies = [
        vk::SubpassDependency::default()
            .src_subpass(vk::SUBPASS_EXTERNAL)
            .dst_subpass(0)
            .src_stage_mask(vk::PipelineStageFlags::TRANSFER | tests)
            .src_access_mask(vk::AccessFlags::TRANSFER_READ | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE)
            .dst_stage_mask(tests)
            .dst_access_mask(uses),
        vk::SubpassDependency::default()
            .src_subpass(0)
            .dst_subpass(vk::SUBPASS_EXTERNAL)
            .src_stage_mask(tests)
            .src_access_mask(uses)
            .dst_stage_mask(vk::PipelineStageFlags::TRANSFER)
            .dst_access_mask(vk::AccessFlags::TRANSFER_READ),
    ];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
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
    spirv: &[u8],
    [vertex, fragment]: [&CStr; 2],
    description: &DepthTargetDescription,
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
    let vk::Extent2D { width, height } = description.extent;
    // An empty depth range: everything has this depth exactly (Vulkan specification, "Controlling the Viewport").
    let viewports = [vk::Viewport {
        x: 0.0,
        y: 0.0,
        width: width as f32,
        height: height as f32,
        min_depth: description.drawn,
        max_depth: description.drawn,
    }];
    let scissors = [vk::Rect2D { offset: vk::Offset2D::default(), extent: description.extent }];
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissors(&scissors);
    let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
        .polygon_mode(vk::PolygonMode::FILL)
        .cull_mode(vk::CullModeFlags::NONE)
        .line_width(1.0);
    let multisample =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(description.samples);
    let tests = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::ALWAYS);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&vertex_input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&rasterization)
        .multisample_state(&multisample)
        .depth_stencil_state(&tests)
        .layout(layout.handle())
        .render_pass(pass.handle())
        .subpass(0);
    // SAFETY: everything named is live; the build has validated the module and the entry points' interface.
    unsafe { graphics_pipeline(gpu, &info) }
}
