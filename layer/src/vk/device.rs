//! Live devices.

use super::armed::Armed;
use super::dispatch_key::DispatchKey;
use super::functions::{ArmedTable, DeviceTable};
use crate::backend::attachment::RateAttachments;
use crate::backend::mask::Masks;
use crate::registry::Registry;
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// One live device.
pub struct Device {
    /// The state of an armed device; `None` for an inert one.
    pub armed: Option<Arc<Armed>>,
    pub next: DeviceTable,
    /// The next layer's functions under the hooks of armed devices.
    pub hooked: ArmedTable,
    pub get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
    /// Whether the OpenXR half finds it, if only to learn that it is inert.
    pub is_linked: bool,
    /// Number of OpenXR sessions that are bound to it.
    sessions: AtomicU32,
}

impl Device {
    /// A device that no session is bound to.
    pub fn new(
        armed: Option<Arc<Armed>>,
        next: DeviceTable,
        hooked: ArmedTable,
        get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
        is_linked: bool,
    ) -> Arc<Self> {
        let sessions = AtomicU32::new(0);
        Arc::new(Self { armed, next, hooked, get_device_proc_addr, is_linked, sessions })
    }

    /// An OpenXR session is bound to the device: it is active.
    pub fn bind_session(&self) {
        if self.sessions.fetch_add(1, Ordering::Relaxed) == 0 {
            tracing::info!("Vulkan device active");
        }
    }

    /// A session is bound to it no more. Returns whether none is now.
    pub fn unbind_session(&self) -> bool {
        let left = |sessions: u32| sessions.checked_sub(1);
        let is_last = self.sessions.fetch_update(Ordering::Relaxed, Ordering::Relaxed, left) == Ok(1);
        if is_last {
            tracing::info!("Vulkan device idle");
        }
        is_last
    }

    /// Its rate attachments; `None` without any.
    pub fn rate_attachments(&self) -> Option<&RateAttachments> {
        self.armed.as_ref()?.rate_attachments.as_deref()
    }

    /// Its masks; `None` without any.
    pub fn masks(&self) -> Option<&Masks> {
        self.armed.as_ref()?.masks.as_deref()
    }

    /// Whether an OpenXR session is bound to the device.
    pub fn is_active(&self) -> bool {
        self.sessions.load(Ordering::Relaxed) > 0
    }
}

static DEVICES: Registry<DispatchKey, Device> = Registry::new();

/// The device that a device, queue or command buffer belongs to.
///
/// # Safety
///
/// `object` is null, or a live object of one of these kinds.
pub unsafe fn of<H: vk::Handle>(object: H) -> Option<Arc<Device>> {
    // SAFETY: the object is null or live, as `# Safety` demands.
    DEVICES.get(unsafe { DispatchKey::of(object) }?)
}

/// The device that an object belongs to, with the next layer's function that `choose` names. Hooks are given out only where
/// there is that function, so that a call through one finds it.
///
/// # Safety
///
/// As for [`of`].
pub unsafe fn with<H: vk::Handle, F>(
    object: H,
    choose: impl FnOnce(&ArmedTable) -> Option<F>,
) -> Option<(Arc<Device>, F)> {
    // SAFETY: the handle is live, as `# Safety` demands.
    let device = unsafe { of(object) }?;
    let function = choose(&device.hooked)?;
    Some((device, function))
}

/// The device of that key.
pub fn get(key: DispatchKey) -> Option<Arc<Device>> {
    DEVICES.get(key)
}

/// Begins to track a device.
pub fn insert(key: DispatchKey, device: Arc<Device>) {
    DEVICES.insert(key, device);
}

/// Forgets a device.
pub fn remove(key: DispatchKey) {
    DEVICES.remove(key);
}
