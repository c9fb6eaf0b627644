//! An application that draws full-screen layers, the farthest first, each of which passes its depth test.

use crate::transfer::Layer;
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::backend::mask::{EarlyReturn, returning_early};
use parafovea::gpu::ImagePart;
use parafovea::kernels::fill::USAGE;

/// Full-screen layers in a frame.
pub const LAYERS_DRAWN: u32 = 3;

/// Format of the picture.
pub const COLOR: vk::Format = vk::Format::R8G8B8A8_SRGB;
const DEPTH_LAYOUT: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;

/// Counts shaded fragments: with early tests, only fragments that have passed them.
const SHADERS: &str = "
    @group(0) @binding(0) var<storage, read_write> count: atomic<u32>;

    @vertex fn vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) layer: u32) -> @builtin(position) vec4f {
        let z = select(0.75 - 0.25 * f32(layer), 0.25 + 0.25 * f32(layer), REVERSED);
        return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, z, 1.0);
    }

    @fragment @early_depth_test(force) fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
        atomicAdd(&count, 1u);
        let wave = sin(at.xy * vec2f(0.31, 0.17) + at.yx * 0.05) * 0.5 + 0.5;
        return vec4f(wave, at.z, select(0.2, 0.9, (u32(at.x) / 9u + u32(at.y) / 7u) % 2u == 0u));
    }";

/// The drawn geometry, and its depth.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    pub depth: vk::Format,
    pub compare: vk::CompareOp,
    pub clear: f32,
    pub area: vk::Rect2D,
}

/// Everything that one frame needs. Never destroyed.
pub struct Application {
    pub color: vk::Image,
    depth: vk::Image,
    pub setup: Setup,
    extent: vk::Extent2D,
    /// Clearing, and loading depth.
    passes: [vk::RenderPass; 2],
    framebuffer: vk::Framebuffer,
    pipeline: vk::Pipeline,
    layout: vk::PipelineLayout,
    sets: Vec<vk::DescriptorSet>,
    counter: (vk::Buffer, vk::DeviceMemory),
}

impl Application {
    pub fn new(vulkan: &Vulkan, setup: Setup, extent: [u32; 2]) -> Self {
        Self::of_version(vulkan, setup, extent, (1, 0), None)
    }

    /// With shaders of that version of SPIR-V, which return early by a template and its parameters, if there are.
    pub fn of_version(
        vulkan: &Vulkan,
        setup: Setup,
        [width, height]: [u32; 2],
        version: (u8, u8),
        early: Option<[vk::Buffer; 2]>,
    ) -> Self {
        let extent = vk::Extent2D { width, height };
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | USAGE;
        let color = vulkan.image(vk::ImageCreateFlags::empty(), COLOR, extent, 1, usage);
        let depth = vulkan.depth_image(setup.depth, extent, vk::ImageUsageFlags::empty());
        let aspects = aspects(setup.depth);
        let views = [
            vulkan.view(color, COLOR, vk::ImageAspectFlags::COLOR, vk::ImageUsageFlags::COLOR_ATTACHMENT),
            vulkan.view(depth, setup.depth, aspects, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT),
        ];
        let device = &vulkan.device;
        let passes = [false, true].map(|loads| render_pass(device, setup.depth, loads));
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(passes[0])
            .attachments(&views)
            .width(width)
            .height(height)
            .layers(1);
        // SAFETY: plain use of Vulkan.
        let framebuffer = unsafe { device.create_framebuffer(&info, None) }.unwrap();
        let counter = vulkan.buffer_of(16, vk::BufferUsageFlags::STORAGE_BUFFER);
        let (storage, uniform) = (vk::DescriptorType::STORAGE_BUFFER, vk::DescriptorType::UNIFORM_BUFFER);
        let mut sets = vec![buffer_set(device, &[(storage, counter.0)])];
        sets.extend(early.map(|[words, params]| buffer_set(device, &[(storage, words), (uniform, params)])));
        let layouts: Vec<_> = sets.iter().map(|(layout, _)| *layout).collect();
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
        // SAFETY: as above.
        let layout = unsafe { device.create_pipeline_layout(&info, None) }.unwrap();
        let code = code(setup, version, early.is_some());
        let pipeline = pipeline(device, layout, passes[0], setup, &code);
        let sets = sets.into_iter().map(|(_, set)| set).collect();
        Self { color, depth, setup, extent, passes, framebuffer, pipeline, layout, sets, counter }
    }

