//! Buffers that live on the device, with a first content.

use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;

/// A buffer with memory of its own.
pub(crate) struct DeviceBuffer {
    // Dropped before the memory that it is bound to.
    buffer: Owned<vk::Buffer>,
    _memory: Owned<vk::DeviceMemory>,
}

impl DeviceBuffer {
    /// Makes a buffer of `size` bytes, at least 1, that holds what `write` writes into zeroes.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        usage: vk::BufferUsageFlags,
        size: u64,
        write: impl FnOnce(&mut [u8]),
    ) -> Result<Self, GpuError> {
        let size = size.max(1);
        let is_storage = usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER);
        if is_storage && size > u64::from(gpu.limits.max_storage_buffer_range) {
            return Err(GpuError::Unsupported("a storage buffer of this size"));
        }
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
        // SAFETY: both are new; the memory is what the buffer requires, hence as long as the slice, and mapped by nobody
        // else. Zeroes make it initialised before it is seen as a slice.
        unsafe {
            gpu.device
                .bind_buffer_memory(buffer.handle(), memory.handle(), 0)
                .map_err(GpuError::from_call("vkBindBufferMemory"))?;
            let mapped = gpu
                .device
                .map_memory(memory.handle(), 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())
                .map_err(GpuError::from_call("vkMapMemory"))?
                .cast::<u8>();
            mapped.write_bytes(0, size as usize);
            write(std::slice::from_raw_parts_mut(mapped, size as usize));
            gpu.device.unmap_memory(memory.handle());
        }
        Ok(Self { buffer, _memory: memory })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::Buffer {
        self.buffer.handle()
    }
}
