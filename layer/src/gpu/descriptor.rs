//! What shaders are bound to: set 0 is the uniform of a region, at a dynamic offset; set 1 is one texture.

use super::{Gpu, GpuError, Owned, UniformRing};
use ash::vk;
use std::sync::Arc;

/// Layout of a set with one binding. Layouts made alike are compatible, so nobody needs to share them.
fn layout(
    gpu: &Arc<Gpu>,
    kind: vk::DescriptorType,
    stages: vk::ShaderStageFlags,
) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    let binding = [vk::DescriptorSetLayoutBinding::default()
        .binding(0)
        .descriptor_type(kind)
        .descriptor_count(1)
        .stage_flags(stages)];
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&binding);
    // SAFETY: the device is live.
    unsafe {
        let handle = gpu
            .device
            .create_descriptor_set_layout(&info, None)
            .map_err(GpuError::from_call("vkCreateDescriptorSetLayout"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_descriptor_set_layout(handle, None)))
    }
}

/// Layout of set 0.
pub(super) fn uniform_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
    layout(gpu, vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC, stages)
}

/// Layout of set 1.
pub(super) fn texture_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    layout(gpu, vk::DescriptorType::SAMPLED_IMAGE, vk::ShaderStageFlags::FRAGMENT)
}

/// Sets of one layout, with the pool that they go with, and the layout, which writing to them needs.
struct Sets {
    _pool: Owned<vk::DescriptorPool>,
    _layout: Owned<vk::DescriptorSetLayout>,
    handles: Vec<vk::DescriptorSet>,
}

fn allocate(
    gpu: &Arc<Gpu>,
    kind: vk::DescriptorType,
    layout: Owned<vk::DescriptorSetLayout>,
    count: u32,
) -> Result<Sets, GpuError> {
    let sizes = [vk::DescriptorPoolSize { ty: kind, descriptor_count: count }];
    let info = vk::DescriptorPoolCreateInfo::default().max_sets(count).pool_sizes(&sizes);
    // SAFETY: the device is live.
    let pool = unsafe {
        let handle = gpu
            .device
            .create_descriptor_pool(&info, None)
            .map_err(GpuError::from_call("vkCreateDescriptorPool"))?;
        Owned::new(gpu, handle, |device, handle| device.destroy_descriptor_pool(handle, None))
    };
    let layouts = vec![layout.handle(); count as usize];
    let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool.handle()).set_layouts(&layouts);
    // SAFETY: pool and layout are live ones of this device.
    let handles = unsafe { gpu.device.allocate_descriptor_sets(&info) }
        .map_err(GpuError::from_call("vkAllocateDescriptorSets"))?;
    Ok(Sets { _pool: pool, _layout: layout, handles })
}

/// Set 0 over a ring of uniforms.
pub(crate) struct UniformSet {
    sets: Sets,
}

impl UniformSet {
    pub(crate) fn new<T: bytemuck::Pod>(ring: &UniformRing<T>) -> Result<Self, GpuError> {
        let gpu = ring.gpu();
        let kind = vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC;
        let sets = allocate(gpu, kind, uniform_layout(gpu)?, 1)?;
        let buffer =
            [vk::DescriptorBufferInfo { buffer: ring.handle(), offset: 0, range: size_of::<T>() as u64 }];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(sets.handles[0])
            .dst_binding(0)
            .descriptor_type(kind)
            .buffer_info(&buffer);
        // SAFETY: set and buffer are live, and the set is not in use.
        unsafe { gpu.device.update_descriptor_sets(&[write], &[]) };
        Ok(Self { sets })
    }

    pub(super) fn handle(&self) -> vk::DescriptorSet {
        self.sets.handles[0]
    }
}

/// Set 1, one for each of several textures.
pub(crate) struct TextureSets {
    sets: Sets,
}

impl TextureSets {
    /// For views that are in SHADER_READ_ONLY_OPTIMAL when they are read, and outlive the result.
    pub(crate) fn new(gpu: &Arc<Gpu>, views: &[Owned<vk::ImageView>]) -> Result<Self, GpuError> {
        let kind = vk::DescriptorType::SAMPLED_IMAGE;
        let sets = allocate(gpu, kind, texture_layout(gpu)?, views.len() as u32)?;
        for (&set, view) in sets.handles.iter().zip(views) {
            let image = [vk::DescriptorImageInfo {
                sampler: vk::Sampler::null(),
                image_view: view.handle(),
                image_layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
            }];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(0)
                .descriptor_type(kind)
                .image_info(&image);
            // SAFETY: set and view are live, and the set is not in use.
            unsafe { gpu.device.update_descriptor_sets(&[write], &[]) };
        }
        Ok(Self { sets })
    }

    /// The set of the view at `index`.
    pub(crate) fn get(&self, index: usize) -> Option<vk::DescriptorSet> {
        self.sets.handles.get(index).copied()
    }
}
