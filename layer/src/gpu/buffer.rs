//! Parameters for the GPU in a buffer that stays mapped, a part for each submit under way.

use super::{Gpu, GpuError, Owned, Recorder, SUBMITS_IN_FLIGHT};
use ash::vk;
use std::marker::PhantomData;
use std::ptr::NonNull;
use std::sync::Arc;

/// A ring of `T`s: room for a set number of them in each submit.
pub(crate) struct UniformRing<T> {
    // Dropped before the memory that it is bound to; freeing memory unmaps it.
    buffer: Owned<vk::Buffer>,
    _memory: Owned<vk::DeviceMemory>,
    mapped: NonNull<u8>,
    /// From one element to the next, bytes.
    stride: u32,
    per_submit: u32,
    element: PhantomData<T>,
}

// SAFETY: the pointer is to memory that `_memory` keeps mapped, and writing through it takes `&mut self`.
unsafe impl<T: Send> Send for UniformRing<T> {}

impl<T: bytemuck::Pod> UniformRing<T> {
    pub(crate) fn new(gpu: &Arc<Gpu>, per_submit: u32) -> Result<Self, GpuError> {
        // A power of two of at most 256.
        let alignment = gpu.limits.min_uniform_buffer_offset_alignment.max(1) as u32;
        let stride = (size_of::<T>() as u32).next_multiple_of(alignment);
        let size = u64::from(stride) * u64::from(per_submit) * SUBMITS_IN_FLIGHT as u64;
        let info = vk::BufferCreateInfo::default()
            .size(size)
            .usage(vk::BufferUsageFlags::UNIFORM_BUFFER)
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is live.
        let buffer = unsafe {
            let handle =
                gpu.device.create_buffer(&info, None).map_err(GpuError::from_call("vkCreateBuffer"))?;
            Owned::new(gpu, handle, |device, handle| device.destroy_buffer(handle, None))
        };
        // SAFETY: the buffer is a live one of this device.
        let requirements = unsafe { gpu.device.get_buffer_memory_requirements(buffer.handle()) };
        let coherent = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let memory = gpu.allocate(&requirements, coherent)?;
        // SAFETY: both are new; the memory is what the buffer requires, and not mapped yet.
        let mapped = unsafe {
            gpu.device
                .bind_buffer_memory(buffer.handle(), memory.handle(), 0)
                .map_err(GpuError::from_call("vkBindBufferMemory"))?;
            gpu.device
                .map_memory(memory.handle(), 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())
                .map_err(GpuError::from_call("vkMapMemory"))?
        };
        let mapped = NonNull::new(mapped.cast::<u8>())
            .ok_or(GpuError::Call { call: "vkMapMemory", result: vk::Result::ERROR_MEMORY_MAP_FAILED })?;
        Ok(Self { buffer, _memory: memory, mapped, stride, per_submit, element: PhantomData })
    }

    /// Writes element `index` of the submit that is being recorded; returns its offset in the buffer.
    pub(crate) fn write(&mut self, recorder: &Recorder, index: u32, value: &T) -> Result<u32, GpuError> {
        if index >= self.per_submit {
            return Err(GpuError::Invalid("more regions than a submit has room for"));
        }
        let offset = (recorder.slot() as u32 * self.per_submit + index) * self.stride;
        let bytes = bytemuck::bytes_of(value);
        // SAFETY: slot and index are in range, so this stays within the mapped buffer; the GPU does not read
        // it now, as the slot's last submit was waited for.
        unsafe {
            let target = self.mapped.as_ptr().add(offset as usize);
            std::ptr::copy_nonoverlapping(bytes.as_ptr(), target, bytes.len());
        }
        Ok(offset)
    }

    pub(super) fn gpu(&self) -> &Arc<Gpu> {
        self.buffer.gpu()
    }

    pub(super) fn handle(&self) -> vk::Buffer {
        self.buffer.handle()
    }
}
