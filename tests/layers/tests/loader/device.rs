//! Instance, device and an image to draw to, for the programs.

use ash::vk;

/// Side of the image, in pixels.
pub const SIDE: u32 = 256;

/// Way in which the application requests device features.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Asks {
    /// In VkDeviceCreateInfo, or not at all where there are none.
    Directly,
    /// In a chained VkPhysicalDeviceFeatures2.
    Chained,
}

/// A device with one queue, and a command pool.
pub struct Device {
    _entry: ash::Entry,
    pub instance: ash::Instance,
    pub device: ash::Device,
    pub queue: vk::Queue,
    pub pool: vk::CommandPool,
    memory_types: vk::PhysicalDeviceMemoryProperties,
}

impl Device {
    pub fn new(version: u32, features: vk::PhysicalDeviceFeatures, asks: Asks) -> Self {
        // SAFETY: plain use of Vulkan; the handles live as long as the structure.
        unsafe {
            let entry = ash::Entry::load().unwrap();
            let application = vk::ApplicationInfo::default().api_version(version);
            let info = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&info, None).unwrap();
            let physical_device = instance.enumerate_physical_devices().unwrap()[0];
            let queue = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let mut modern =
                vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true).synchronization2(true);
            let mut chained = vk::PhysicalDeviceFeatures2::default().features(features);
            let mut info = vk::DeviceCreateInfo::default().queue_create_infos(&queue);
            match asks {
                Asks::Directly => info = info.enabled_features(&features),
                Asks::Chained => info = info.push_next(&mut chained),
            }
            if version >= vk::API_VERSION_1_3 {
                info = info.push_next(&mut modern);
            }
            let device = instance.create_device(physical_device, &info, None).unwrap();
            let pool =
                vk::CommandPoolCreateInfo::default().flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
            Self {
                queue: device.get_device_queue(0, 0),
                pool: device.create_command_pool(&pool, None).unwrap(),
                memory_types: instance.get_physical_device_memory_properties(physical_device),
                _entry: entry,
                instance,
                device,
            }
        }
    }

    /// Records a primary command buffer.
    pub fn record(&self, commands: impl FnOnce(vk::CommandBuffer)) -> vk::CommandBuffer {
        let info = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
        // SAFETY: plain use of Vulkan.
        unsafe {
            let buffer = self.device.allocate_command_buffers(&info).unwrap()[0];
            self.device.begin_command_buffer(buffer, &vk::CommandBufferBeginInfo::default()).unwrap();
            commands(buffer);
            self.device.end_command_buffer(buffer).unwrap();
            buffer
        }
    }

    /// Submits buffers, by either call, and does not wait.
    pub fn submit(&self, buffers: &[vk::CommandBuffer], modern: bool) {
        // SAFETY: plain use of Vulkan.
        unsafe {
            if modern {
                let infos: Vec<_> = buffers
                    .iter()
                    .map(|&buffer| vk::CommandBufferSubmitInfo::default().command_buffer(buffer))
                    .collect();
                let submit = vk::SubmitInfo2::default().command_buffer_infos(&infos);
                self.device.queue_submit2(self.queue, &[submit], vk::Fence::null()).unwrap();
            } else {
                let submit = vk::SubmitInfo::default().command_buffers(buffers);
                self.device.queue_submit(self.queue, &[submit], vk::Fence::null()).unwrap();
            }
        }
    }

    pub fn wait(&self) {
        // SAFETY: no other thread uses the queue.
        unsafe { self.device.queue_wait_idle(self.queue).unwrap() }
    }

    fn allocate(&self, needs: vk::MemoryRequirements) -> vk::DeviceMemory {
        let fits = |index: &u32| needs.memory_type_bits & (1 << index) != 0;
        let memory_type = (0..self.memory_types.memory_type_count).find(fits).unwrap();
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(memory_type);
        // SAFETY: plain use of Vulkan.
        unsafe { self.device.allocate_memory(&info, None).unwrap() }
    }

    /// A colour image of SIDE x SIDE, and its memory.
    pub fn image(&self) -> (vk::Image, vk::DeviceMemory) {
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
        self.image_of(vk::Format::R8G8B8A8_UNORM, usage)
    }

    /// As [`Self::image`], of a format and usage.
    pub fn image_of(&self, format: vk::Format, usage: vk::ImageUsageFlags) -> (vk::Image, vk::DeviceMemory) {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: SIDE, height: SIDE, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        // SAFETY: plain use of Vulkan.
        unsafe {
            let image = self.device.create_image(&info, None).unwrap();
            let memory = self.allocate(self.device.get_image_memory_requirements(image));
            self.device.bind_image_memory(image, memory, 0).unwrap();
            (image, memory)
        }
    }

    /// A buffer of 1 KiB, and its memory.
    pub fn buffer(&self) -> (vk::Buffer, vk::DeviceMemory) {
        let usage = vk::BufferUsageFlags::TRANSFER_DST | vk::BufferUsageFlags::TRANSFER_SRC;
        let info = vk::BufferCreateInfo::default().size(1024).usage(usage);
        // SAFETY: plain use of Vulkan.
        unsafe {
            let buffer = self.device.create_buffer(&info, None).unwrap();
            let memory = self.allocate(self.device.get_buffer_memory_requirements(buffer));
            self.device.bind_buffer_memory(buffer, memory, 0).unwrap();
            (buffer, memory)
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the programs wait, and destroy the objects that they made, before.
        unsafe {
            self.device.destroy_command_pool(self.pool, None);
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// All levels and layers of a colour image.
pub fn whole() -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default()
        .aspect_mask(vk::ImageAspectFlags::COLOR)
        .level_count(vk::REMAINING_MIP_LEVELS)
        .layer_count(vk::REMAINING_ARRAY_LAYERS)
}
