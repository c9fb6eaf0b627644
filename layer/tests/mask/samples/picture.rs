//! An image of several samples, drawn to and read on a Vulkan device.

use super::EXTENT;
use crate::transfer::Layer;
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::gpu::ImagePart;
use parafovea::kernels::samples::{SampleKind, USAGE};

/// Every device has as many (Vulkan specification, "Required Limits": framebufferColorSampleCounts and framebufferDepthSampleCounts).
const SAMPLES: vk::SampleCountFlags = vk::SampleCountFlags::TYPE_4;
pub(super) const SAMPLE_COUNT: usize = 4;
pub(super) const LAYERS: u32 = 2;
pub(super) const COLOR: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// Draws to one sample after the other, by the sample masks of pipelines, and reads all of them.
const SHADERS: &str = "
    struct Drawn { @builtin(position) position: vec4f, @location(0) @interpolate(flat) seed: u32 }

    // The seed is the first instance: layer and sample.
    @vertex fn vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) seed: u32) -> Drawn {
        return Drawn(vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0), seed);
    }

    fn noise(at: vec4f, seed: u32) -> u32 {
        let pixel = vec2u(at.xy);
        return (((pixel.y * 1000u + pixel.x) * 16u + seed) * 2654435761u) >> 8u;
    }

    @fragment fn color(drawn: Drawn) -> @location(0) vec4f {
        let bits = noise(drawn.position, drawn.seed);
        return vec4f(vec4u(bits, bits >> 5u, bits >> 10u, bits >> 15u) & vec4(255u)) / 255.0;
    }

    @fragment fn depth(drawn: Drawn) -> @builtin(frag_depth) f32 {
        return f32(noise(drawn.position, drawn.seed) & 0xffffu) / 65535.0;
    }

    @group(0) @binding(0) var picture: texture_multisampled_2d<f32>;
    @group(0) @binding(1) var slope: texture_depth_multisampled_2d;
    @group(0) @binding(2) var<storage, read_write> found: array<u32>;

    @compute @workgroup_size(1) fn read_color(@builtin(global_invocation_id) id: vec3u) {
        let size = textureDimensions(picture);
        let texel = textureLoad(picture, id.xy, i32(id.z));
        found[(id.y * size.x + id.x) * 4u + id.z] = pack4x8unorm(texel);
    }

    @compute @workgroup_size(1) fn read_depth(@builtin(global_invocation_id) id: vec3u) {
        let size = textureDimensions(slope);
        found[(id.y * size.x + id.x) * 4u + id.z] = bitcast<u32>(textureLoad(slope, id.xy, i32(id.z)));
    }";

/// An image of several samples of the application's, and the pipelines that draw to it and read it. Never destroyed.
pub(super) struct Picture<'a> {
    pub(super) vulkan: &'a Vulkan,
    pub(super) kind: SampleKind,
    image: vk::Image,
    /// Framebuffer and reading set of each layer.
    layers: Vec<(vk::Framebuffer, vk::DescriptorSet)>,
    pass: vk::RenderPass,
    /// Of each sample.
    pipelines: Vec<vk::Pipeline>,
    reader: (vk::Pipeline, vk::PipelineLayout),
    found: (vk::Buffer, vk::DeviceMemory),
}

