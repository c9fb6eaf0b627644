//! Writes the map by a dispatch.

use super::setup::Setup;
use ash::vk;

/// A fragment of 2x2 and one of 1x1, in turn.
pub const TEXELS: [u8; 2] = [0b0101, 0];

const SHADER: &str = "
    @group(0) @binding(0) var map: texture_storage_2d_array<r8uint, write>;
    @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) at: vec3u) {
        textureStore(map, at.xy, at.z, vec4u(select(0u, 5u, at.x % 2u == 0u)));
    }";

pub struct Writer<'a> {
    setup: &'a Setup,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
}

impl<'a> Writer<'a> {
    pub fn new(setup: &'a Setup, view: vk::ImageView) -> Self {
        let vk = &setup.vk;
        let module = naga::front::wgsl::parse_str(SHADER).unwrap();
        let mut validator = naga::valid::Validator::new(Default::default(), naga::valid::Capabilities::all());
        let valid = validator.validate(&module).unwrap();
        let code = naga::back::spv::write_vec(&module, &valid, &Default::default(), None).unwrap();
        let bindings = [vk::DescriptorSetLayoutBinding::default()
            .descriptor_type(vk::DescriptorType::STORAGE_IMAGE)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE)];
        let sizes =
            [vk::DescriptorPoolSize::default().ty(vk::DescriptorType::STORAGE_IMAGE).descriptor_count(1)];
        // SAFETY: plain use of Vulkan.
        unsafe {
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let set_layout = vk.create_descriptor_set_layout(&info, None).unwrap();
            let set_layouts = [set_layout];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts);
            let layout = vk.create_pipeline_layout(&info, None).unwrap();
            let shader = vk::ShaderModuleCreateInfo::default().code(&code);
            let shader = vk.create_shader_module(&shader, None).unwrap();
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(shader)
                .name(c"main");
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
            let pipeline = vk.create_compute_pipelines(vk::PipelineCache::null(), &[info], None).unwrap()[0];
            vk.destroy_shader_module(shader, None);
            let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
            let pool = vk.create_descriptor_pool(&info, None).unwrap();
            let info =
                vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&set_layouts);
            let set = vk.allocate_descriptor_sets(&info).unwrap()[0];
            let images =
                [vk::DescriptorImageInfo::default().image_view(view).image_layout(vk::ImageLayout::GENERAL)];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .descriptor_type(vk::DescriptorType::STORAGE_IMAGE)
                .image_info(&images);
            vk.update_descriptor_sets(&[write], &[]);
            Self { setup, set_layout, layout, pipeline, pool, set }
        }
    }

    /// Records the write.
    pub fn write(&self, buffer: vk::CommandBuffer) {
        let vk = &self.setup.vk;
        let ([width, height], [_, layers]) = (self.setup.texels(), self.setup.layers());
        let point = vk::PipelineBindPoint::COMPUTE;
        // SAFETY: plain use of Vulkan.
        unsafe {
            vk.cmd_bind_pipeline(buffer, point, self.pipeline);
            vk.cmd_bind_descriptor_sets(buffer, point, self.layout, 0, &[self.set], &[]);
            vk.cmd_dispatch(buffer, width, height, layers);
        }
    }
}

impl Drop for Writer<'_> {
    fn drop(&mut self) {
        let vk = &self.setup.vk;
        // SAFETY: the program waited before.
        unsafe {
            vk.destroy_descriptor_pool(self.pool, None);
            vk.destroy_pipeline(self.pipeline, None);
            vk.destroy_pipeline_layout(self.layout, None);
            vk.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}
