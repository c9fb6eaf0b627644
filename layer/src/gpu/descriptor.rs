//! Descriptor sets of shaders: set 0 is the parameters of a region, at dynamic offsets; set 1 is one texture, with its sampler.

use super::buffer::{ResultRing, WordRing};
use super::{Gpu, GpuError, Owned, UniformRing};
use ash::vk;
use std::sync::Arc;

/// Set 0 of draws that read nothing else: a uniform.
const UNIFORM: [vk::DescriptorType; 1] = [vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC];

/// Set 0 of draws of listed tiles: two uniforms, and a buffer of words.
const LISTS: [vk::DescriptorType; 3] = [
    vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC,
    vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC,
    vk::DescriptorType::STORAGE_BUFFER,
];

/// Set 0 of comparisons: parameters, a buffer of words, and one of results.
const COMPARES: [vk::DescriptorType; 3] = [
    vk::DescriptorType::STORAGE_BUFFER_DYNAMIC,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
];

/// Set 1, of comparisons also set 2.
const TEXTURE: [vk::DescriptorType; 2] = [vk::DescriptorType::SAMPLED_IMAGE, vk::DescriptorType::SAMPLER];

/// Most bindings of a set.
const MOST_BINDINGS: usize = 3;

/// Layout of a set with these bindings. Identical layouts are compatible, so they need not be shared, but a pipeline layout keeps its own.
fn layout(
    gpu: &Arc<Gpu>,
    kinds: &[vk::DescriptorType],
    stages: vk::ShaderStageFlags,
) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    let bindings = (0u32..).zip(kinds).map(|(binding, kind)| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(binding)
            .descriptor_type(*kind)
            .descriptor_count(1)
            .stage_flags(stages)
    });
    let bindings: Vec<_> = bindings.collect();
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: the device is live.
    unsafe {
        let handle = gpu
            .device
            .create_descriptor_set_layout(&info, None)
            .map_err(GpuError::from_call("vkCreateDescriptorSetLayout"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_descriptor_set_layout(handle, None)))
    }
}

const BOTH_STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::VERTEX.as_raw() | vk::ShaderStageFlags::FRAGMENT.as_raw(),
);

/// Layout of set 0 of [`UniformSet`].
pub(super) fn uniform_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    layout(gpu, &UNIFORM, BOTH_STAGES)
}

/// Layout of set 0 of [`ListSet`].
pub(super) fn list_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    layout(gpu, &LISTS, BOTH_STAGES)
}

/// Layout of sets from 1 on.
pub(super) fn texture_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
    let stages = vk::ShaderStageFlags::FRAGMENT | vk::ShaderStageFlags::COMPUTE;
    layout(gpu, &TEXTURE, stages)
}

/// Sets of one layout, with the pool that they go with, and the layout, which writing to them needs.
struct Sets {
    _pool: Owned<vk::DescriptorPool>,
    _layout: Owned<vk::DescriptorSetLayout>,
    handles: Vec<vk::DescriptorSet>,
}

