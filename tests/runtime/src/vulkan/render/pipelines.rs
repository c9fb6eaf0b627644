//! The compositor's two pipelines: layers into the linear light of an eye, and anything into a picture.

use super::super::{Gpu, failed};
use super::Pass;
use crate::fault::Fault;
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// Purpose of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Draws over each other, in linear light.
    Layer,
    /// One draw: 8-bit codes to be read back.
    Picture,
}

impl Purpose {
    /// Half floats distinguish all codes of 8-bit sRGB; devices must be able to blend and sample them.
    pub fn format(self) -> vk::Format {
        match self {
            Self::Layer => vk::Format::R16G16B16A16_SFLOAT,
            Self::Picture => vk::Format::R8G8B8A8_UNORM,
        }
    }

    /// Use of the target afterwards.
    pub fn usage(self) -> vk::ImageUsageFlags {
        match self {
            Self::Layer => vk::ImageUsageFlags::SAMPLED,
            Self::Picture => vk::ImageUsageFlags::TRANSFER_SRC,
        }
    }

    fn next_use(self) -> (vk::ImageLayout, vk::PipelineStageFlags, vk::AccessFlags) {
        match self {
            Self::Layer => (
                vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
                vk::PipelineStageFlags::FRAGMENT_SHADER,
                vk::AccessFlags::SHADER_READ,
            ),
            Self::Picture => (
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
                vk::PipelineStageFlags::TRANSFER,
                vk::AccessFlags::TRANSFER_READ,
            ),
        }
    }

    fn entry_point(self) -> &'static CStr {
        match self {
            Self::Layer => c"layer",
            Self::Picture => c"picture",
        }
    }
}

/// Shaders, layouts and passes.
pub(super) struct Pipelines {
    gpu: Arc<Gpu>,
    sampler: vk::Sampler,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    /// By [`Purpose`].
    passes: [vk::RenderPass; 2],
    /// By [`Purpose`].
    pipelines: [vk::Pipeline; 2],
}

const SHADER: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/composite.spv"));

impl Pipelines {
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, Fault> {
        let mut made = Self {
            gpu: gpu.clone(),
            sampler: vk::Sampler::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            passes: [vk::RenderPass::null(); 2],
            pipelines: [vk::Pipeline::null(); 2],
        };
        made.make_layouts()?;
        for purpose in [Purpose::Layer, Purpose::Picture] {
            made.passes[purpose as usize] = make_pass(gpu, purpose)?;
        }
        made.make_pipelines()?;
        Ok(made)
    }

    pub fn pass(&self, purpose: Purpose) -> vk::RenderPass {
        self.passes[purpose as usize]
    }

    pub fn set_layout(&self) -> vk::DescriptorSetLayout {
        self.set_layout
    }

    /// The bindings of a set, without the sampler in it.
    pub fn bindings(&self) -> [vk::DescriptorSetLayoutBinding<'static>; 3] {
        let binding = |binding, ty| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(ty)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::FRAGMENT)
        };
        [
            binding(0, vk::DescriptorType::UNIFORM_BUFFER),
            binding(1, vk::DescriptorType::SAMPLED_IMAGE),
            binding(2, vk::DescriptorType::SAMPLER),
        ]
    }

    fn make_layouts(&mut self) -> Result<(), Fault> {
        let device = &self.gpu.device;
        let edge = vk::SamplerAddressMode::CLAMP_TO_EDGE;
        let sampler = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .address_mode_u(edge)
            .address_mode_v(edge)
            .address_mode_w(edge);
        // SAFETY: the structures are complete; `self` destroys the objects that it has.
        unsafe {
            self.sampler = device.create_sampler(&sampler, None).map_err(failed("vkCreateSampler"))?;
            let samplers = [self.sampler];
            let [params, image, sampler] = self.bindings();
            let bindings = [params, image, sampler.immutable_samplers(&samplers)];
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            self.set_layout = device
                .create_descriptor_set_layout(&info, None)
                .map_err(failed("vkCreateDescriptorSetLayout"))?;
            let layouts = [self.set_layout];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
            self.layout =
                device.create_pipeline_layout(&info, None).map_err(failed("vkCreatePipelineLayout"))?;
        }
        Ok(())
    }

    fn make_pipelines(&mut self) -> Result<(), Fault> {
        let device = &self.gpu.device;
        let words: Vec<u32> = SHADER
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: SPIR-V that was compiled and validated at build time.
        let module =
            unsafe { device.create_shader_module(&info, None) }.map_err(failed("vkCreateShaderModule"))?;
        let made = [Purpose::Layer, Purpose::Picture].map(|purpose| self.make_pipeline(module, purpose));
        // SAFETY: pipelines do not need the module once they are made.
        unsafe { device.destroy_shader_module(module, None) };
        for (pipeline, made) in self.pipelines.iter_mut().zip(made) {
            *pipeline = made.map_err(failed("vkCreateGraphicsPipelines"))?;
        }
        Ok(())
    }

    fn make_pipeline(&self, module: vk::ShaderModule, purpose: Purpose) -> Result<vk::Pipeline, vk::Result> {
        let stage =
            |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(name);
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, c"whole_target"),
            stage(vk::ShaderStageFlags::FRAGMENT, purpose.entry_point()),
        ];
        let vertices = vk::PipelineVertexInputStateCreateInfo::default();
        let triangles = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let rasterisation = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        // Colours come multiplied with their alpha.
        let over = vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(purpose == Purpose::Layer)
            .src_color_blend_factor(vk::BlendFactor::ONE)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .color_write_mask(vk::ColorComponentFlags::RGBA);
        let attachments = [over];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&attachments);
        let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertices)
            .input_assembly_state(&triangles)
            .viewport_state(&viewport)
            .rasterization_state(&rasterisation)
            .multisample_state(&samples)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .render_pass(self.pass(purpose));
        // SAFETY: layout, pass and module are of this device; the layout has all the bindings that the shader uses.
        let made =
            unsafe { self.gpu.device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        made.map(|pipelines| pipelines[0]).map_err(|(_, error)| error)
    }

    /// Records a pass, and the copy of its target for the CPU.
    pub fn record(&self, device: &ash::Device, commands: vk::CommandBuffer, pass: &Pass<'_>) {
        let extent = pass.target.extent();
        let area = vk::Rect2D::default().extent(extent);
        let black = vk::ClearColorValue { float32: [0.0, 0.0, 0.0, 1.0] };
        let clear = [vk::ClearValue { color: black }];
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.pass(pass.purpose))
            .framebuffer(pass.target.framebuffer())
            .render_area(area)
            .clear_values(&clear);
        let viewport = vk::Viewport {
            width: extent.width as f32,
            height: extent.height as f32,
            max_depth: 1.0,
            ..vk::Viewport::default()
        };
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: the command buffer is being recorded; everything is of this device, and lives until it is done.
        unsafe {
            device.cmd_begin_render_pass(commands, &begin, vk::SubpassContents::INLINE);
            device.cmd_bind_pipeline(commands, graphics, self.pipelines[pass.purpose as usize]);
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[area]);
            for set in &pass.sets {
                device.cmd_bind_descriptor_sets(commands, graphics, self.layout, 0, &[*set], &[]);
                device.cmd_draw(commands, 3, 1, 0, 0);
            }
            device.cmd_end_render_pass(commands);
            if let Some(buffer) = pass.readback {
                copy_for_cpu(device, commands, pass, buffer.handle());
            }
        }
    }
}

