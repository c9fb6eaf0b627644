//! Buffers that the host writes.

use super::{Gpu, Made};
use anyhow::Result;
use ash::vk;
use std::hash::{DefaultHasher, Hash, Hasher};

/// A buffer in memory that stays mapped.
#[derive(Clone, Copy)]
pub struct Buffer {
    pub handle: vk::Buffer,
    mapped: *mut u8,
    size: usize,
}

// SAFETY: the mapped memory belongs to no thread, and lives as long as the device's objects.
unsafe impl Send for Buffer {}

impl Buffer {
    /// Writes bytes, which the device sees in later submits.
    ///
    /// The caller makes sure that no submitted work reads them any more.
    pub fn write(&self, offset: usize, bytes: &[u8]) {
        assert!(offset + bytes.len() <= self.size, "written inside the buffer");
        // SAFETY: the mapping is as long as the buffer and is only ever written through here.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.mapped.add(offset), bytes.len()) };
    }

    /// A checksum of the content.
    ///
    /// The caller makes sure that all work that writes it has finished.
    pub fn checksum(&self) -> u64 {
        // SAFETY: the mapping is as long as the buffer, and nothing writes to it meanwhile.
        let bytes = unsafe { std::slice::from_raw_parts(self.mapped, self.size) };
        let mut hasher = DefaultHasher::new();
        bytes.hash(&mut hasher);
        hasher.finish()
    }
}

impl Gpu {
    /// Device address of a buffer, on a device with that feature enabled.
    pub fn address(&self, buffer: &Buffer) -> vk::DeviceAddress {
        let info = vk::BufferDeviceAddressInfo::default().buffer(buffer.handle);
        // SAFETY: the buffer is live and was made for it; the style's needs hold Vulkan 1.2 and the feature.
        unsafe { self.device.get_buffer_device_address(&info) }
    }

    /// Makes a buffer of so many bytes, and keeps it.
    ///
    /// # Errors
    /// Errors of the calls.
    pub fn buffer(&self, size: usize, usage: vk::BufferUsageFlags) -> Result<Buffer> {
        let address = if self.has_addresses {
            vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS
        } else {
            vk::BufferUsageFlags::empty()
        };
        let info = vk::BufferCreateInfo::default()
            .size(size as u64)
            .usage(usage | address)
            .sharing_mode(self.sharing().0)
            .queue_family_indices(self.sharing().1);
        // SAFETY: the structure outlives the call.
        let handle = unsafe { self.device.create_buffer(&info, None) }?;
        self.keep(Made::Buffer(handle));
        // SAFETY: the buffer is live.
        let needs = unsafe { self.device.get_buffer_memory_requirements(handle) };
        let properties = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let memory = self.memory(needs, properties)?;
        // SAFETY: both are live, the memory is as large and of the type that the buffer needs, and host-visible.
        let mapped = unsafe {
            self.device.bind_buffer_memory(handle, memory, 0)?;
            self.device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())?
        };
        Ok(Buffer { handle, mapped: mapped.cast(), size })
    }
}