fn allocate(
    gpu: &Arc<Gpu>,
    kinds: &[vk::DescriptorType],
    layout: Owned<vk::DescriptorSetLayout>,
    count: u32,
) -> Result<Sets, GpuError> {
    let sizes: Vec<_> =
        kinds.iter().map(|&ty| vk::DescriptorPoolSize { ty, descriptor_count: count }).collect();
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

/// A new set 0 over buffers, of each of which that many bytes are read from an offset on.
fn buffer_set(
    gpu: &Arc<Gpu>,
    layout: Owned<vk::DescriptorSetLayout>,
    buffers: &[(vk::DescriptorType, vk::Buffer, u64)],
) -> Result<Sets, GpuError> {
    let kinds: Vec<_> = buffers.iter().map(|(kind, ..)| *kind).collect();
    let sets = allocate(gpu, &kinds, layout, 1)?;
    let mut infos = [vk::DescriptorBufferInfo::default(); MOST_BINDINGS];
    for (info, &(_, buffer, range)) in infos.iter_mut().zip(buffers) {
        *info = vk::DescriptorBufferInfo { buffer, offset: 0, range };
    }
    for (binding, (info, kind)) in (0u32..).zip(infos.chunks(1).zip(kinds)) {
        let write = vk::WriteDescriptorSet::default()
            .dst_set(sets.handles[0])
            .dst_binding(binding)
            .descriptor_type(kind)
            .buffer_info(info);
        // SAFETY: set and buffer are live, and the set is not in use.
        unsafe { gpu.device.update_descriptor_sets(&[write], &[]) };
    }
    Ok(sets)
}

/// Set 0 over a ring of uniforms.
pub(crate) struct UniformSet {
    sets: Sets,
}

impl UniformSet {
    pub(crate) fn new<T: bytemuck::Pod>(ring: &UniformRing<T>) -> Result<Self, GpuError> {
        let gpu = ring.gpu();
        let buffers = [(UNIFORM[0], ring.handle(), size_of::<T>() as u64)];
        Ok(Self { sets: buffer_set(gpu, uniform_layout(gpu)?, &buffers)? })
    }

    /// The set, for one dynamic offset.
    pub(crate) fn handle(&self) -> vk::DescriptorSet {
        self.sets.handles[0]
    }
}

/// Set 0 over two rings of uniforms and one of words.
pub(crate) struct ListSet {
    sets: Sets,
}

impl ListSet {
    pub(crate) fn new<A: bytemuck::Pod, B: bytemuck::Pod>(
        first: &UniformRing<A>,
        second: &UniformRing<B>,
        words: &WordRing,
    ) -> Result<Self, GpuError> {
        Self::over(first, second, words.handle())
    }

    /// With words in a buffer that is not a ring, and outlives the result.
    pub(crate) fn over<A: bytemuck::Pod, B: bytemuck::Pod>(
        first: &UniformRing<A>,
        second: &UniformRing<B>,
        words: vk::Buffer,
    ) -> Result<Self, GpuError> {
        let gpu = first.gpu();
        let buffers = [
            (LISTS[0], first.handle(), size_of::<A>() as u64),
            (LISTS[1], second.handle(), size_of::<B>() as u64),
            (LISTS[2], words, vk::WHOLE_SIZE),
        ];
        Ok(Self { sets: buffer_set(gpu, list_layout(gpu)?, &buffers)? })
    }

    /// The set, for two dynamic offsets.
    pub(crate) fn handle(&self) -> vk::DescriptorSet {
        self.sets.handles[0]
    }
}

/// Set 0 over a ring of uniforms, one of words and one of results.
pub(crate) struct CompareSet {
    sets: Sets,
}

impl CompareSet {
    pub(crate) fn new<T: bytemuck::Pod>(
        params: &UniformRing<T>,
        words: &WordRing,
        results: &ResultRing,
    ) -> Result<Self, GpuError> {
        let gpu = params.gpu();
        let buffers = [
            (COMPARES[0], params.handle(), size_of::<T>() as u64),
            (COMPARES[1], words.handle(), vk::WHOLE_SIZE),
            (COMPARES[2], results.handle(), vk::WHOLE_SIZE),
        ];
        Ok(Self { sets: buffer_set(gpu, Self::layout(gpu)?, &buffers)? })
    }

    pub(super) fn layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, GpuError> {
        layout(gpu, &COMPARES, vk::ShaderStageFlags::COMPUTE)
    }

    /// The set, for one dynamic offset.
    pub(crate) fn handle(&self) -> vk::DescriptorSet {
        self.sets.handles[0]
    }
}

/// A sampler that interpolates between the four nearest texels, as every device does for the formats that `compose` takes.
pub(super) fn interpolating(gpu: &Arc<Gpu>) -> Result<Owned<vk::Sampler>, GpuError> {
    let edge = vk::SamplerAddressMode::CLAMP_TO_EDGE;
    let info = vk::SamplerCreateInfo::default()
        .mag_filter(vk::Filter::LINEAR)
        .min_filter(vk::Filter::LINEAR)
        .mipmap_mode(vk::SamplerMipmapMode::NEAREST)
        .address_mode_u(edge)
        .address_mode_v(edge)
        .address_mode_w(edge);
    // SAFETY: the device is live.
    unsafe {
        let handle =
            gpu.device.create_sampler(&info, None).map_err(GpuError::from_call("vkCreateSampler"))?;
        Ok(Owned::new(gpu, handle, |device, handle| device.destroy_sampler(handle, None)))
    }
}

/// Set 1, one for each of several textures.
pub(crate) struct TextureSets {
    sets: Sets,
    _sampler: Arc<Owned<vk::Sampler>>,
}

impl TextureSets {
    /// For views that are in SHADER_READ_ONLY_OPTIMAL when they are read, and outlive the result.
    pub(crate) fn new(gpu: &Arc<Gpu>, views: &[Owned<vk::ImageView>]) -> Result<Self, GpuError> {
        let sets = allocate(gpu, &TEXTURE, texture_layout(gpu)?, views.len() as u32)?;
        let sampler = gpu.shared()?.interpolating()?;
        for (&set, view) in sets.handles.iter().zip(views) {
            let image = [vk::DescriptorImageInfo {
                sampler: vk::Sampler::null(),
                image_view: view.handle(),
                image_layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
            }];
            let samplers = [vk::DescriptorImageInfo { sampler: sampler.handle(), ..Default::default() }];
            let writes = [(0, &image), (1, &samplers)].map(|(binding, info)| {
                vk::WriteDescriptorSet::default()
                    .dst_set(set)
                    .dst_binding(binding)
                    .descriptor_type(TEXTURE[binding as usize])
                    .image_info(info)
            });
            // SAFETY: set, view and sampler are live, and the set is not in use.
            unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
        }
        Ok(Self { sets, _sampler: sampler })
    }

    /// The set of the view at `index`.
    pub(crate) fn get(&self, index: usize) -> Option<vk::DescriptorSet> {
        self.sets.handles.get(index).copied()
    }
}
