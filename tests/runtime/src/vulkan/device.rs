//! The application's device, and work on the queue of the session's graphics binding.

use super::{failed, format};
use crate::fault::Fault;
use ash::vk;
use std::ffi::CStr;

/// A device of the application, for the time of a session.
///
/// Work is submitted to the binding's queue only inside the calls in which the specification keeps the application off
/// it (`XR_KHR_vulkan_enable`, "Concurrency"), and is waited for before they return.
pub(crate) struct Gpu {
    pub device: ash::Device,
    queue: vk::Queue,
    memory: vk::PhysicalDeviceMemoryProperties,
    pool: vk::CommandPool,
    fence: vk::Fence,
    formats: Vec<vk::Format>,
}

impl Gpu {
    /// Opens a living device of which the queue exists.
    pub fn new(
        instance: &ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: vk::Device,
        family: u32,
        queue_index: u32,
    ) -> Result<Self, Fault> {
        let load = |name: &CStr| {
            // SAFETY: the application vouches for its device; the name is NUL-terminated.
            let function = unsafe { instance.get_device_proc_addr(device, name.as_ptr()) };
            function.map_or(std::ptr::null(), |function| function as *const _)
        };
        // SAFETY: the functions are found by their names; the device is of this instance.
        let device = unsafe { ash::Device::load_with(load, device) };
        let pool = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::TRANSIENT)
            .queue_family_index(family);
        // SAFETY: device and queue are living; the structures are complete.
        unsafe {
            let memory = instance.get_physical_device_memory_properties(physical_device);
            let queue = device.get_device_queue(family, queue_index);
            let formats = supported_formats(instance, physical_device);
            let pool = device.create_command_pool(&pool, None).map_err(failed("vkCreateCommandPool"))?;
            let fence = device.create_fence(&vk::FenceCreateInfo::default(), None).map_err(|error| {
                device.destroy_command_pool(pool, None);
                failed("vkCreateFence")(error)
            })?;
            Ok(Self { device, queue, memory, pool, fence, formats })
        }
    }

    /// Formats of swapchains on this device.
    pub fn formats(&self) -> &[vk::Format] {
        &self.formats
    }

    /// Runs commands on the queue and waits for them.
    pub fn run(&self, record: impl FnOnce(&ash::Device, vk::CommandBuffer)) -> Result<(), Fault> {
        let device = &self.device;
        let allocation =
            vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: pool, fence and queue are of this device; the runtime's lock makes this the only thread here, and the
        // specification keeps the application off the queue; the buffer is freed when the queue is done with it.
        unsafe {
            let buffers =
                device.allocate_command_buffers(&allocation).map_err(failed("vkAllocateCommandBuffers"))?;
            let submit = || {
                device.begin_command_buffer(buffers[0], &begin)?;
                record(device, buffers[0]);
                device.end_command_buffer(buffers[0])?;
                let submit = vk::SubmitInfo::default().command_buffers(&buffers);
                device.queue_submit(self.queue, &[submit], self.fence)?;
                device.wait_for_fences(&[self.fence], true, u64::MAX)?;
                device.reset_fences(&[self.fence])
            };
            let outcome = submit();
            device.free_command_buffers(self.pool, &buffers);
            outcome.map_err(failed("work on the queue"))
        }
    }

    /// Waits for all that the queue was given, by the application too.
    pub fn finish(&self) -> Result<(), Fault> {
        // SAFETY: the queue is of this device; called where the specification keeps the application off it.
        unsafe { self.device.queue_wait_idle(self.queue) }.map_err(failed("vkQueueWaitIdle"))
    }

    /// Memory for these requirements, with these properties.
    pub fn allocate(
        &self,
        requirements: vk::MemoryRequirements,
        properties: vk::MemoryPropertyFlags,
    ) -> Result<vk::DeviceMemory, Fault> {
        let types = self.memory.memory_types_as_slice();
        let fits = |index: &u32| {
            requirements.memory_type_bits & (1 << index) != 0
                && types[*index as usize].property_flags.contains(properties)
        };
        let index = (0..types.len() as u32).find(fits);
        let index = index.ok_or_else(|| Fault::runtime(format!("no memory type is {properties:?}")))?;
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(requirements.size).memory_type_index(index);
        // SAFETY: the type is one of the device's.
        unsafe { self.device.allocate_memory(&info, None) }.map_err(failed("vkAllocateMemory"))
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: made by this device, which outlives the session; `run` waits for its work, so that none is left.
        unsafe {
            self.device.destroy_fence(self.fence, None);
            self.device.destroy_command_pool(self.pool, None);
        }
    }
}

fn supported_formats(instance: &ash::Instance, device: vk::PhysicalDevice) -> Vec<vk::Format> {
    let supported = |format: &vk::Format| {
        let attachment = match format::is_depth(*format) {
            true => vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT,
            false => vk::FormatFeatureFlags::COLOR_ATTACHMENT,
        };
        // SAFETY: a device of this instance.
        let properties = unsafe { instance.get_physical_device_format_properties(device, *format) };
        properties.optimal_tiling_features.contains(attachment | vk::FormatFeatureFlags::SAMPLED_IMAGE)
    };
    format::COLOUR.into_iter().chain(format::DEPTH).filter(supported).collect()
}