impl<'a> Picture<'a> {
    pub(super) fn new(vulkan: &'a Vulkan, format: vk::Format, is_color: bool) -> Self {
        let kind = SampleKind { format, samples: SAMPLES, is_color };
        let device = &vulkan.device;
        let image = vulkan.image_of(&image_info(kind));
        let code = code();
        let words = (EXTENT[0] * EXTENT[1]) as usize * SAMPLE_COUNT;
        let found = vulkan.buffer_of(words * 4, vk::BufferUsageFlags::STORAGE_BUFFER);
        let pass = render_pass(device, kind);
        // SAFETY: plain use of Vulkan.
        let layout = unsafe { device.create_pipeline_layout(&Default::default(), None) }.unwrap();
        let pipelines =
            (0..SAMPLE_COUNT).map(|sample| pipeline(device, (pass, layout), kind, &code, 1 << sample));
        let pipelines = pipelines.collect();
        let (reader, set_layout) = reader(device, kind, &code);
        let layer = |layer| {
            let view = vulkan.layer_view(image, format, aspects(kind), layer);
            let attachments = [view];
            let info = vk::FramebufferCreateInfo::default()
                .render_pass(pass)
                .attachments(&attachments)
                .width(EXTENT[0])
                .height(EXTENT[1])
                .layers(1);
            // SAFETY: plain use of Vulkan.
            let framebuffer = unsafe { device.create_framebuffer(&info, None) }.unwrap();
            (framebuffer, reading_set(device, set_layout, (view, is_color), found.0))
        };
        let layers = (0..LAYERS).map(layer).collect();
        Self { vulkan, kind, image, layers, pass, pipelines, reader, found }
    }

    pub(super) fn part(&self) -> ImagePart {
        ImagePart { image: self.image, aspects: aspects(self.kind), level: 0, first_layer: 0, layers: LAYERS }
    }

    fn extent(&self) -> vk::Extent2D {
        let [width, height] = EXTENT;
        vk::Extent2D { width, height }
    }

    /// Draws noise to all samples of all layers.
    pub(super) fn draw(&self) {
        let device = &self.vulkan.device;
        let clear = vk::ClearValue { color: vk::ClearColorValue { float32: [0.0; 4] } };
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: self.extent() };
        self.vulkan.run(|commands| {
            for (layer, (framebuffer, _)) in (0..).zip(&self.layers) {
                let clears = [clear];
                let info = vk::RenderPassBeginInfo::default()
                    .render_pass(self.pass)
                    .framebuffer(*framebuffer)
                    .render_area(area)
                    .clear_values(&clears);
                // SAFETY: plain use of Vulkan.
                unsafe {
                    device.cmd_begin_render_pass(commands, &info, vk::SubpassContents::INLINE);
                    for (sample, pipeline) in (0..).zip(&self.pipelines) {
                        device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, *pipeline);
                        device.cmd_draw(commands, 3, 1, 0, SAMPLE_COUNT as u32 * layer + sample);
                    }
                    device.cmd_end_render_pass(commands);
                }
            }
        });
        self.vulkan.idle();
    }

    /// Words of a layer: of each pixel, of each sample.
    pub(super) fn read(&self, layer: u32) -> Vec<u32> {
        let device = &self.vulkan.device;
        let read = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        let (pipeline, layout) = self.reader;
        let compute = vk::PipelineBindPoint::COMPUTE;
        self.vulkan.run(|commands| {
            self.change_layout(commands, [attached(self.kind), read]);
            let sets = [self.layers[layer as usize].1];
            // SAFETY: plain use of Vulkan.
            unsafe {
                device.cmd_bind_pipeline(commands, compute, pipeline);
                device.cmd_bind_descriptor_sets(commands, compute, layout, 0, &sets, &[]);
                device.cmd_dispatch(commands, EXTENT[0], EXTENT[1], SAMPLE_COUNT as u32);
            }
            self.change_layout(commands, [read, attached(self.kind)]);
        });
        self.vulkan.idle();
        let bytes = (EXTENT[0] * EXTENT[1]) as usize * SAMPLE_COUNT * 4;
        let bytes = self.vulkan.read_memory(self.found.1, bytes);
        bytes.as_chunks().0.iter().map(|word| u32::from_ne_bytes(*word)).collect()
    }

    /// A layer of colour, as the device resolves it.
    pub(super) fn resolved(&self, layer: u32) -> Vec<u8> {
        let usage = vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let extent = self.extent();
        let to = self.vulkan.image(vk::ImageCreateFlags::empty(), COLOR, extent, 1, usage);
        let [from, into] = [vk::ImageLayout::TRANSFER_SRC_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL];
        let color = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let of_layer = |base_array_layer| vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            mip_level: 0,
            base_array_layer,
            layer_count: 1,
        };
        let region = vk::ImageResolve::default()
            .src_subresource(of_layer(layer))
            .dst_subresource(of_layer(0))
            .extent(extent.into());
        self.vulkan.run(|commands| {
            self.change_layout(commands, [color, from]);
            // SAFETY: plain use of Vulkan.
            unsafe {
                self.vulkan.transition(commands, to, 1, (color, into));
                self.vulkan.device.cmd_resolve_image(commands, self.image, from, to, into, &[region]);
                self.vulkan.transition(commands, to, 1, (into, color));
            }
            self.change_layout(commands, [from, color]);
        });
        self.vulkan.download(Layer { image: to, layer: 0, extent }, 4)
    }

    /// Brings the image from one layout to another, after and before everything.
    fn change_layout(&self, commands: vk::CommandBuffer, [old, new]: [vk::ImageLayout; 2]) {
        let all = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        let barrier = vk::ImageMemoryBarrier::default()
            .image(self.image)
            .subresource_range(range(self.kind, 0, LAYERS))
            .src_access_mask(all)
            .dst_access_mask(all)
            .old_layout(old)
            .new_layout(new);
        let (stages, none) = (vk::PipelineStageFlags::ALL_COMMANDS, vk::DependencyFlags::empty());
        // SAFETY: plain use of Vulkan.
        unsafe {
            self.vulkan.device.cmd_pipeline_barrier(commands, stages, stages, none, &[], &[], &[barrier]);
        }
    }
}

