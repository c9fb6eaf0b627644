//! Parameters for the GPU, and results of it, in buffers that stay mapped, a part for each submit under way.

use super::memory::OwnedMemory;
use super::{Gpu, GpuError, Owned, SUBMITS_IN_FLIGHT, SlotIndex};
use ash::vk;
use std::marker::PhantomData;
use std::ptr::NonNull;
use std::sync::Arc;

/// A buffer that both the host and the GPU access.
struct MappedBuffer {
    // Dropped before the memory that it is bound to; freeing memory unmaps it.
    buffer: Owned<vk::Buffer>,
    _memory: OwnedMemory,
    mapped: NonNull<u8>,
    size: u64,
}

// SAFETY: the pointer is to memory that `_memory` keeps mapped, and writing through it takes `&mut self`.
unsafe impl Send for MappedBuffer {}

impl MappedBuffer {
    /// In memory with all that is `wished` for, if there is any.
    fn new(
        gpu: &Arc<Gpu>,
        size: u64,
        usage: vk::BufferUsageFlags,
        wished: vk::MemoryPropertyFlags,
    ) -> Result<Self, GpuError> {
        let info =
            vk::BufferCreateInfo::default().size(size).usage(usage).sharing_mode(vk::SharingMode::EXCLUSIVE);
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
            .allocate(&requirements, coherent | wished)
            .or_else(|_| gpu.allocate(&requirements, coherent))?;
        // SAFETY: both are new; the memory meets the buffer's requirements, and is not mapped yet.
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
        Ok(Self { buffer, _memory: memory, mapped, size })
    }

    /// Writes at an offset, bytes, where the GPU does not read now.
    fn write(&mut self, offset: u64, bytes: &[u8]) -> Result<(), GpuError> {
        if offset.checked_add(bytes.len() as u64).is_none_or(|end| end > self.size) {
            return Err(GpuError::Invalid("more parameters than fit in one submission"));
        }
        // SAFETY: this stays within the mapped buffer.
        unsafe {
            let target = self.mapped.as_ptr().add(offset as usize);
            std::ptr::copy_nonoverlapping(bytes.as_ptr(), target, bytes.len());
        }
        Ok(())
    }
}

/// A ring of words that shaders write and the host reads: room for a set number of them in each submit.
pub(crate) struct ResultRing {
    buffer: MappedBuffer,
    per_submit: u32,
}

impl ResultRing {
    pub(crate) fn new(gpu: &Arc<Gpu>, per_submit: u32) -> Result<Self, GpuError> {
        let size = u64::from(per_submit) * size_of::<u32>() as u64 * SUBMITS_IN_FLIGHT as u64;
        if size > u64::from(gpu.limits.max_storage_buffer_range) {
            return Err(GpuError::Unsupported("a storage buffer of this size"));
        }
        // Reads of uncached memory are slow.
        let cached = vk::MemoryPropertyFlags::HOST_CACHED;
        let mut buffer = MappedBuffer::new(gpu, size, vk::BufferUsageFlags::STORAGE_BUFFER, cached)?;
        buffer.write(0, &vec![0; size as usize])?;
        Ok(Self { buffer, per_submit })
    }

    /// The place in the buffer of result `at` of the slot's next submit.
    pub(crate) fn place(&self, slot: SlotIndex, at: u32) -> u32 {
        slot.get() as u32 * self.per_submit + at
    }

    /// Reads `count` results from a place on into `out`, in place of its content. The submit that wrote them has finished, after a
    /// [`super::Recorder::computed_to_host`].
    pub(crate) fn read(&self, place: u32, count: usize, out: &mut Vec<f32>) {
        let first = place as usize * size_of::<f32>();
        let bytes = count * size_of::<f32>();
        out.clear();
        if (first + bytes) as u64 > self.buffer.size {
            return;
        }
        out.resize(count, 0.0);
        // SAFETY: this stays within the mapped buffer, which was initialised, and which no submit writes there now; any bits make an
        // f32.
        unsafe {
            let source = self.buffer.mapped.as_ptr().add(first);
            std::ptr::copy_nonoverlapping(source, out.as_mut_ptr().cast::<u8>(), bytes);
        }
    }

    pub(super) fn handle(&self) -> vk::Buffer {
        self.buffer.buffer.handle()
    }
}

/// A size that commands read from memory when they run, so that recorded commands serve frames with other sizes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IndirectSize {
    pub(super) buffer: vk::Buffer,
    pub(super) offset: u64,
}

/// A ring of sizes of draws and dispatches: room for a set number of them in each submit.
pub(crate) struct IndirectRing {
    buffer: MappedBuffer,
    per_submit: u32,
}

impl IndirectRing {
    /// Bytes of a size: a VkDrawIndirectCommand, or a VkDispatchIndirectCommand.
    const STRIDE: u32 = size_of::<vk::DrawIndirectCommand>() as u32;

    pub(crate) fn new(gpu: &Arc<Gpu>, per_submit: u32) -> Result<Self, GpuError> {
        let size = u64::from(Self::STRIDE) * u64::from(per_submit) * SUBMITS_IN_FLIGHT as u64;
        // The GPU waits for each size before it begins the draw: not for the bus, where the host can write to the GPU's own memory.
        let local = vk::MemoryPropertyFlags::DEVICE_LOCAL;
        let buffer = MappedBuffer::new(gpu, size, vk::BufferUsageFlags::INDIRECT_BUFFER, local)?;
        Ok(Self { buffer, per_submit })
    }

