//! A pass that copies a picture, texel by texel, with a compute shader.

use crate::vulkan::Vulkan;
use ash::vk;
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

const SHADER: &str = include_str!("copy.wgsl");

/// Texels of a workgroup, one beside the other. The shader has the same number.
const THREADS: u32 = 64;

/// The pass, over one picture. Never destroyed: the process ends soon.
pub struct Copy {
    pipeline: vk::Pipeline,
    layout: vk::PipelineLayout,
    set: vk::DescriptorSet,
    groups: [u32; 2],
    image: vk::Image,
}

const READ: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
const DRAWN: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;

impl Copy {
    pub fn new(vulkan: &Vulkan, image: vk::Image, format: vk::Format, extent: vk::Extent2D) -> Self {
        let kinds = [vk::DescriptorType::SAMPLED_IMAGE, vk::DescriptorType::STORAGE_BUFFER];
        let binding = |(binding, kind): (u32, &vk::DescriptorType)| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(*kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        };
        let bindings: Vec<_> = (0..).zip(&kinds).map(binding).collect();
        let vk::Extent2D { width, height } = extent;
        let bytes = width as usize * height as usize * size_of::<[f32; 4]>();
        let (buffer, _) = vulkan.buffer_of(bytes, vk::BufferUsageFlags::STORAGE_BUFFER);
        let image_view =
            vulkan.view(image, format, vk::ImageAspectFlags::COLOR, vk::ImageUsageFlags::SAMPLED);
        let spirv = spirv();
        let device = &vulkan.device;
        // SAFETY: plain use of Vulkan with live handles; the shader's bindings are the layout's.
        unsafe {
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let set_layouts = [device.create_descriptor_set_layout(&info, None).unwrap()];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts);
            let layout = device.create_pipeline_layout(&info, None).unwrap();
            let info = vk::ShaderModuleCreateInfo::default().code(&spirv);
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(device.create_shader_module(&info, None).unwrap())
                .name(c"copy");
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
            let none = vk::PipelineCache::null();
            let pipeline = device.create_compute_pipelines(none, &[info], None).unwrap()[0];
            let sizes = kinds.map(|ty| vk::DescriptorPoolSize { ty, descriptor_count: 1 });
            let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
            let pool = device.create_descriptor_pool(&info, None).unwrap();
            let info =
                vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&set_layouts);
            let set = device.allocate_descriptor_sets(&info).unwrap()[0];
            let image_layout = READ;
            let images = [vk::DescriptorImageInfo { sampler: vk::Sampler::null(), image_view, image_layout }];
            let buffers = [vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE }];
            let write = |binding: usize| {
                let write = vk::WriteDescriptorSet::default().dst_set(set).dst_binding(binding as u32);
                write.descriptor_type(kinds[binding])
            };
            let writes = [write(0).image_info(&images), write(1).buffer_info(&buffers)];
            device.update_descriptor_sets(&writes, &[]);
            Self { pipeline, layout, set, groups: [width.div_ceil(THREADS), height], image }
        }
    }

    /// Records the copy; the picture is in COLOR_ATTACHMENT_OPTIMAL.
    pub fn record(&self, vulkan: &Vulkan, commands: vk::CommandBuffer) {
        let (device, point) = (&vulkan.device, vk::PipelineBindPoint::COMPUTE);
        let [columns, rows] = self.groups;
        // SAFETY: the command buffer is being recorded, and everything is live.
        unsafe {
            vulkan.transition(commands, self.image, 1, (DRAWN, READ));
            device.cmd_bind_pipeline(commands, point, self.pipeline);
            device.cmd_bind_descriptor_sets(commands, point, self.layout, 0, &[self.set], &[]);
            device.cmd_dispatch(commands, columns, rows, 1);
            vulkan.transition(commands, self.image, 1, (READ, DRAWN));
        }
    }
}

fn spirv() -> Vec<u32> {
    let module = naga::front::wgsl::parse_str(SHADER).unwrap();
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
    let options =
        spv::Options { lang_version: (1, 3), flags: spv::WriterFlags::empty(), ..spv::Options::default() };
    spv::write_vec(&module, &info, &options, None).unwrap()
}
