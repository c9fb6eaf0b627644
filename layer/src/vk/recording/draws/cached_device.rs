//! Devices whose draws are counted, found without a lock.

use crate::vk::armed::Armed;
use crate::vk::device_slots::DeviceSlots;
use crate::vk::dispatch_key::DispatchKey;
use ash::vk;
use std::sync::Arc;

static DEVICES: DeviceSlots = DeviceSlots::new();

/// A device is made.
pub fn device_made(key: DispatchKey, armed: &Arc<Armed>) {
    if armed.follows_passes() {
        DEVICES.add(key, Arc::as_ptr(armed).cast_mut().cast());
    }
}

/// A device is about to be destroyed.
pub fn device_ends(key: DispatchKey) {
    DEVICES.remove(key);
}

/// The device of a command buffer, if its passes are followed; `None` also for one device of very many.
///
/// # Safety
///
/// `handle` is a live command buffer.
#[inline]
pub unsafe fn cached_device<'a>(handle: vk::CommandBuffer) -> Option<&'a Armed> {
    // SAFETY: the handle is live, as `# Safety` demands.
    let key = unsafe { DispatchKey::of(handle) }?;
    // SAFETY: the pointer was added from an object that lives as long as the device, which does not end while commands are recorded (external
    // synchronization of vkDestroyDevice).
    unsafe { DEVICES.find(key)?.cast::<Armed>().as_ref() }
}