fn aspects(kind: SampleKind) -> vk::ImageAspectFlags {
    if kind.is_color { vk::ImageAspectFlags::COLOR } else { vk::ImageAspectFlags::DEPTH }
}

/// The layout between everything else.
pub(super) fn attached(kind: SampleKind) -> vk::ImageLayout {
    match kind.is_color {
        true => vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        false => vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    }
}

fn range(kind: SampleKind, base_array_layer: u32, layer_count: u32) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange {
        aspect_mask: aspects(kind),
        base_mip_level: 0,
        level_count: 1,
        base_array_layer,
        layer_count,
    }
}

fn image_info(kind: SampleKind) -> vk::ImageCreateInfo<'static> {
    let attachment = match kind.is_color {
        true => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        false => vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
    };
    let [width, height] = EXTENT;
    vk::ImageCreateInfo::default()
        .image_type(vk::ImageType::TYPE_2D)
        .format(kind.format)
        .extent(vk::Extent3D { width, height, depth: 1 })
        .mip_levels(1)
        .array_layers(LAYERS)
        .samples(kind.samples)
        .usage(attachment | USAGE | vk::ImageUsageFlags::SAMPLED)
}

fn render_pass(device: &ash::Device, kind: SampleKind) -> vk::RenderPass {
    let layout = attached(kind);
    let attachments = [vk::AttachmentDescription::default()
        .format(kind.format)
        .samples(kind.samples)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .initial_layout(vk::ImageLayout::UNDEFINED)
        .final_layout(layout)];
    let reference = [vk::AttachmentReference { attachment: 0, layout }];
    let subpass = match kind.is_color {
        true => vk::SubpassDescription::default().color_attachments(&reference),
        false => vk::SubpassDescription::default().depth_stencil_attachment(&reference[0]),
    };
    let subpasses = [subpass];
    let info = vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses);
    // SAFETY: plain use of Vulkan.
    unsafe { device.create_render_pass(&info, None) }.unwrap()
}

fn code() -> Vec<u32> {
    let module = naga::front::wgsl::parse_str(SHADERS).unwrap();
    let flags = naga::valid::ValidationFlags::all();
    let valid = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty()).validate(&module);
    let options =
        naga::back::spv::Options { flags: naga::back::spv::WriterFlags::empty(), ..Default::default() };
    naga::back::spv::write_vec(&module, &valid.unwrap(), &options, None).unwrap()
}

