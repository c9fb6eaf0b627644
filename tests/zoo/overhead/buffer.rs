//! Buffers that the CPU fills once.

use crate::device::Device;
use anyhow::Result;
use ash::vk;

/// A buffer of zeros.
pub struct Buffer<'a> {
    device: &'a Device,
    pub handle: vk::Buffer,
    memory: vk::DeviceMemory,
}

impl<'a> Buffer<'a> {
    /// Makes it.
    pub fn zeroed(device: &'a Device, size: u64, usage: vk::BufferUsageFlags) -> Result<Self> {
        let vk = &device.functions;
        let info = vk::BufferCreateInfo::default().size(size).usage(usage);
        let host = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        // SAFETY: plain use of Vulkan; the mapping is at least as large as the buffer.
        unsafe {
            let handle = vk.create_buffer(&info, None)?;
            let memory = device.allocate(vk.get_buffer_memory_requirements(handle), host)?;
            vk.bind_buffer_memory(handle, memory, 0)?;
            let mapped = vk.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())?;
            mapped.cast::<u8>().write_bytes(0, size as usize);
            vk.unmap_memory(memory);
            Ok(Self { device, handle, memory })
        }
    }
}

impl Drop for Buffer<'_> {
    fn drop(&mut self) {
        // SAFETY: the handles are this object's own, and the scene has waited.
        unsafe {
            self.device.functions.destroy_buffer(self.handle, None);
            self.device.functions.free_memory(self.memory, None);
        }
    }
}
