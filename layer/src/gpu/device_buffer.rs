//! Buffers that live on the device.

use super::memory::OwnedMemory;
use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;

/// A buffer with memory of its own.
pub(crate) struct DeviceBuffer {
    // Dropped before the memory that it is bound to.
    buffer: Owned<vk::Buffer>,
    memory: OwnedMemory,
}

impl DeviceBuffer {
    /// Makes a buffer of `size` bytes, at least 1, with the content that `write` writes into zeroes.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        usage: vk::BufferUsageFlags,
        size: u64,
        write: impl FnOnce(&mut [u8]),
    ) -> Result<Self, GpuError> {
        let size = size.max(1);
        let coherent = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let made = Self::bound(gpu, usage, size, |requirements| {
            gpu.allocate(requirements, coherent | vk::MemoryPropertyFlags::DEVICE_LOCAL)
                .or_else(|_| gpu.allocate(requirements, coherent))
        })?;
        // SAFETY: the memory meets the buffer's requirements, hence is as long as the slice, and no other code maps it. Zeroes make it initialised
        // before it is used as a slice.
        unsafe {
            let memory = made.memory.handle();
            let mapped = gpu
                .device
                .map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())
                .map_err(GpuError::from_call("vkMapMemory"))?
                .cast::<u8>();
            mapped.write_bytes(0, size as usize);
            write(std::slice::from_raw_parts_mut(mapped, size as usize));
            gpu.device.unmap_memory(memory);
        }
        Ok(made)
    }

    /// Makes a buffer that holds `bytes`.
    pub(crate) fn holding(
        gpu: &Arc<Gpu>,
        usage: vk::BufferUsageFlags,
        bytes: &[u8],
    ) -> Result<Self, GpuError> {
        Self::new(gpu, usage, bytes.len() as u64, |content| {
            content[..bytes.len()].copy_from_slice(bytes);
        })
    }

    /// Makes a buffer of `size` bytes, at least 1, where the device is fastest. Its content is undefined.
    pub(crate) fn without_content(
        gpu: &Arc<Gpu>,
        usage: vk::BufferUsageFlags,
        size: u64,
    ) -> Result<Self, GpuError> {
        Self::bound(gpu, usage, size.max(1), |requirements| {
            gpu.allocate(requirements, vk::MemoryPropertyFlags::DEVICE_LOCAL)
        })
    }

    fn bound(
        gpu: &Arc<Gpu>,
        usage: vk::BufferUsageFlags,
        size: u64,
        allocate: impl FnOnce(&vk::MemoryRequirements) -> Result<OwnedMemory, GpuError>,
    ) -> Result<Self, GpuError> {
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
        let memory = allocate(&requirements)?;
        // SAFETY: both are new, and the memory meets the buffer's requirements.
        unsafe { gpu.device.bind_buffer_memory(buffer.handle(), memory.handle(), 0) }
            .map_err(GpuError::from_call("vkBindBufferMemory"))?;
        Ok(Self { buffer, memory })
    }

    /// The handle, valid as long as `self`.
    pub(crate) fn handle(&self) -> vk::Buffer {
        self.buffer.handle()
    }
}
