//! One device, found without a lock: engines draw ten thousand times a frame.

use crate::vk::armed::Armed;
use crate::vk::dispatch_key::DispatchKey;
use ash::vk;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};

/// That device, as [`crate::vk::recording::compute`] has one.
struct CachedDevice {
    /// 0: of none.
    key: AtomicUsize,
    armed: AtomicPtr<Armed>,
}

static CACHED_DEVICE: CachedDevice =
    CachedDevice { key: AtomicUsize::new(0), armed: AtomicPtr::new(ptr::null_mut()) };

/// No address of a dispatch table.
const RESERVED: usize = 1;

/// A device is made. The first one is found quickly as long as it lives.
pub fn device_made(key: DispatchKey, armed: &Arc<Armed>) {
    // Reserved first: two devices may be made at once.
    if armed.follows_passes()
        && CACHED_DEVICE.key.compare_exchange(0, RESERVED, Ordering::AcqRel, Ordering::Relaxed).is_ok()
    {
        CACHED_DEVICE.armed.store(Arc::as_ptr(armed).cast_mut(), Ordering::Relaxed);
        CACHED_DEVICE.key.store(key.address(), Ordering::Release);
    }
}

/// A device is about to be destroyed.
pub fn device_ends(key: DispatchKey) {
    let _ = CACHED_DEVICE.key.compare_exchange(key.address(), 0, Ordering::AcqRel, Ordering::Relaxed);
}

/// The device of a command buffer, where it is the one that is found quickly.
///
/// # Safety
///
/// `handle` is a live command buffer.
#[inline]
pub unsafe fn cached_device<'a>(handle: vk::CommandBuffer) -> Option<&'a Armed> {
    // SAFETY: the handle is live, as `# Safety` demands.
    let key = unsafe { DispatchKey::of(handle) }?;
    if CACHED_DEVICE.key.load(Ordering::Acquire) != key.address() {
        return None;
    }
    // SAFETY: stored before the key, from an object that lives as long as the device, which does not end while commands are recorded (external
    // synchronization of vkDestroyDevice).
    unsafe { CACHED_DEVICE.armed.load(Ordering::Relaxed).as_ref() }
}
