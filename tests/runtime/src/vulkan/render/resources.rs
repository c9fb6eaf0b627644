//! Resources of a frame of the compositor, freed when dropped; by then the queue is done with them.

use super::super::{Gpu, failed};
use super::pipelines::{Pipelines, Purpose};
use crate::compositor::Params;
use crate::fault::Fault;
use ash::vk;
use std::sync::Arc;

/// A buffer that the CPU sees.
pub(super) struct Buffer {
    gpu: Arc<Gpu>,
    buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    bytes: *mut u8,
    size: usize,
}

impl Buffer {
    pub fn new(gpu: &Arc<Gpu>, size: u64, usage: vk::BufferUsageFlags) -> Result<Self, Fault> {
        let info = vk::BufferCreateInfo::default().size(size).usage(usage);
        let visible = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let device = &gpu.device;
        // SAFETY: the structures are complete; `made` frees the objects that it has when a later step fails.
        unsafe {
            let buffer = device.create_buffer(&info, None).map_err(failed("vkCreateBuffer"))?;
            let (memory, bytes) = (vk::DeviceMemory::null(), std::ptr::null_mut());
            let mut made = Self { gpu: gpu.clone(), buffer, memory, bytes, size: size as usize };
            made.memory = gpu.allocate(device.get_buffer_memory_requirements(buffer), visible)?;
            device.bind_buffer_memory(buffer, made.memory, 0).map_err(failed("vkBindBufferMemory"))?;
            let mapped = device.map_memory(made.memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty());
            made.bytes = mapped.map_err(failed("vkMapMemory"))?.cast();
            Ok(made)
        }
    }

    pub fn handle(&self) -> vk::Buffer {
        self.buffer
    }

    /// Content; the queue is idle whenever the CPU looks.
    pub fn bytes(&self) -> &[u8] {
        // SAFETY: mapped in full for as long as the buffer lives.
        unsafe { std::slice::from_raw_parts(self.bytes, self.size) }
    }

