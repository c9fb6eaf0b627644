//! Images of swapchains.

use super::{Gpu, failed, format};
use crate::fault::Fault;
use ash::vk;
use std::sync::Arc;

/// Description of a swapchain's images.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    pub format: vk::Format,
    /// The application's request.
    pub usage: vk::ImageUsageFlags,
    pub mutable: bool,
    /// Empty: any compatible one, where mutable.
    pub view_formats: Vec<vk::Format>,
    pub extent: vk::Extent2D,
    pub samples: vk::SampleCountFlags,
    /// 1, or 6 for cubes.
    pub faces: u32,
    /// All faces of all cubes.
    pub array_layers: u32,
    pub mips: u32,
    pub is_static: bool,
}

impl Shape {
    pub fn is_depth(&self) -> bool {
        format::is_depth(self.format)
    }

    /// The layout in which images change hands (`XR_KHR_vulkan_enable`, "Swapchain Image Layout").
    pub fn layout(&self) -> vk::ImageLayout {
        match self.is_depth() {
            true => vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
            false => vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }
    }

    /// All of an image.
    pub fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange::default()
            .aspect_mask(format::aspects(self.format))
            .level_count(self.mips)
            .layer_count(self.array_layers)
    }
}

/// The images of a swapchain.
pub(crate) struct Images {
    gpu: Arc<Gpu>,
    images: Vec<vk::Image>,
    memory: Vec<vk::DeviceMemory>,
    is_ready: bool,
}

impl Images {
    /// Makes images. Submits nothing: swapchains are created where the queue is the application's.
    pub fn new(gpu: &Arc<Gpu>, shape: &Shape, count: u32) -> Result<Self, Fault> {
        let mut made = Self { gpu: gpu.clone(), images: Vec::new(), memory: Vec::new(), is_ready: false };
        (0..count).try_for_each(|_| made.add(shape))?;
        Ok(made)
    }

    /// Brings them to the layout in which the application gets them, the first time.
    pub fn make_ready(&mut self, shape: &Shape) -> Result<(), Fault> {
        if self.is_ready {
            return Ok(());
        }
        let barriers: Vec<_> = self.images.iter().map(|&image| first_barrier(shape, image)).collect();
        self.gpu.run(|device, commands| {
            // SAFETY: the command buffer is being recorded; the images are of this device.
            unsafe {
                device.cmd_pipeline_barrier(
                    commands,
                    vk::PipelineStageFlags::TOP_OF_PIPE,
                    vk::PipelineStageFlags::ALL_COMMANDS,
                    vk::DependencyFlags::empty(),
                    &[],
                    &[],
                    &barriers,
                );
            }
        })?;
        self.is_ready = true;
        Ok(())
    }

    /// The images, in the order of their indices.
    pub fn handles(&self) -> &[vk::Image] {
        &self.images
    }

    fn add(&mut self, shape: &Shape) -> Result<(), Fault> {
        let mut flags = vk::ImageCreateFlags::empty();
        if shape.mutable {
            flags |= vk::ImageCreateFlags::MUTABLE_FORMAT;
        }
        if shape.faces == 6 {
            flags |= vk::ImageCreateFlags::CUBE_COMPATIBLE;
        }
        let mut list = vk::ImageFormatListCreateInfo::default().view_formats(&shape.view_formats);
        let mut info = vk::ImageCreateInfo::default()
            .flags(flags)
            .image_type(vk::ImageType::TYPE_2D)
            .format(shape.format)
            .extent(shape.extent.into())
            .mip_levels(shape.mips)
            .array_layers(shape.array_layers)
            .samples(shape.samples)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(shape.usage | format::OWN_USAGE)
            .sharing_mode(vk::SharingMode::EXCLUSIVE)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        if !shape.view_formats.is_empty() {
            info = info.push_next(&mut list);
        }
        let device = &self.gpu.device;
        // SAFETY: the structures are complete; image and memory are destroyed with `self`, which has them at once.
        unsafe {
            let image = device.create_image(&info, None).map_err(failed("vkCreateImage"))?;
            self.images.push(image);
            let requirements = device.get_image_memory_requirements(image);
            let memory = self.gpu.allocate(requirements, vk::MemoryPropertyFlags::DEVICE_LOCAL)?;
            self.memory.push(memory);
            device.bind_image_memory(image, memory, 0).map_err(failed("vkBindImageMemory"))
        }
    }
}

fn first_barrier(shape: &Shape, image: vk::Image) -> vk::ImageMemoryBarrier<'static> {
    vk::ImageMemoryBarrier::default()
        .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE)
        .old_layout(vk::ImageLayout::UNDEFINED)
        .new_layout(shape.layout())
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(image)
        .subresource_range(shape.range())
}

impl Drop for Images {
    fn drop(&mut self) {
        // SAFETY: made by this device. The specification has the application finish its work on the images before it
        // destroys the swapchain; ours is waited for where it is submitted.
        unsafe {
            self.images.iter().for_each(|&image| self.gpu.device.destroy_image(image, None));
            self.memory.iter().for_each(|&memory| self.gpu.device.free_memory(memory, None));
        }
    }
}
