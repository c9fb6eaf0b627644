//! Buffers that shaders read as a whole.

use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;

/// A storage buffer with memory of its own, that copies write and indirect commands read too.
pub(crate) struct StorageBuffer {
    // Dropped before the memory that it is bound to.
    buffer: Owned<vk::Buffer>,
    _memory: Owned<vk::DeviceMemory>,
    words: usize,
}

impl StorageBuffer {
    /// Makes a buffer of `words` 32-bit words that begins with those of `content`.
    pub(crate) fn new(gpu: &Arc<Gpu>, words: usize, content: &[u32]) -> Result<Self, GpuError> {
        let words = words.max(content.len()).max(1);
        let size = words as u64 * 4;
        if size > u64::from(gpu.limits.max_storage_buffer_range) {
            return Err(GpuError::Unsupported("a storage buffer of this size"));
        }
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::INDIRECT_BUFFER
            | vk::BufferUsageFlags::TRANSFER_DST;
        let info = vk::BufferCreateInfo::default().size(size).usage(usage);
        // SAFETY: the device is live.
        let buffer = unsafe {
            let handle =
                gpu.device.create_buffer(&info, None).map_err(GpuError::from_call("vkCreateBuffer"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_buffer(handle, None))
        };
        // SAFETY: the buffer is a live one of this device.
        let requirements = unsafe { gpu.device.get_buffer_memory_requirements(buffer.handle()) };
        let coherent = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let memory = gpu
            .allocate(&requirements, coherent | vk::MemoryPropertyFlags::DEVICE_LOCAL)
            .or_else(|_| gpu.allocate(&requirements, coherent))?;
        // SAFETY: both are new; the memory is what the buffer requires, hence as long as the content, and not mapped yet.
        unsafe {
            gpu.device
                .bind_buffer_memory(buffer.handle(), memory.handle(), 0)
                .map_err(GpuError::from_call("vkBindBufferMemory"))?;
            let mapped = gpu
                .device
                .map_memory(memory.handle(), 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())
                .map_err(GpuError::from_call("vkMapMemory"))?;
            std::ptr::copy_nonoverlapping(content.as_ptr(), mapped.cast::<u32>(), content.len());
            gpu.device.unmap_memory(memory.handle());
        }
        Ok(Self { buffer, _memory: memory, words })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::Buffer {
        self.buffer.handle()
    }

    /// Number of 32-bit words.
    pub(crate) fn words(&self) -> usize {
        self.words
    }
}
