//! Compute pipelines over one descriptor set: a storage buffer at binding 0, storage images at the following ones.

use super::pipeline::shader_module;
use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// Bindings of the set: the buffer, and two images of which each pipeline uses one.
const BINDINGS: [vk::DescriptorType; 3] = [
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_IMAGE,
    vk::DescriptorType::STORAGE_IMAGE,
];

/// Layouts that the pipelines and sets of a pass share.
pub(crate) struct ComputeLayout {
    pipeline: Owned<vk::PipelineLayout>,
    set: Owned<vk::DescriptorSetLayout>,
}

impl ComputeLayout {
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let bindings: [_; 3] = std::array::from_fn(|binding| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding as u32)
                .descriptor_type(BINDINGS[binding])
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        });
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is live.
        let set = unsafe {
            let handle = gpu
                .device
                .create_descriptor_set_layout(&info, None)
                .map_err(GpuError::from_call("vkCreateDescriptorSetLayout"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_descriptor_set_layout(handle, None))
        };
        let sets = [set.handle()];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: device and set layout are live.
        let pipeline = unsafe {
            let handle = gpu
                .device
                .create_pipeline_layout(&info, None)
                .map_err(GpuError::from_call("vkCreatePipelineLayout"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_pipeline_layout(handle, None))
        };
        Ok(Self { pipeline, set })
    }

    /// Makes the pipeline of an entry point of a module of SPIR-V.
    pub(crate) fn pipeline(&self, spirv: &[u8], entry: &CStr) -> Result<Owned<vk::Pipeline>, GpuError> {
        let gpu = self.pipeline.gpu();
        let module = shader_module(gpu, spirv)?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module.handle())
            .name(entry);
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.pipeline.handle());
        // SAFETY: everything named is live; the build has validated the module and the entry points' interface.
        unsafe {
            let handles = gpu
                .device
                .create_compute_pipelines(vk::PipelineCache::null(), &[info], None)
                .map_err(|(_, result)| GpuError::Call { call: "vkCreateComputePipelines", result })?;
            Ok(Owned::new(gpu, handles[0], |device, handle| device.destroy_pipeline(handle, None)))
        }
    }

    pub(super) fn handle(&self) -> vk::PipelineLayout {
        self.pipeline.handle()
    }
}

/// One descriptor set, with the pool that it is alone in.
pub(crate) struct ComputeSet {
    _pool: Owned<vk::DescriptorPool>,
    handle: vk::DescriptorSet,
}

impl ComputeSet {
    /// Over a storage buffer, and a storage image in GENERAL at one of bindings 1 and 2. Both outlive the result.
    pub(crate) fn new(
        layout: &ComputeLayout,
        buffer: vk::Buffer,
        (binding, view): (u32, vk::ImageView),
    ) -> Result<Self, GpuError> {
        let gpu = layout.set.gpu();
        let sizes = BINDINGS.map(|ty| vk::DescriptorPoolSize { ty, descriptor_count: 1 });
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: the device is live.
        let pool = unsafe {
            let handle = gpu
                .device
                .create_descriptor_pool(&info, None)
                .map_err(GpuError::from_call("vkCreateDescriptorPool"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_descriptor_pool(handle, None))
        };
        let layouts = [layout.set.handle()];
        let info =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool.handle()).set_layouts(&layouts);
        // SAFETY: pool and layout are live ones of this device.
        let handle = unsafe { gpu.device.allocate_descriptor_sets(&info) }
            .map_err(GpuError::from_call("vkAllocateDescriptorSets"))?[0];
        let buffers = [vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE }];
        let images = [vk::DescriptorImageInfo {
            sampler: vk::Sampler::null(),
            image_view: view,
            image_layout: vk::ImageLayout::GENERAL,
        }];
        let write = |binding: u32| {
            let ty = BINDINGS[binding as usize];
            vk::WriteDescriptorSet::default().dst_set(handle).dst_binding(binding).descriptor_type(ty)
        };
        let writes = [write(0).buffer_info(&buffers), write(binding).image_info(&images)];
        // SAFETY: set, buffer and view are live, and the set is not in use.
        unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
        Ok(Self { _pool: pool, handle })
    }

    pub(super) fn handle(&self) -> vk::DescriptorSet {
        self.handle
    }
}