    pub fn color_part(&self) -> ImagePart {
        let aspects = vk::ImageAspectFlags::COLOR;
        ImagePart { image: self.color, aspects, level: 0, first_layer: 0, layers: 1 }
    }

    pub fn depth_part(&self) -> ImagePart {
        ImagePart {
            image: self.depth,
            aspects: aspects(self.setup.depth),
            level: 0,
            first_layer: 0,
            layers: 1,
        }
    }

    /// As the pass that clears expects it, and as the one that loads does.
    pub fn depth_layouts(&self) -> [vk::ImageLayout; 2] {
        [vk::ImageLayout::UNDEFINED, DEPTH_LAYOUT]
    }

    /// Records by `record`, which gets a function that draws into a command buffer, with depth loaded or not. Returns the picture and the
    /// number of shaded fragments.
    pub fn frame(
        &self,
        vulkan: &Vulkan,
        record: impl Fn(vk::CommandBuffer, &dyn Fn(vk::CommandBuffer, bool)),
    ) -> (Vec<u8>, u32) {
        let [width, height] = [self.extent.width, self.extent.height];
        let layer = Layer { image: self.color, layer: 0, extent: self.extent };
        vulkan.upload(layer, &vec![0; (width * height * 4) as usize]);
        vulkan.idle();
        vulkan.write_memory(self.counter.1, &[0; 16]);
        vulkan
            .run(|commands| record(commands, &|commands, loads| self.draw(&vulkan.device, commands, loads)));
        let picture = vulkan.download(layer, 4);
        let counted = vulkan.read_memory(self.counter.1, 4);
        (picture, u32::from_ne_bytes([counted[0], counted[1], counted[2], counted[3]]))
    }

    fn draw(&self, device: &ash::Device, commands: vk::CommandBuffer, loads: bool) {
        let clear = [
            vk::ClearValue { color: vk::ClearColorValue { float32: [0.0, 0.5, 0.0, 1.0] } },
            vk::ClearValue {
                depth_stencil: vk::ClearDepthStencilValue { depth: self.setup.clear, stencil: 0 },
            },
        ];
        let info = vk::RenderPassBeginInfo::default()
            .render_pass(self.passes[usize::from(loads)])
            .framebuffer(self.framebuffer)
            .render_area(self.setup.area)
            .clear_values(&clear);
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: plain use of Vulkan.
        unsafe {
            device.cmd_begin_render_pass(commands, &info, vk::SubpassContents::INLINE);
            device.cmd_bind_pipeline(commands, graphics, self.pipeline);
            device.cmd_bind_descriptor_sets(commands, graphics, self.layout, 0, &self.sets, &[]);
            let [width, height] = [self.extent.width as f32, self.extent.height as f32];
            let viewport = vk::Viewport { x: 0.0, y: 0.0, width, height, min_depth: 0.0, max_depth: 1.0 };
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[self.setup.area]);
            device.cmd_draw(commands, 3, LAYERS_DRAWN, 0, 0);
            device.cmd_end_render_pass(commands);
        }
    }
}

fn aspects(format: vk::Format) -> vk::ImageAspectFlags {
    match format {
        vk::Format::D24_UNORM_S8_UINT | vk::Format::D32_SFLOAT_S8_UINT => {
            vk::ImageAspectFlags::DEPTH | vk::ImageAspectFlags::STENCIL
        }
        _ => vk::ImageAspectFlags::DEPTH,
    }
}

