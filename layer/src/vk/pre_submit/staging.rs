//! A buffer that the CPU writes and copies read.

use super::Submitter;
use crate::gpu::memory::memory_type;
use crate::gpu::{GpuError, serial};
use ash::vk;

/// A buffer that stays mapped. [`Self::destroy`] ends it; dropped without that, it lives as long as its device.
pub struct Staging {
    buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    mapped: *mut u8,
    len: usize,
    serial: u64,
}

// SAFETY: the pointer is to memory that stays mapped as long as the value lives, and access to the memory takes `&mut`.
unsafe impl Send for Staging {}

// SAFETY: as above.
unsafe impl Sync for Staging {}

impl Staging {
    /// Of so many bytes, on the device of `own`.
    ///
    /// # Errors
    ///
    /// The device has no memory left.
    pub fn new(own: Submitter<'_>, len: usize) -> Result<Self, GpuError> {
        let device = &own.functions.device;
        let info = vk::BufferCreateInfo::default()
            .size(len as vk::DeviceSize)
            .usage(vk::BufferUsageFlags::TRANSFER_SRC)
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is live.
        let buffer =
            unsafe { device.create_buffer(&info, None) }.map_err(GpuError::from_call("vkCreateBuffer"))?;
        let (memory, mapped) = (vk::DeviceMemory::null(), std::ptr::null_mut());
        let mut staging = Self { buffer, memory, mapped, len, serial: serial() };
        // SAFETY: the buffer is new; where a later step fails, it is destroyed.
        match unsafe { staging.bind(own) } {
            Ok(()) => Ok(staging),
            Err(error) => {
                staging.destroy(device);
                Err(error)
            }
        }
    }

    /// # Safety
    ///
    /// The buffer is a new one of the live device.
    unsafe fn bind(&mut self, own: Submitter<'_>) -> Result<(), GpuError> {
        let device = &own.functions.device;
        let coherent = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        // SAFETY: the buffer is one of the live device, as `# Safety` demands, and the physical device is that of the device.
        let (requirements, memory) = unsafe {
            (
                device.get_buffer_memory_requirements(self.buffer),
                own.functions.instance.get_physical_device_memory_properties(own.record.physical_device),
            )
        };
        let kind = memory_type(&memory, requirements.memory_type_bits, coherent)
            .ok_or(GpuError::Unsupported("a device without a suitable memory type"))?;
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(requirements.size).memory_type_index(kind);
        // SAFETY: the buffer is new, so that no memory is bound to it; this memory is of the size and type that it requires, and visible to
        // the host.
        unsafe {
            self.memory =
                device.allocate_memory(&info, None).map_err(GpuError::from_call("vkAllocateMemory"))?;
            device
                .bind_buffer_memory(self.buffer, self.memory, 0)
                .map_err(GpuError::from_call("vkBindBufferMemory"))?;
            self.mapped = device
                .map_memory(self.memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())
                .map_err(GpuError::from_call("vkMapMemory"))?
                .cast();
        }
        Ok(())
    }

    /// The buffer.
    pub fn buffer(&self) -> vk::Buffer {
        self.buffer
    }

    /// A number that no other object has.
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Number of its bytes.
    #[allow(clippy::len_without_is_empty, reason = "a buffer of no bytes cannot be created")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Its bytes. The GPU reads them while a copy from them is pending: the caller writes none meanwhile.
    pub fn bytes(&mut self) -> &mut [u8] {
        // SAFETY: so much memory is mapped from there on, and `&mut self` allows no other access; a new buffer is always mapped.
        unsafe { std::slice::from_raw_parts_mut(self.mapped, self.len) }
    }

    /// Destroys it on its device. No copy from it is pending.
    pub fn destroy(self, device: &ash::Device) {
        // SAFETY: both are of this live device and in no command buffer that is pending; freeing unmaps.
        unsafe {
            device.destroy_buffer(self.buffer, None);
            device.free_memory(self.memory, None);
        }
    }
}
