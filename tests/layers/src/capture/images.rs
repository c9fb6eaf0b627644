//! Pictures out of swapchain images, on the device and queue of the session.

use ash::vk;
use ash::vk::Handle;
use openxr_sys as xr;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// The device and the queue of the session.
pub struct Images {
    device: ash::Device,
    memory: vk::PhysicalDeviceMemoryProperties,
    family: u32,
    queue: vk::Queue,
}

// Failures end the process, as failures of a report do: otherwise a test would find no picture, and no reason.
#[allow(clippy::unwrap_used, reason = "a layer of tests")]
impl Images {
    /// Of a session's graphics binding.
    ///
    /// # Safety
    ///
    /// Its handles are live, and outlive the result.
    pub unsafe fn of(binding: &xr::GraphicsBindingVulkanKHR) -> Self {
        // SAFETY: the caller vouches for the handles; the application has loaded the library, which stays.
        unsafe {
            let library = libc::dlopen(c"libvulkan.so.1".as_ptr(), libc::RTLD_NOW);
            let get = libc::dlsym(library, c"vkGetInstanceProcAddr".as_ptr());
            assert!(!get.is_null(), "libvulkan.so.1 has no vkGetInstanceProcAddr");
            let get_instance_proc_addr =
                std::mem::transmute::<*mut libc::c_void, vk::PFN_vkGetInstanceProcAddr>(get);
            let handle = |pointer: *const libc::c_void| pointer as u64;
            let instance = vk::Instance::from_raw(handle(binding.instance));
            let instance = ash::Instance::load(&ash::StaticFn { get_instance_proc_addr }, instance);
            let physical = vk::PhysicalDevice::from_raw(handle(binding.physical_device));
            let device = vk::Device::from_raw(handle(binding.device));
            let device = ash::Device::load(instance.fp_v1_0(), device);
            let family = binding.queue_family_index;
            let queue = device.get_device_queue(family, binding.queue_index);
            Self { memory: instance.get_physical_device_memory_properties(physical), device, family, queue }
        }
    }

    /// Waits for the queue, and saves part of an image of four 8-bit components, red first, as a PNG.
    ///
    /// # Safety
    ///
    /// The image is live and not written; all work with it was submitted; no other code uses the queue meanwhile.
    pub unsafe fn save(&self, image: u64, part: &xr::SwapchainSubImage, path: &Path) {
        let rect = part.image_rect;
        let [width, height] = [rect.extent.width, rect.extent.height].map(|side| side as u32);
        let bytes = u64::from(width) * u64::from(height) * 4;
        let region = vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: part.image_array_index,
                layer_count: 1,
            })
            .image_offset(vk::Offset3D { x: rect.offset.x, y: rect.offset.y, z: 0 })
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        let device = &self.device;
        // SAFETY: the caller vouches for image and queue; the rest is made here, and the copy is waited for.
        let codes = unsafe {
            let info = vk::BufferCreateInfo::default().size(bytes).usage(vk::BufferUsageFlags::TRANSFER_DST);
            let buffer = device.create_buffer(&info, None).unwrap();
            let memory = self.allocate(device.get_buffer_memory_requirements(buffer));
            device.bind_buffer_memory(buffer, memory, 0).unwrap();
            self.run(|commands| self.copy(commands, vk::Image::from_raw(image), buffer, region));
            let mapped = device.map_memory(memory, 0, bytes, vk::MemoryMapFlags::empty()).unwrap();
            let codes = std::slice::from_raw_parts(mapped.cast::<u8>(), bytes as usize).to_vec();
            device.destroy_buffer(buffer, None);
            device.free_memory(memory, None);
            codes
        };
        let mut encoder = png::Encoder::new(BufWriter::new(File::create(path).unwrap()), width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header().unwrap().write_image_data(&codes).unwrap();
    }

    /// # Safety
    ///
    /// As for [`Self::save`]; the command buffer is being recorded.
    unsafe fn copy(
        &self,
        commands: vk::CommandBuffer,
        image: vk::Image,
        buffer: vk::Buffer,
        region: vk::BufferImageCopy,
    ) {
        let all = vk::PipelineStageFlags::ALL_COMMANDS;
        let used = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        let layer = region.image_subresource;
        let barrier = |old, new| {
            vk::ImageMemoryBarrier::default()
                .image(image)
                .src_access_mask(used)
                .dst_access_mask(used)
                .old_layout(old)
                .new_layout(new)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .subresource_range(vk::ImageSubresourceRange {
                    aspect_mask: layer.aspect_mask,
                    base_mip_level: 0,
                    level_count: 1,
                    base_array_layer: layer.base_array_layer,
                    layer_count: 1,
                })
        };
        // The layout in which applications must release images (XR_KHR_vulkan_enable, "Swapchain Image Layout").
        let released = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let copied = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        let (there, back) = ([barrier(released, copied)], [barrier(copied, released)]);
        let none = vk::DependencyFlags::empty();
        // SAFETY: the caller vouches for it.
        unsafe {
            self.device.cmd_pipeline_barrier(commands, all, all, none, &[], &[], &there);
            self.device.cmd_copy_image_to_buffer(commands, image, copied, buffer, &[region]);
            self.device.cmd_pipeline_barrier(commands, all, all, none, &[], &[], &back);
        }
    }

    /// Records, submits and waits.
    ///
    /// # Safety
    ///
    /// No other code uses the queue meanwhile.
    unsafe fn run(&self, record: impl FnOnce(vk::CommandBuffer)) {
        let device = &self.device;
        // SAFETY: the caller vouches for the queue; the rest is made here.
        unsafe {
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(self.family);
            let pool = device.create_command_pool(&info, None).unwrap();
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = device.allocate_command_buffers(&info).unwrap();
            device.begin_command_buffer(commands[0], &vk::CommandBufferBeginInfo::default()).unwrap();
            record(commands[0]);
            device.end_command_buffer(commands[0]).unwrap();
            let submit = vk::SubmitInfo::default().command_buffers(&commands);
            device.queue_submit(self.queue, &[submit], vk::Fence::null()).unwrap();
            device.queue_wait_idle(self.queue).unwrap();
            device.destroy_command_pool(pool, None);
        }
    }

    /// Memory that the host sees.
    ///
    /// # Safety
    ///
    /// The device is live.
    unsafe fn allocate(&self, requirements: vk::MemoryRequirements) -> vk::DeviceMemory {
        let visible = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let is_fit = |index: &u32| {
            requirements.memory_type_bits & (1 << index) != 0
                && self.memory.memory_types[*index as usize].property_flags.contains(visible)
        };
        let kind = (0..self.memory.memory_type_count).find(is_fit).unwrap();
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(requirements.size).memory_type_index(kind);
        // SAFETY: the caller vouches for the device.
        unsafe { self.device.allocate_memory(&info, None) }.unwrap()
    }
}
