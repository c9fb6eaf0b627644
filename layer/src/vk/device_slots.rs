//! A pointer for each of a few devices, found without a lock: engines draw ten thousand times a frame, on many threads.

use super::dispatch_key::DispatchKey;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};

/// Pointers by device. An entry changes only while its device is made or destroyed, when no other call has that device (external
/// synchronization of vkDestroyDevice), so that key and pointer belong together for a thread that finds its own device's key.
pub struct DeviceSlots([Slot; DeviceSlots::COUNT]);

struct Slot {
    /// 0: of none.
    key: AtomicUsize,
    pointer: AtomicPtr<()>,
}

/// No address of a dispatch table.
const RESERVED: usize = 1;

impl DeviceSlots {
    /// Applications have one device, besides one that they try capabilities with or that plays videos.
    const COUNT: usize = 4;

    /// No devices.
    pub const fn new() -> Self {
        Self(
            [const { Slot { key: AtomicUsize::new(0), pointer: AtomicPtr::new(ptr::null_mut()) } };
                Self::COUNT],
        )
    }

    /// Adds a device that is made, if there is room.
    pub fn add(&self, device: DispatchKey, pointer: *mut ()) {
        // Reserved first: two devices may be made at once.
        let reserve = |slot: &&Slot| {
            slot.key.compare_exchange(0, RESERVED, Ordering::AcqRel, Ordering::Relaxed).is_ok()
        };
        if let Some(slot) = self.0.iter().find(reserve) {
            slot.pointer.store(pointer, Ordering::Relaxed);
            slot.key.store(device.address(), Ordering::Release);
        }
    }

    /// Removes a device that is about to be destroyed.
    pub fn remove(&self, device: DispatchKey) {
        for slot in &self.0 {
            let _ = slot.key.compare_exchange(device.address(), 0, Ordering::AcqRel, Ordering::Relaxed);
        }
    }

    /// The pointer of a device; `None` if there was no room for it, or it was not added.
    #[inline]
    pub fn find(&self, device: DispatchKey) -> Option<*mut ()> {
        let slot = self.0.iter().find(|slot| slot.key.load(Ordering::Acquire) == device.address())?;
        Some(slot.pointer.load(Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_later_device_is_found_before_and_after_the_end_of_an_earlier_one() {
        let slots = DeviceSlots::new();
        let devices = [16usize, 32, 48, 64, 80].map(DispatchKey::from_address);
        let pointer = |index: usize| (index + 1) as *mut ();
        (0..4).for_each(|index| slots.add(devices[index], pointer(index)));
        slots.add(devices[4], pointer(4));
        assert_eq!(slots.find(devices[4]), None, "there are four");
        slots.remove(devices[0]);
        assert_eq!(slots.find(devices[0]), None);
        assert_eq!(slots.find(devices[3]), Some(pointer(3)));
        slots.add(devices[4], pointer(4));
        assert_eq!(slots.find(devices[4]), Some(pointer(4)));
    }
}
