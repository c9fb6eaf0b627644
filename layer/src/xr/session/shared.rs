//! Objects that sessions on one device share, from the first that needs it until the application destroys the device.

use crate::abi::guard;
use crate::gpu::{GpuError, Shared};
use crate::registry::Registry;
use crate::xr::vulkan_device::VulkanDevice;
use ash::vk;
use std::sync::Arc;

static SHARED: Registry<vk::Device, Shared> = Registry::new();

/// The shared objects of a device; the session's own if the end of the device would not be announced.
///
/// # Safety
///
/// The device is live, and outlives the session.
///
/// # Errors
///
/// [`GpuError::Missing`]; [`GpuError::Abandoned`] where an earlier session was refused all work.
pub unsafe fn on(device: &VulkanDevice) -> Result<Arc<Shared>, GpuError> {
    let handle = device.record.device;
    if let Some(known) = SHARED.get(handle) {
        return if known.is_given_up() { Err(GpuError::Abandoned) } else { Ok(known) };
    }
    // SAFETY: the device is live, as `# Safety` demands; `on_device_destroyed` below registers for its end, or else all ends with the session.
    let new = unsafe { Shared::new(&device.record) }?;
    Ok(if device.on_device_destroyed(ended) { SHARED.get_or_insert(handle, new) } else { new })
}

/// # Safety
///
/// The device is live ([`DestroyDeviceCallback`](crate::link::DestroyDeviceCallback)).
unsafe extern "C" fn ended(device: vk::Device) {
    guard(
        "the destruction of a device",
        || (),
        |_| {
            if let Some(shared) = SHARED.remove(device) {
                shared.end();
            }
        },
    );
}
