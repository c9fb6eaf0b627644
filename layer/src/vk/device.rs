//! Live devices.

use super::armed::Armed;
use super::device_slots::DeviceSlots;
use super::dispatch_key::DispatchKey;
use super::functions::{ArmedTable, DeviceTable};
use crate::backend::attachment::RateAttachments;
use crate::backend::mask::Masks;
use crate::registry::Registry;
use ash::vk;
use std::ops::Deref;
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

    /// Unbinds an OpenXR session. Returns whether it was the last one.
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

/// Devices of [`DEVICES`], found without a lock.
static QUICK_DEVICES: DeviceSlots = DeviceSlots::new();

/// A live device during a call on one of its objects.
pub enum KnownDevice<'a> {
    /// Found without a lock; it does not end during the call (external synchronization of vkDestroyDevice).
    Quick(&'a Device),
    /// Any other.
    Kept(Arc<Device>),
}

impl Deref for KnownDevice<'_> {
    type Target = Device;

    fn deref(&self) -> &Device {
        match self {
            Self::Quick(device) => device,
            Self::Kept(device) => device,
        }
    }
}

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
/// As for [`of`]; and the object stays live as long as the result.
pub unsafe fn with<'a, H: vk::Handle, F>(
    object: H,
    choose: impl FnOnce(&ArmedTable) -> Option<F>,
) -> Option<(KnownDevice<'a>, F)> {
    // SAFETY: the object is null or live, as `# Safety` demands.
    let key = unsafe { DispatchKey::of(object) }?;
    let quick = QUICK_DEVICES.find(key).map(|device| device.cast_const().cast::<Device>());
    // SAFETY: the pointer was added from an object that is kept as long as the device lives.
    let device = match quick.and_then(|device| unsafe { device.as_ref() }) {
        Some(device) => KnownDevice::Quick(device),
        None => KnownDevice::Kept(DEVICES.get(key)?),
    };
    let function = choose(&device.hooked)?;
    Some((device, function))
}

/// The device of that key.
pub fn get(key: DispatchKey) -> Option<Arc<Device>> {
    DEVICES.get(key)
}

/// Begins to track a device.
pub fn insert(key: DispatchKey, device: Arc<Device>) {
    // Of one of the same key that was never destroyed.
    QUICK_DEVICES.remove(key);
    QUICK_DEVICES.add(key, Arc::as_ptr(&device).cast_mut().cast());
    DEVICES.insert(key, device);
}

/// Forgets a device.
pub fn remove(key: DispatchKey) {
    QUICK_DEVICES.remove(key);
    DEVICES.remove(key);
}
