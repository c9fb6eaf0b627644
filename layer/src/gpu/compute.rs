//! Compute pipelines over one descriptor set, whose bindings a pass lists; such sets for pipelines that draw, too.

use super::pipeline::shader_module;
use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;

/// Layouts that the pipelines and sets of a pass share.
pub(crate) struct ComputeLayout {
    pipeline: Owned<vk::PipelineLayout>,
    set: Owned<vk::DescriptorSetLayout>,
    kinds: &'static [vk::DescriptorType],
}

impl ComputeLayout {
    /// With one descriptor of each of `kinds`, from binding 0 on.
    pub(crate) fn new(gpu: &Arc<Gpu>, kinds: &'static [vk::DescriptorType]) -> Result<Self, GpuError> {
        Self::for_stage(gpu, kinds, vk::ShaderStageFlags::COMPUTE)
    }

    /// As [`Self::new`], for a stage of pipelines that draw.
    pub(crate) fn for_stage(
        gpu: &Arc<Gpu>,
        kinds: &'static [vk::DescriptorType],
        stage: vk::ShaderStageFlags,
    ) -> Result<Self, GpuError> {
        let binding = |(binding, kind): (u32, &vk::DescriptorType)| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(*kind)
                .descriptor_count(1)
                .stage_flags(stage)
        };
        let bindings: Vec<_> = (0..).zip(kinds).map(binding).collect();
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
        Ok(Self { pipeline, set, kinds })
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
        let cache = gpu.pipeline_cache()?;
        // SAFETY: everything named is live; the build has validated the module and the entry points' interface.
        unsafe {
            let handles = gpu
                .device
                .create_compute_pipelines(cache, &[info], None)
                .map_err(|(_, result)| GpuError::Call { call: "vkCreateComputePipelines", result })?;
            Ok(Owned::new(gpu, handles[0], |device, handle| device.destroy_pipeline(handle, None)))
        }
    }

    pub(super) fn handle(&self) -> vk::PipelineLayout {
        self.pipeline.handle()
    }

    pub(super) fn set_layout(&self) -> vk::DescriptorSetLayout {
        self.set.handle()
    }
}

/// The object behind a binding; it outlives the set.
#[derive(Clone, Copy)]
pub(crate) enum Bound {
    /// The whole of a buffer.
    Buffer(vk::Buffer),
    /// A storage image in GENERAL, or a sampled one in SHADER_READ_ONLY_OPTIMAL.
    Image(vk::ImageView),
}

/// One descriptor set, with the pool that it is alone in.
pub(crate) struct ComputeSet {
    _pool: Owned<vk::DescriptorPool>,
    handle: vk::DescriptorSet,
}

impl ComputeSet {
    /// Over the listed objects, each with its binding. Bindings that the pipeline does not use may be left out.
    pub(crate) fn new(layout: &ComputeLayout, bound: &[(u32, Bound)]) -> Result<Self, GpuError> {
        let gpu = layout.set.gpu();
        let sizes: Vec<_> =
            layout.kinds.iter().map(|ty| vk::DescriptorPoolSize { ty: *ty, descriptor_count: 1 }).collect();
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
        for (binding, bound) in bound {
            let kind = *layout
                .kinds
                .get(*binding as usize)
                .ok_or(GpuError::Invalid("a binding that is missing from the layout"))?;
            let write =
                vk::WriteDescriptorSet::default().dst_set(handle).dst_binding(*binding).descriptor_type(kind);
            match *bound {
                Bound::Buffer(buffer) => {
                    let buffers = [vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE }];
                    // SAFETY: set and buffer are live, and the set is not in use.
                    unsafe { gpu.device.update_descriptor_sets(&[write.buffer_info(&buffers)], &[]) };
                }
                Bound::Image(image_view) => {
                    let image_layout = match kind {
                        vk::DescriptorType::SAMPLED_IMAGE => vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
                        _ => vk::ImageLayout::GENERAL,
                    };
                    let sampler = vk::Sampler::null();
                    let images = [vk::DescriptorImageInfo { sampler, image_view, image_layout }];
                    // SAFETY: set and view are live, and the set is not in use.
                    unsafe { gpu.device.update_descriptor_sets(&[write.image_info(&images)], &[]) };
                }
            }
        }
        Ok(Self { _pool: pool, handle })
    }

    /// Over the whole of each buffer, from binding 0 on.
    pub(crate) fn of_buffers(layout: &ComputeLayout, buffers: &[vk::Buffer]) -> Result<Self, GpuError> {
        let bound: Vec<_> =
            (0..).zip(buffers).map(|(binding, buffer)| (binding, Bound::Buffer(*buffer))).collect();
        Self::new(layout, &bound)
    }

    pub(super) fn handle(&self) -> vk::DescriptorSet {
        self.handle
    }
}
