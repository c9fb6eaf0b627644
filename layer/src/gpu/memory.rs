//! Device memory: one allocation for each of the few objects that need any.

use super::{Gpu, GpuError, Owned};
use ash::vk;
use std::sync::Arc;

impl Gpu {
    /// Allocates memory with all of `needed`.
    pub(super) fn allocate(
        self: &Arc<Self>,
        requirements: &vk::MemoryRequirements,
        needed: vk::MemoryPropertyFlags,
    ) -> Result<Owned<vk::DeviceMemory>, GpuError> {
        let kind = memory_type(&self.memory, requirements.memory_type_bits, needed)
            .ok_or(GpuError::Unsupported("a device without a suitable memory type"))?;
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(requirements.size).memory_type_index(kind);
        // SAFETY: the device is live and has that memory type.
        unsafe {
            let handle =
                self.device.allocate_memory(&info, None).map_err(GpuError::from_call("vkAllocateMemory"))?;
            Ok(Owned::new(self, handle, |device, handle| device.free_memory(handle, None)))
        }
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
