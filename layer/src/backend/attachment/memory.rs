//! Memory of rate images: many small ones share an allocation, of which a device has few.

use ash::vk;

/// Size of an allocation that images share, bytes: a map of 256x256 texels has 64 KiB.
const BLOCK: vk::DeviceSize = 1 << 20;

/// One allocation. Freed ranges are used again once all of it is free.
#[derive(Debug)]
struct Block {
    memory: vk::DeviceMemory,
    kind: u32,
    size: vk::DeviceSize,
    used: vk::DeviceSize,
    live: usize,
}

/// Allocations of device memory, in which places are handed out one behind the other.
#[derive(Debug, Default)]
pub struct Memory {
    blocks: Vec<Block>,
}

/// Location of an image's memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Suballocation {
    /// The allocation.
    pub memory: vk::DeviceMemory,
    /// First byte in it.
    pub offset: vk::DeviceSize,
}

impl Memory {
    /// Reserves a place in an existing allocation of a memory type.
    pub fn take(&mut self, requirements: &vk::MemoryRequirements, kind: u32) -> Option<Suballocation> {
        let offset_in = |block: &Block| block.used.next_multiple_of(requirements.alignment.max(1));
        let fits =
            |block: &&mut Block| block.kind == kind && offset_in(block) + requirements.size <= block.size;
        let block = self.blocks.iter_mut().find(fits)?;
        let offset = offset_in(block);
        block.used = offset + requirements.size;
        block.live += 1;
        Some(Suballocation { memory: block.memory, offset })
    }

    /// Size of an allocation with a place for these, bytes.
    pub fn allocation_for(requirements: &vk::MemoryRequirements) -> vk::DeviceSize {
        requirements.size.max(BLOCK)
    }

    /// A place in a new allocation, of [`Self::allocation_for`].
    pub fn add(
        &mut self,
        memory: vk::DeviceMemory,
        kind: u32,
        requirements: &vk::MemoryRequirements,
    ) -> Suballocation {
        let size = Self::allocation_for(requirements);
        self.blocks.push(Block { memory, kind, size, used: requirements.size, live: 1 });
        Suballocation { memory, offset: 0 }
    }

    /// Takes a place back.
    pub fn give_back(&mut self, allocation: Suballocation) {
        if let Some(block) = self.blocks.iter_mut().find(|block| block.memory == allocation.memory) {
            block.live = block.live.saturating_sub(1);
            if block.live == 0 {
                block.used = 0;
            }
        }
    }

    /// All allocations, which are no longer its own.
    pub fn take_all(&mut self) -> impl Iterator<Item = vk::DeviceMemory> {
        self.blocks.drain(..).map(|block| block.memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::Handle;
    use std::cell::Cell;

    fn of(size: vk::DeviceSize, alignment: vk::DeviceSize) -> vk::MemoryRequirements {
        vk::MemoryRequirements { size, alignment, memory_type_bits: 1 }
    }

    /// Makes allocations as they are needed, and counts them.
    fn take(
        memory: &mut Memory,
        kind: u32,
        requirements: vk::MemoryRequirements,
        made: &Cell<u64>,
    ) -> Suballocation {
        memory.take(&requirements, kind).unwrap_or_else(|| {
            made.set(made.get() + 1);
            memory.add(vk::DeviceMemory::from_raw(made.get()), kind, &requirements)
        })
    }

    #[test]
    fn small_images_share_an_allocation_without_overlap() {
        let made = Cell::new(0);
        let mut memory = Memory::default();
        let small = of(4096 + 1, 256);
        let places: Vec<Suballocation> = (0..300).map(|_| take(&mut memory, 0, small, &made)).collect();
        assert_eq!(made.get(), 2, "300 of 4 KiB and a bit");
        for (index, allocation) in places.iter().enumerate() {
            assert_eq!(allocation.offset % 256, 0);
            for other in &places[..index] {
                let apart = allocation.offset.abs_diff(other.offset) > 4096;
                assert!(allocation.memory != other.memory || apart, "{allocation:?} {other:?}");
            }
        }
        take(&mut memory, 3, of(16, 1), &made);
        assert_eq!(made.get(), 3, "another type of memory");
        places.into_iter().for_each(|allocation| memory.give_back(allocation));
        for _ in 0..300 {
            take(&mut memory, 0, small, &made);
        }
        assert_eq!(made.get(), 3, "what is free is used again");
        let large = of(2 * BLOCK, 256);
        assert_eq!(Memory::allocation_for(&large), 2 * BLOCK);
        take(&mut memory, 0, large, &made);
        assert_eq!(made.get(), 4);
        assert_eq!(memory.take_all().count(), 4);
    }
}