    /// Stores content.
    pub fn write(&mut self, offset: usize, content: &[u8]) {
        // SAFETY: as in `bytes`, and `self` is borrowed alone.
        let bytes = unsafe { std::slice::from_raw_parts_mut(self.bytes, self.size) };
        bytes[offset..offset + content.len()].copy_from_slice(content);
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: made by this device, not in use.
        unsafe {
            self.gpu.device.destroy_buffer(self.buffer, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}

/// A view of all of an image.
pub(super) struct View {
    gpu: Arc<Gpu>,
    view: vk::ImageView,
}

impl View {
    /// A view of the first mip level of a colour image.
    pub fn new(gpu: &Arc<Gpu>, image: vk::Image, format: vk::Format, layers: u32) -> Result<Self, Fault> {
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .level_count(1)
            .layer_count(layers);
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
            .format(format)
            .subresource_range(range);
        // SAFETY: the image is of this device and has this format and so many layers.
        let view =
            unsafe { gpu.device.create_image_view(&info, None) }.map_err(failed("vkCreateImageView"))?;
        Ok(Self { gpu: gpu.clone(), view })
    }

    pub fn handle(&self) -> vk::ImageView {
        self.view
    }
}

impl Drop for View {
    fn drop(&mut self) {
        // SAFETY: made by this device, not in use.
        unsafe { self.gpu.device.destroy_image_view(self.view, None) };
    }
}

/// An image that passes draw into.
pub(super) struct Target {
    framebuffer: vk::Framebuffer,
    view: Option<View>,
    image: vk::Image,
    memory: vk::DeviceMemory,
    extent: vk::Extent2D,
    gpu: Arc<Gpu>,
}

impl Target {
    pub fn new(
        gpu: &Arc<Gpu>,
        pass: vk::RenderPass,
        purpose: Purpose,
        extent: vk::Extent2D,
    ) -> Result<Self, Fault> {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(purpose.format())
            .extent(extent.into())
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | purpose.usage());
        let device = &gpu.device;
        // SAFETY: the structures are complete; `made` frees the objects that it has when a later step fails.
        unsafe {
            let image = device.create_image(&info, None).map_err(failed("vkCreateImage"))?;
            let (memory, framebuffer) = (vk::DeviceMemory::null(), vk::Framebuffer::null());
            let mut made = Self { framebuffer, view: None, image, memory, extent, gpu: gpu.clone() };
            let local = vk::MemoryPropertyFlags::DEVICE_LOCAL;
            made.memory = gpu.allocate(device.get_image_memory_requirements(image), local)?;
            device.bind_image_memory(image, made.memory, 0).map_err(failed("vkBindImageMemory"))?;
            let view = View::new(gpu, image, purpose.format(), 1)?;
            let attachments = [view.handle()];
            made.view = Some(view);
            let info = vk::FramebufferCreateInfo::default()
                .render_pass(pass)
                .attachments(&attachments)
                .width(extent.width)
                .height(extent.height)
                .layers(1);
            made.framebuffer =
                device.create_framebuffer(&info, None).map_err(failed("vkCreateFramebuffer"))?;
            Ok(made)
        }
    }

    pub fn extent(&self) -> vk::Extent2D {
        self.extent
    }

    pub fn framebuffer(&self) -> vk::Framebuffer {
        self.framebuffer
    }

    pub fn image(&self) -> vk::Image {
        self.image
    }

    pub fn view(&self) -> vk::ImageView {
        self.view.as_ref().map_or(vk::ImageView::null(), View::handle)
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        self.view = None;
        // SAFETY: made by this device, not in use.
        unsafe {
            self.gpu.device.destroy_framebuffer(self.framebuffer, None);
            self.gpu.device.destroy_image(self.image, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}

/// Descriptor sets for the draws of a frame.
pub(super) struct Descriptors {
    gpu: Arc<Gpu>,
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
}

impl Descriptors {
    pub fn new(gpu: &Arc<Gpu>, pipelines: &Pipelines, count: u32) -> Result<Self, Fault> {
        let size = |ty| vk::DescriptorPoolSize { ty, descriptor_count: count };
        let sizes = pipelines.bindings().map(|binding| size(binding.descriptor_type));
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(count).pool_sizes(&sizes);
        // SAFETY: the structures are complete; the pool frees its sets.
        unsafe {
            let pool =
                gpu.device.create_descriptor_pool(&info, None).map_err(failed("vkCreateDescriptorPool"))?;
            let mut made = Self { gpu: gpu.clone(), pool, sets: Vec::new() };
            let layouts = vec![pipelines.set_layout(); count as usize];
            let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
            made.sets =
                gpu.device.allocate_descriptor_sets(&info).map_err(failed("vkAllocateDescriptorSets"))?;
            Ok(made)
        }
    }

    /// Fills a set: the image, and parameters at a place of a buffer. The sampler is part of the layout.
    pub fn set(
        &self,
        index: usize,
        view: vk::ImageView,
        params: vk::Buffer,
        offset: u64,
    ) -> vk::DescriptorSet {
        let set = self.sets[index];
        let buffers =
            [vk::DescriptorBufferInfo { buffer: params, offset, range: size_of::<Params>() as u64 }];
        let images = [vk::DescriptorImageInfo {
            sampler: vk::Sampler::null(),
            image_view: view,
            image_layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        }];
        let write = |binding, ty| {
            vk::WriteDescriptorSet::default().dst_set(set).dst_binding(binding).descriptor_type(ty)
        };
        let writes = [
            write(0, vk::DescriptorType::UNIFORM_BUFFER).buffer_info(&buffers),
            write(1, vk::DescriptorType::SAMPLED_IMAGE).image_info(&images),
        ];
        // SAFETY: set, buffer and view are of this device; the set is not in use yet.
        unsafe { self.gpu.device.update_descriptor_sets(&writes, &[]) };
        set
    }
}

impl Drop for Descriptors {
    fn drop(&mut self) {
        // SAFETY: made by this device, not in use.
        unsafe { self.gpu.device.destroy_descriptor_pool(self.pool, None) };
    }
}
