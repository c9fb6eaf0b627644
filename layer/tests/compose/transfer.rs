//! Images of the runtime, and pictures into and out of images.

use crate::vulkan::Vulkan;
use ash::vk;

/// One layer of an image.
#[derive(Clone, Copy)]
pub struct Layer {
    pub image: vk::Image,
    pub layer: u32,
    pub extent: vk::Extent2D,
}

const ATTACHMENT: vk::ImageLayout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;

impl Vulkan {
    /// An image as a runtime makes it: with the usage asked for and no more (besides reading it back), in
    /// COLOR_ATTACHMENT_OPTIMAL.
    pub fn runtime_image(
        &self,
        format: vk::Format,
        extent: vk::Extent2D,
        layers: u32,
        usage: vk::ImageUsageFlags,
    ) -> vk::Image {
        self.image(vk::ImageCreateFlags::empty(), format, extent, layers, usage)
    }

    /// As [`Self::runtime_image`], with flags.
    pub fn image(
        &self,
        flags: vk::ImageCreateFlags,
        format: vk::Format,
        extent: vk::Extent2D,
        layers: u32,
        usage: vk::ImageUsageFlags,
    ) -> vk::Image {
        let info = vk::ImageCreateInfo::default()
            .flags(flags)
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent.into())
            .mip_levels(1)
            .array_layers(layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage | vk::ImageUsageFlags::TRANSFER_SRC);
        // SAFETY: plain use of Vulkan; the image is never destroyed.
        unsafe {
            let image = self.device.create_image(&info, None).unwrap();
            let memory = self.allocate(self.device.get_image_memory_requirements(image));
            self.device.bind_image_memory(image, memory, 0).unwrap();
            self.run(|commands| {
                self.transition(commands, image, layers, (vk::ImageLayout::UNDEFINED, ATTACHMENT));
            });
            image
        }
    }

    /// Fills a layer by a copy, which is still under way on return, as an application's rendering would be.
    pub fn upload(&self, to: Layer, pixels: &[u8]) {
        let (buffer, memory) = self.buffer(pixels.len());
        // SAFETY: plain use of Vulkan; the buffer is never destroyed.
        unsafe {
            let mapped =
                self.device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty()).unwrap();
            std::ptr::copy_nonoverlapping(pixels.as_ptr(), mapped.cast(), pixels.len());
            self.run(|commands| {
                let transfer = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
                self.transition(commands, to.image, vk::REMAINING_ARRAY_LAYERS, (ATTACHMENT, transfer));
                self.device.cmd_copy_buffer_to_image(commands, buffer, to.image, transfer, &[whole(to)]);
                self.transition(commands, to.image, vk::REMAINING_ARRAY_LAYERS, (transfer, ATTACHMENT));
            });
        }
    }

    /// Waits for everything and returns a layer's bytes, `texel_size` for each texel.
    pub fn download(&self, from: Layer, texel_size: usize) -> Vec<u8> {
        self.download_in(ATTACHMENT, from, texel_size)
    }

    /// As [`Self::download`], of an image in `layout`.
    pub fn download_in(&self, layout: vk::ImageLayout, from: Layer, texel_size: usize) -> Vec<u8> {
        let size = from.extent.width as usize * from.extent.height as usize * texel_size;
        let (buffer, memory) = self.buffer(size);
        // SAFETY: plain use of Vulkan; the buffer is never destroyed.
        unsafe {
            self.run(|commands| {
                let transfer = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
                self.transition(commands, from.image, vk::REMAINING_ARRAY_LAYERS, (layout, transfer));
                self.device.cmd_copy_image_to_buffer(commands, from.image, transfer, buffer, &[whole(from)]);
                self.transition(commands, from.image, vk::REMAINING_ARRAY_LAYERS, (transfer, layout));
            });
            self.device.queue_wait_idle(self.queue).unwrap();
            let mapped =
                self.device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty()).unwrap();
            std::slice::from_raw_parts(mapped.cast::<u8>(), size).to_vec()
        }
    }

    /// A depth image, as a copy destination and with `usage`.
    pub fn depth_image(
        &self,
        format: vk::Format,
        extent: vk::Extent2D,
        usage: vk::ImageUsageFlags,
    ) -> vk::Image {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent.into())
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage | vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST);
        self.image_of(&info)
    }

    /// An image with memory, whose content is undefined.
    pub fn image_of(&self, info: &vk::ImageCreateInfo<'_>) -> vk::Image {
        // SAFETY: plain use of Vulkan; the image is never destroyed.
        unsafe {
            let image = self.device.create_image(info, None).unwrap();
            let memory = self.allocate(self.device.get_image_memory_requirements(image));
            self.device.bind_image_memory(image, memory, 0).unwrap();
            image
        }
    }

    /// A view of a layer of an image, for all of its usage.
    pub fn layer_view(
        &self,
        image: vk::Image,
        format: vk::Format,
        aspects: vk::ImageAspectFlags,
        layer: u32,
    ) -> vk::ImageView {
        let range = vk::ImageSubresourceRange {
            aspect_mask: aspects,
            base_mip_level: 0,
            level_count: 1,
            base_array_layer: layer,
            layer_count: 1,
        };
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(range);
        // SAFETY: plain use of Vulkan; the view is never destroyed.
        unsafe { self.device.create_image_view(&info, None) }.unwrap()
    }

    /// A view of an image's first layer, for one usage.
    pub fn view(
        &self,
        image: vk::Image,
        format: vk::Format,
        aspects: vk::ImageAspectFlags,
        usage: vk::ImageUsageFlags,
    ) -> vk::ImageView {
        let mut usage = vk::ImageViewUsageCreateInfo::default().usage(usage);
        let range = vk::ImageSubresourceRange {
            aspect_mask: aspects,
            base_mip_level: 0,
            level_count: 1,
            base_array_layer: 0,
            layer_count: 1,
        };
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(range)
            .push_next(&mut usage);
        // SAFETY: plain use of Vulkan; the view is never destroyed.
        unsafe { self.device.create_image_view(&info, None) }.unwrap()
    }

    /// Waits for everything.
    pub fn idle(&self) {
        // SAFETY: plain use of Vulkan.
        unsafe { self.device.queue_wait_idle(self.queue) }.unwrap();
    }

    /// Writes to memory that is visible to the host and not in use.
    pub fn write_memory(&self, memory: vk::DeviceMemory, bytes: &[u8]) {
        // SAFETY: plain use of Vulkan; the memory is at least as large.
        unsafe {
            let mapped =
                self.device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty()).unwrap();
            std::ptr::copy_nonoverlapping(bytes.as_ptr(), mapped.cast(), bytes.len());
            self.device.unmap_memory(memory);
        }
    }

    /// Reads from memory that is visible to the host and not in use.
    pub fn read_memory(&self, memory: vk::DeviceMemory, size: usize) -> Vec<u8> {
        // SAFETY: plain use of Vulkan; the memory is at least as large.
        unsafe {
            let mapped =
                self.device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty()).unwrap();
            let bytes = std::slice::from_raw_parts(mapped.cast::<u8>(), size).to_vec();
            self.device.unmap_memory(memory);
            bytes
        }
    }

    /// A buffer that holds these bytes.
    pub fn staging(&self, bytes: &[u8]) -> vk::Buffer {
        let (buffer, memory) = self.buffer(bytes.len());
        self.write_memory(memory, bytes);
        buffer
    }

    unsafe fn allocate(&self, requirements: vk::MemoryRequirements) -> vk::DeviceMemory {
        let visible = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let fits = |index: u32, wanted| {
            requirements.memory_type_bits & (1 << index) != 0
                && self.memory.memory_types[index as usize].property_flags.contains(wanted)
        };
        let kinds = 0..self.memory.memory_type_count;
        let kind = kinds.clone().find(|&index| fits(index, visible));
        let kind =
            kind.or_else(|| kinds.clone().find(|&index| fits(index, vk::MemoryPropertyFlags::empty())));
        let info = vk::MemoryAllocateInfo::default()
            .allocation_size(requirements.size)
            .memory_type_index(kind.unwrap());
        // SAFETY: plain use of Vulkan.
        unsafe { self.device.allocate_memory(&info, None) }.unwrap()
    }

    fn buffer(&self, size: usize) -> (vk::Buffer, vk::DeviceMemory) {
        self.buffer_of(size, vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST)
    }

    /// A buffer in memory that is visible to the host; neither is ever destroyed.
    pub fn buffer_of(&self, size: usize, usage: vk::BufferUsageFlags) -> (vk::Buffer, vk::DeviceMemory) {
        let info = vk::BufferCreateInfo::default().size(size as u64).usage(usage);
        // SAFETY: plain use of Vulkan.
        unsafe {
            let buffer = self.device.create_buffer(&info, None).unwrap();
            let memory = self.allocate(self.device.get_buffer_memory_requirements(buffer));
            self.device.bind_buffer_memory(buffer, memory, 0).unwrap();
            (buffer, memory)
        }
    }

    /// Copies the beginning of one buffer to that of another, and waits for it.
    pub fn copy(&self, from: vk::Buffer, to: vk::Buffer, size: usize) {
        let region = vk::BufferCopy { src_offset: 0, dst_offset: 0, size: size as u64 };
        let everything = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
        let all = vk::PipelineStageFlags::ALL_COMMANDS;
        let none = vk::DependencyFlags::empty();
        // SAFETY: plain use of Vulkan.
        self.run(|commands| unsafe {
            self.device.cmd_pipeline_barrier(commands, all, all, none, &[everything], &[], &[]);
            self.device.cmd_copy_buffer(commands, from, to, &[region]);
            self.device.cmd_pipeline_barrier(commands, all, all, none, &[everything], &[], &[]);
        });
        self.idle();
    }

    /// The first bytes of a buffer on the device.
    pub fn read(&self, from: vk::Buffer, size: usize) -> Vec<u8> {
        let (buffer, memory) = self.buffer(size);
        self.copy(from, buffer, size);
        self.read_memory(memory, size)
    }

    /// Records and submits, without waiting.
    pub fn run(&self, record: impl FnOnce(vk::CommandBuffer)) {
        let info = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
        // SAFETY: plain use of Vulkan; command buffers are never freed.
        unsafe {
            let commands = self.device.allocate_command_buffers(&info).unwrap();
            self.device.begin_command_buffer(commands[0], &vk::CommandBufferBeginInfo::default()).unwrap();
            record(commands[0]);
            self.device.end_command_buffer(commands[0]).unwrap();
            let submit = vk::SubmitInfo::default().command_buffers(&commands);
            self.device.queue_submit(self.queue, &[submit], vk::Fence::null()).unwrap();
        }
    }

    /// Between use as attachment and copies, as an application would write it.
    ///
    /// # Safety
    /// The command buffer is being recorded, and the image is live.
    pub unsafe fn transition(
        &self,
        commands: vk::CommandBuffer,
        image: vk::Image,
        layers: u32,
        (old, new): (vk::ImageLayout, vk::ImageLayout),
    ) {
        let scope = |layout| match layout {
            ATTACHMENT => (
                vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT,
                vk::AccessFlags::COLOR_ATTACHMENT_READ | vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
            ),
            vk::ImageLayout::TRANSFER_SRC_OPTIMAL => {
                (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_READ)
            }
            vk::ImageLayout::TRANSFER_DST_OPTIMAL => {
                (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE)
            }
            vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL => {
                (vk::PipelineStageFlags::COMPUTE_SHADER, vk::AccessFlags::SHADER_READ)
            }
            vk::ImageLayout::GENERAL => (
                vk::PipelineStageFlags::COMPUTE_SHADER,
                vk::AccessFlags::SHADER_READ | vk::AccessFlags::SHADER_WRITE,
            ),
            _ => (vk::PipelineStageFlags::TOP_OF_PIPE, vk::AccessFlags::empty()),
        };
        let ((src_stage, src_access), (dst_stage, dst_access)) = (scope(old), scope(new));
        let barrier = vk::ImageMemoryBarrier::default()
            .image(image)
            .old_layout(old)
            .new_layout(new)
            .src_access_mask(src_access)
            .dst_access_mask(dst_access)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                base_mip_level: 0,
                level_count: 1,
                base_array_layer: 0,
                layer_count: layers,
            });
        let none = vk::DependencyFlags::empty();
        // SAFETY: plain use of Vulkan.
        unsafe {
            self.device.cmd_pipeline_barrier(commands, src_stage, dst_stage, none, &[], &[], &[barrier])
        };
    }
}

fn whole(layer: Layer) -> vk::BufferImageCopy {
    vk::BufferImageCopy::default()
        .image_subresource(vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            mip_level: 0,
            base_array_layer: layer.layer,
            layer_count: 1,
        })
        .image_extent(layer.extent.into())
}