/// Pipeline that draws to the samples of a mask.
fn pipeline(
    device: &ash::Device,
    (pass, layout): (vk::RenderPass, vk::PipelineLayout),
    kind: SampleKind,
    code: &[u32],
    samples: u32,
) -> vk::Pipeline {
    let info = vk::ShaderModuleCreateInfo::default().code(code);
    // SAFETY: plain use of Vulkan.
    let module = unsafe { device.create_shader_module(&info, None) }.unwrap();
    let stage =
        |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(name);
    let fragment = if kind.is_color { c"color" } else { c"depth" };
    let stages =
        [stage(vk::ShaderStageFlags::VERTEX, c"vertex"), stage(vk::ShaderStageFlags::FRAGMENT, fragment)];
    let input = vk::PipelineVertexInputStateCreateInfo::default();
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let [width, height] = EXTENT;
    let viewports =
        [vk::Viewport { width: width as f32, height: height as f32, max_depth: 1.0, ..Default::default() }];
    let scissors = [vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() }];
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissors(&scissors);
    let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
    let mask = [samples];
    let multisample = vk::PipelineMultisampleStateCreateInfo::default()
        .rasterization_samples(kind.samples)
        .sample_mask(&mask);
    let tests = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::ALWAYS);
    let attachments =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let colors = if kind.is_color { &attachments[..] } else { &[] };
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(colors);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&raster)
        .multisample_state(&multisample)
        .depth_stencil_state(&tests)
        .color_blend_state(&blend)
        .layout(layout)
        .render_pass(pass);
    // SAFETY: plain use of Vulkan.
    unsafe { device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) }.unwrap()[0]
}

/// Pipeline that reads all samples of a layer, with its layout, and the layout of its set.
fn reader(
    device: &ash::Device,
    kind: SampleKind,
    code: &[u32],
) -> ((vk::Pipeline, vk::PipelineLayout), vk::DescriptorSetLayout) {
    let binding = |(number, ty)| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(number)
            .descriptor_type(ty)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
    };
    let bindings = [
        (0, vk::DescriptorType::SAMPLED_IMAGE),
        (1, vk::DescriptorType::SAMPLED_IMAGE),
        (2, vk::DescriptorType::STORAGE_BUFFER),
    ]
    .map(binding);
    // SAFETY: plain use of Vulkan.
    unsafe {
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        let sets = [device.create_descriptor_set_layout(&info, None).unwrap()];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        let layout = device.create_pipeline_layout(&info, None).unwrap();
        let info = vk::ShaderModuleCreateInfo::default().code(code);
        let module = device.create_shader_module(&info, None).unwrap();
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(if kind.is_color { c"read_color" } else { c"read_depth" });
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
        let pipelines = device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None).unwrap();
        ((pipelines[0], layout), sets[0])
    }
}

fn reading_set(
    device: &ash::Device,
    layout: vk::DescriptorSetLayout,
    (view, is_color): (vk::ImageView, bool),
    found: vk::Buffer,
) -> vk::DescriptorSet {
    let size = |ty, descriptor_count| vk::DescriptorPoolSize { ty, descriptor_count };
    let sizes = [size(vk::DescriptorType::SAMPLED_IMAGE, 2), size(vk::DescriptorType::STORAGE_BUFFER, 1)];
    let layouts = [layout];
    // SAFETY: plain use of Vulkan.
    unsafe {
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        let pool = device.create_descriptor_pool(&info, None).unwrap();
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        let set = device.allocate_descriptor_sets(&info).unwrap()[0];
        let images = [vk::DescriptorImageInfo {
            sampler: vk::Sampler::null(),
            image_view: view,
            image_layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        }];
        let buffers = [vk::DescriptorBufferInfo { buffer: found, offset: 0, range: vk::WHOLE_SIZE }];
        let image = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(if is_color { 0 } else { 1 })
            .descriptor_type(vk::DescriptorType::SAMPLED_IMAGE)
            .image_info(&images);
        let buffer = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(2)
            .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
            .buffer_info(&buffers);
        device.update_descriptor_sets(&[image, buffer], &[]);
        set
    }
}