/// # Safety
/// The command buffer is being recorded, after the pass; the buffer is large enough.
unsafe fn copy_for_cpu(
    device: &ash::Device,
    commands: vk::CommandBuffer,
    pass: &Pass<'_>,
    buffer: vk::Buffer,
) {
    let colour =
        vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1);
    let region =
        vk::BufferImageCopy::default().image_subresource(colour).image_extent(pass.target.extent().into());
    let to_cpu = vk::BufferMemoryBarrier::default()
        .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
        .dst_access_mask(vk::AccessFlags::HOST_READ)
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .buffer(buffer)
        .size(vk::WHOLE_SIZE);
    let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
    // SAFETY: this function's contract; the pass leaves its target in this layout.
    unsafe {
        device.cmd_copy_image_to_buffer(commands, pass.target.image(), layout, buffer, &[region]);
        device.cmd_pipeline_barrier(
            commands,
            vk::PipelineStageFlags::TRANSFER,
            vk::PipelineStageFlags::HOST,
            vk::DependencyFlags::empty(),
            &[],
            &[to_cpu],
            &[],
        );
    }
}

fn make_pass(gpu: &Arc<Gpu>, purpose: Purpose) -> Result<vk::RenderPass, Fault> {
    let (layout, stage, access) = purpose.next_use();
    let attachments = [vk::AttachmentDescription::default()
        .format(purpose.format())
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .initial_layout(vk::ImageLayout::UNDEFINED)
        .final_layout(layout)];
    let colour =
        [vk::AttachmentReference { attachment: 0, layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL }];
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colour)];
    let output = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT;
    let writes = vk::AccessFlags::COLOR_ATTACHMENT_READ | vk::AccessFlags::COLOR_ATTACHMENT_WRITE;
    let dependencies = [
        // The target's last use, a frame ago, before it is drawn into.
        vk::SubpassDependency::default()
            .src_subpass(vk::SUBPASS_EXTERNAL)
            .src_stage_mask(stage | output)
            .src_access_mask(vk::AccessFlags::COLOR_ATTACHMENT_WRITE)
            .dst_stage_mask(output)
            .dst_access_mask(writes),
        vk::SubpassDependency::default()
            .dst_subpass(vk::SUBPASS_EXTERNAL)
            .src_stage_mask(output)
            .src_access_mask(vk::AccessFlags::COLOR_ATTACHMENT_WRITE)
            .dst_stage_mask(stage)
            .dst_access_mask(access),
    ];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: the structure is complete.
    unsafe { gpu.device.create_render_pass(&info, None) }.map_err(failed("vkCreateRenderPass"))
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // SAFETY: made by this device, or null; not in use.
        unsafe {
            self.pipelines.iter().for_each(|&pipeline| device.destroy_pipeline(pipeline, None));
            self.passes.iter().for_each(|&pass| device.destroy_render_pass(pass, None));
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
            device.destroy_sampler(self.sampler, None);
        }
    }
}