    /// Writes element `index` of the slot's next submit: a draw of so many strips of four vertices, from the first one on. The GPU does
    /// not read that part now, as the slot's last submit was waited for.
    pub(crate) fn write_strips(
        &mut self,
        slot: SlotIndex,
        index: u32,
        instances: u32,
    ) -> Result<IndirectSize, GpuError> {
        // Another first instance is a feature of the device (drawIndirectFirstInstance).
        self.write(slot, index, [4, instances, 0, 0])
    }

    /// The same for a dispatch of so many workgroups, in a row.
    pub(crate) fn write_groups(
        &mut self,
        slot: SlotIndex,
        index: u32,
        groups: u32,
    ) -> Result<IndirectSize, GpuError> {
        self.write(slot, index, [groups, 1, 1, 0])
    }

    fn write(&mut self, slot: SlotIndex, index: u32, words: [u32; 4]) -> Result<IndirectSize, GpuError> {
        if index >= self.per_submit {
            return Err(GpuError::Invalid("more regions than fit in one submission"));
        }
        let element = slot.get() as u32 * self.per_submit + index;
        let offset = u64::from(element * Self::STRIDE);
        self.buffer.write(offset, bytemuck::bytes_of(&words))?;
        Ok(IndirectSize { buffer: self.buffer.buffer.handle(), offset })
    }
}

/// A ring of `T`s: room for a set number of them in each submit.
pub(crate) struct UniformRing<T> {
    buffer: MappedBuffer,
    /// From one element to the next, bytes.
    stride: u32,
    per_submit: u32,
    element: PhantomData<fn(T)>,
}

impl<T: bytemuck::Pod> UniformRing<T> {
    pub(crate) fn new(gpu: &Arc<Gpu>, per_submit: u32) -> Result<Self, GpuError> {
        // A power of two of at most 256.
        let limits = &gpu.limits;
        let alignment =
            limits.min_uniform_buffer_offset_alignment.max(limits.min_storage_buffer_offset_alignment);
        let alignment = alignment.max(1) as u32;
        let stride = (size_of::<T>() as u32).next_multiple_of(alignment);
        let size = u64::from(stride) * u64::from(per_submit) * SUBMITS_IN_FLIGHT as u64;
        let none = vk::MemoryPropertyFlags::empty();
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        let buffer = MappedBuffer::new(gpu, size, usage, none)?;
        Ok(Self { buffer, stride, per_submit, element: PhantomData })
    }

    /// Writes element `index` of the slot's next submit; returns its offset in the buffer. The GPU does not
    /// read that part now, as the slot's last submit was waited for.
    pub(crate) fn write(&mut self, slot: SlotIndex, index: u32, value: &T) -> Result<u32, GpuError> {
        if index >= self.per_submit {
            return Err(GpuError::Invalid("more regions than fit in one submission"));
        }
        let offset = (slot.get() as u32 * self.per_submit + index) * self.stride;
        self.buffer.write(offset.into(), bytemuck::bytes_of(value))?;
        Ok(offset)
    }

    pub(super) fn gpu(&self) -> &Arc<Gpu> {
        self.buffer.buffer.gpu()
    }

    pub(super) fn handle(&self) -> vk::Buffer {
        self.buffer.buffer.handle()
    }
}

/// A ring of words that shaders index themselves: room for a set number of them in each submit.
pub(crate) struct WordRing {
    buffer: MappedBuffer,
    per_submit: u32,
}

impl WordRing {
    pub(crate) fn new(gpu: &Arc<Gpu>, per_submit: u32) -> Result<Self, GpuError> {
        let size = u64::from(per_submit) * size_of::<u32>() as u64 * SUBMITS_IN_FLIGHT as u64;
        if size > u64::from(gpu.limits.max_storage_buffer_range) {
            return Err(GpuError::Unsupported("a storage buffer of this size"));
        }
        let none = vk::MemoryPropertyFlags::empty();
        let buffer = MappedBuffer::new(gpu, size, vk::BufferUsageFlags::STORAGE_BUFFER, none)?;
        Ok(Self { buffer, per_submit })
    }

    /// Number of words of each submit.
    pub(crate) fn per_submit(&self) -> u32 {
        self.per_submit
    }

    /// Writes words from place `at` of the slot's next submit on; returns their place in the buffer. The GPU does
    /// not read that part now, as the slot's last submit was waited for.
    pub(crate) fn write(&mut self, slot: SlotIndex, at: u32, words: &[u32]) -> Result<u32, GpuError> {
        if u64::from(at) + words.len() as u64 > u64::from(self.per_submit) {
            return Err(GpuError::Invalid("more words than fit in one submission"));
        }
        let place = slot.get() as u32 * self.per_submit + at;
        self.buffer.write(u64::from(place) * size_of::<u32>() as u64, bytemuck::cast_slice(words))?;
        Ok(place)
    }

    pub(super) fn handle(&self) -> vk::Buffer {
        self.buffer.buffer.handle()
    }
}
