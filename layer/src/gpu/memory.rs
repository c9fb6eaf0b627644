//! Device memory: one allocation for each of the few objects that need any.

use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Memory of ours, which is freed and no longer counted when it is dropped.
pub(crate) struct OwnedMemory {
    memory: Owned<vk::DeviceMemory>,
    bytes: u64,
    heap: u32,
}

impl OwnedMemory {
    /// The handle, valid as long as `self`.
    pub(super) fn handle(&self) -> vk::DeviceMemory {
        self.memory.handle()
    }

    /// Its size, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The index of its heap.
    pub(super) fn heap(&self) -> u32 {
        self.heap
    }
}

impl Drop for OwnedMemory {
    fn drop(&mut self) {
        self.memory.gpu().memory_used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

impl Gpu {
    /// Allocates memory with all of `needed`.
    pub(super) fn allocate(
        self: &Arc<Self>,
        requirements: &vk::MemoryRequirements,
        needed: vk::MemoryPropertyFlags,
    ) -> Result<OwnedMemory, GpuError> {
        let kind = memory_type(&self.memory, requirements.memory_type_bits, needed)
            .ok_or(GpuError::Unsupported("a device without a suitable memory type"))?;
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(requirements.size).memory_type_index(kind);
        // SAFETY: the device is live and has that memory type.
        let memory = unsafe {
            let handle =
                self.device.allocate_memory(&info, None).map_err(GpuError::from_call("vkAllocateMemory"))?;
            Owned::new(self, handle, |device, handle| device.free_memory(handle, None))
        };
        let (bytes, heap) = (requirements.size, self.memory.memory_types[kind as usize].heap_index);
        self.memory_used.fetch_add(bytes, Ordering::Relaxed);
        Ok(OwnedMemory { memory, bytes, heap })
    }

    /// Memory of all objects that were made with it, bytes.
    pub fn memory_used(&self) -> u64 {
        self.memory_used.load(Ordering::Relaxed)
    }

    /// Memory of a heap that the system still has for this process, bytes; `None` if the device does not report it (VK_EXT_memory_budget).
    pub(crate) fn remaining_memory(&self, heap: u32) -> Option<u64> {
        // SAFETY: the physical device is one of this live instance.
        unsafe { self.budget.as_ref()?.remaining(self.physical_device, heap) }
    }
}

/// The first memory type among `allowed` (a bit each) with all of `needed`: drivers list better ones first.
pub(crate) fn memory_type(
    memory: &vk::PhysicalDeviceMemoryProperties,
    allowed: u32,
    needed: vk::MemoryPropertyFlags,
) -> Option<u32> {
    let types = memory.memory_types_as_slice();
    (0u32..)
        .zip(types)
        .find(|(index, kind)| allowed & (1 << index) != 0 && kind.property_flags.contains(needed))
        .map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_allowed_type_with_the_properties_is_taken() {
        let (local, visible) = (vk::MemoryPropertyFlags::DEVICE_LOCAL, vk::MemoryPropertyFlags::HOST_VISIBLE);
        let mut memory = vk::PhysicalDeviceMemoryProperties { memory_type_count: 3, ..Default::default() };
        for (kind, flags) in memory.memory_types.iter_mut().zip([visible, local, local | visible]) {
            kind.property_flags = flags;
        }
        assert_eq!(memory_type(&memory, 0b111, local), Some(1));
        assert_eq!(memory_type(&memory, 0b101, local), Some(2));
        assert_eq!(memory_type(&memory, 0b001, local), None);
        assert_eq!(memory_type(&memory, 0b111, local | visible), Some(2));
    }
}