fn render_pass(device: &ash::Device, depth: vk::Format, loads: bool) -> vk::RenderPass {
    let color_layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let (load, initial) = if loads {
        (vk::AttachmentLoadOp::LOAD, DEPTH_LAYOUT)
    } else {
        (vk::AttachmentLoadOp::CLEAR, vk::ImageLayout::UNDEFINED)
    };
    let attachments = [
        vk::AttachmentDescription::default()
            .format(COLOR)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .initial_layout(color_layout)
            .final_layout(color_layout),
        vk::AttachmentDescription::default()
            .format(depth)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(load)
            .store_op(vk::AttachmentStoreOp::DONT_CARE)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .initial_layout(initial)
            .final_layout(DEPTH_LAYOUT),
    ];
    let color = [vk::AttachmentReference { attachment: 0, layout: color_layout }];
    let depth = vk::AttachmentReference { attachment: 1, layout: DEPTH_LAYOUT };
    let subpasses =
        [vk::SubpassDescription::default().color_attachments(&color).depth_stencil_attachment(&depth)];
    // As applications order their frames: depth is used by the frame before.
    let stages = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let writes = vk::AccessFlags::COLOR_ATTACHMENT_WRITE | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let reads = vk::AccessFlags::COLOR_ATTACHMENT_READ | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ;
    let dependencies = [vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .dst_subpass(0)
        .src_stage_mask(stages)
        .dst_stage_mask(stages)
        .src_access_mask(writes)
        .dst_access_mask(reads | writes)];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: plain use of Vulkan.
    unsafe { device.create_render_pass(&info, None) }.unwrap()
}

fn buffer_set(
    device: &ash::Device,
    buffers: &[(vk::DescriptorType, vk::Buffer)],
) -> (vk::DescriptorSetLayout, vk::DescriptorSet) {
    let binding = |(number, (ty, _)): (u32, &(vk::DescriptorType, vk::Buffer))| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(number)
            .descriptor_type(*ty)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::FRAGMENT)
    };
    let bindings: Vec<_> = (0..).zip(buffers).map(binding).collect();
    let size =
        |(ty, _): &(vk::DescriptorType, vk::Buffer)| vk::DescriptorPoolSize { ty: *ty, descriptor_count: 1 };
    let sizes: Vec<_> = buffers.iter().map(size).collect();
    // SAFETY: plain use of Vulkan.
    unsafe {
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        let layouts = [device.create_descriptor_set_layout(&info, None).unwrap()];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        let pool = device.create_descriptor_pool(&info, None).unwrap();
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        let set = device.allocate_descriptor_sets(&info).unwrap()[0];
        for (number, &(ty, buffer)) in (0..).zip(buffers) {
            let buffers = [vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE }];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(number)
                .descriptor_type(ty)
                .buffer_info(&buffers);
            device.update_descriptor_sets(&[write], &[]);
        }
        (layouts[0], set)
    }
}

/// The vertex shader's module, and the fragment shader's.
fn code(setup: Setup, version: (u8, u8), returns_early: bool) -> [Vec<u32>; 2] {
    let source = SHADERS.replace("REVERSED", if setup.clear == 0.0 { "true" } else { "false" });
    let module = naga::front::wgsl::parse_str(&source).unwrap();
    let flags = naga::valid::ValidationFlags::all();
    let capabilities = naga::valid::Capabilities::EARLY_DEPTH_TEST;
    let valid = naga::valid::Validator::new(flags, capabilities).validate(&module).unwrap();
    let options = naga::back::spv::Options {
        lang_version: version,
        flags: naga::back::spv::WriterFlags::empty(),
        ..Default::default()
    };
    let code = naga::back::spv::write_vec(&module, &valid, &options, None).unwrap();
    let wanted = EarlyReturn { entry: "fragment", set: 1, by_view: false, has_whole_subgroups: false };
    let fragment = if returns_early { returning_early(&code, wanted).unwrap() } else { code.clone() };
    [code, fragment]
}

fn pipeline(
    device: &ash::Device,
    layout: vk::PipelineLayout,
    pass: vk::RenderPass,
    setup: Setup,
    [vertex, fragment]: &[Vec<u32>; 2],
) -> vk::Pipeline {
    let stage = |code: &[u32], stage, name| {
        let info = vk::ShaderModuleCreateInfo::default().code(code);
        // SAFETY: plain use of Vulkan.
        let module = unsafe { device.create_shader_module(&info, None) }.unwrap();
        vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(name)
    };
    let stages = [
        stage(vertex, vk::ShaderStageFlags::VERTEX, c"vertex"),
        stage(fragment, vk::ShaderStageFlags::FRAGMENT, c"fragment"),
    ];
    let input = vk::PipelineVertexInputStateCreateInfo::default();
    let assembly =
        vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
    let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
    let samples =
        vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let tests = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(setup.compare);
    let attachments =
        [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&attachments);
    let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&raster)
        .multisample_state(&samples)
        .depth_stencil_state(&tests)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(pass);
    // SAFETY: plain use of Vulkan.
    unsafe { device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) }.unwrap()[0]
}
