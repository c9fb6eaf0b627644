//! A Vulkan device as an application has one, with which it paints swapchain images.

use ash::vk;
use openxr_sys as xr;
use std::ffi::{CStr, c_char};

/// Instance, device and queue.
pub struct Gpu {
    /// Keeps the loader.
    _entry: ash::Entry,
    pub instance: ash::Instance,
    pub physical_device: vk::PhysicalDevice,
    pub device: ash::Device,
    queue: vk::Queue,
    memory: vk::PhysicalDeviceMemoryProperties,
}

/// `vkGetInstanceProcAddr` of the Vulkan loader.
pub fn vulkan_loader() -> vk::PFN_vkGetInstanceProcAddr {
    // SAFETY: the Vulkan loader may be loaded by anybody; it stays loaded.
    unsafe {
        let library = Box::leak(Box::new(libloading::Library::new("libvulkan.so.1").unwrap()));
        *library.get::<vk::PFN_vkGetInstanceProcAddr>(c"vkGetInstanceProcAddr").unwrap()
    }
}

fn pointers(names: &[&CStr]) -> Vec<*const c_char> {
    names.iter().map(|name| name.as_ptr()).collect()
}

impl Gpu {
    /// A device of the application's own, with the extensions that the runtime asks for by default.
    pub fn new() -> Self {
        let get_instance_proc_addr = vulkan_loader();
        // SAFETY: plain Vulkan with valid structures.
        unsafe {
            let entry = ash::Entry::from_static_fn(ash::StaticFn { get_instance_proc_addr });
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_0);
            let extensions = pointers(&[c"VK_KHR_get_physical_device_properties2"]);
            let info = vk::InstanceCreateInfo::default()
                .application_info(&application)
                .enabled_extension_names(&extensions);
            let instance = entry.create_instance(&info, None).unwrap();
            let physical_device = instance.enumerate_physical_devices().unwrap()[0];
            let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let extensions = pointers(&[c"VK_KHR_image_format_list"]);
            let info = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&extensions);
            let device = instance.create_device(physical_device, &info, None).unwrap();
            Self::of(entry, instance, physical_device, device)
        }
    }

    /// Around a device that exists; its queue family is 0.
    pub fn of(
        entry: ash::Entry,
        instance: ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: ash::Device,
    ) -> Self {
        // SAFETY: the device was made with a queue of family 0.
        let (queue, memory) = unsafe {
            (device.get_device_queue(0, 0), instance.get_physical_device_memory_properties(physical_device))
        };
        Self { _entry: entry, instance, physical_device, device, queue, memory }
    }

    pub fn binding(&self) -> xr::GraphicsBindingVulkanKHR {
        use ash::vk::Handle;
        xr::GraphicsBindingVulkanKHR {
            ty: xr::GraphicsBindingVulkanKHR::TYPE,
            next: std::ptr::null(),
            instance: self.instance.handle().as_raw() as _,
            physical_device: self.physical_device.as_raw() as _,
            device: self.device.handle().as_raw() as _,
            queue_family_index: 0,
            queue_index: 0,
        }
    }

    /// Copies texels, tightly packed, into a layer of an image that is, and stays, in COLOR_ATTACHMENT_OPTIMAL.
    pub fn paint(&self, image: vk::Image, layer: u32, width: u32, height: u32, texels: &[u8]) {
        let device = &self.device;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let visible = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        // SAFETY: plain Vulkan with valid structures; the queue is waited for before anything is freed.
        unsafe {
            let size = texels.len() as u64;
            let buffer =
                device.create_buffer(&vk::BufferCreateInfo::default().size(size).usage(usage), None).unwrap();
            let needs = device.get_buffer_memory_requirements(buffer);
            let fits = |index: &u32| {
                let ty = self.memory.memory_types[*index as usize];
                needs.memory_type_bits & (1 << index) != 0 && ty.property_flags.contains(visible)
            };
            let index = (0..self.memory.memory_type_count).find(fits).unwrap();
            let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(index);
            let memory = device.allocate_memory(&info, None).unwrap();
            device.bind_buffer_memory(buffer, memory, 0).unwrap();
            let mapped = device.map_memory(memory, 0, size, vk::MemoryMapFlags::empty()).unwrap();
            std::ptr::copy_nonoverlapping(texels.as_ptr(), mapped.cast(), texels.len());

            let pool = device.create_command_pool(&vk::CommandPoolCreateInfo::default(), None).unwrap();
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = device.allocate_command_buffers(&info).unwrap();
            device.begin_command_buffer(commands[0], &vk::CommandBufferBeginInfo::default()).unwrap();
            self.copy(commands[0], buffer, image, layer, vk::Extent3D { width, height, depth: 1 });
            device.end_command_buffer(commands[0]).unwrap();
            let submit = vk::SubmitInfo::default().command_buffers(&commands);
            device.queue_submit(self.queue, &[submit], vk::Fence::null()).unwrap();
            device.queue_wait_idle(self.queue).unwrap();
            device.destroy_command_pool(pool, None);
            device.destroy_buffer(buffer, None);
            device.free_memory(memory, None);
        }
    }

    fn copy(
        &self,
        commands: vk::CommandBuffer,
        buffer: vk::Buffer,
        image: vk::Image,
        layer: u32,
        image_extent: vk::Extent3D,
    ) {
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .level_count(1)
            .base_array_layer(layer)
            .layer_count(1);
        let (attachment, target) =
            (vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        let barrier = |old, new, from, to| {
            vk::ImageMemoryBarrier::default()
                .image(image)
                .subresource_range(range)
                .old_layout(old)
                .new_layout(new)
                .src_access_mask(from)
                .dst_access_mask(to)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        };
        let region = vk::BufferImageCopy {
            image_subresource: vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                base_array_layer: layer,
                layer_count: 1,
                mip_level: 0,
            },
            image_extent,
            ..vk::BufferImageCopy::default()
        };
        let (read, write) = (vk::AccessFlags::MEMORY_READ, vk::AccessFlags::TRANSFER_WRITE);
        let (all, transfer) = (vk::PipelineStageFlags::ALL_COMMANDS, vk::PipelineStageFlags::TRANSFER);
        let (none, device) = (vk::DependencyFlags::empty(), &self.device);
        // SAFETY: the command buffer is being recorded; buffer and image are of this device.
        unsafe {
            let before = [barrier(attachment, target, vk::AccessFlags::empty(), write)];
            device.cmd_pipeline_barrier(commands, all, transfer, none, &[], &[], &before);
            device.cmd_copy_buffer_to_image(commands, buffer, image, target, &[region]);
            let after = [barrier(target, attachment, write, read)];
            device.cmd_pipeline_barrier(commands, transfer, all, none, &[], &[], &after);
        }
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: nothing of the device is left: sessions and swapchains go first.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}
