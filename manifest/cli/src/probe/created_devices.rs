//! Creating devices as a game does: with one queue, and no extension.

use crate::vulkan_devices::{entry, instance, text};
use ash::{Instance, vk};
use parafovea_manifest::doctor::CreatedDevice;
use std::ffi::CStr;

/// The Vulkan half's answer with its link to the OpenXR half (layer/src/link.rs).
const LINK_NAME: &CStr = c"vkGetParafoveaLink";

/// Creates a device of each physical device and destroys it, and the instance at last.
pub fn answer() -> Result<Vec<CreatedDevice>, String> {
    let entry = entry()?;
    let (instance, _) = instance(&entry)?;
    // SAFETY: a live instance, which is destroyed when nothing uses it any more.
    unsafe {
        let devices = instance
            .enumerate_physical_devices()
            .map(|devices| devices.iter().map(|device| create(&instance, *device)).collect())
            .map_err(|error| format!("vkEnumeratePhysicalDevices: {error}"));
        instance.destroy_instance(None);
        devices
    }
}

/// # Safety
///
/// A live instance, and a physical device of it.
unsafe fn create(instance: &Instance, device: vk::PhysicalDevice) -> CreatedDevice {
    let priorities = [1.0];
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&priorities)];
    let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues);
    // SAFETY: the caller vouches for the handles; every physical device has a queue family of index 0 with a queue.
    unsafe {
        let properties = instance.get_physical_device_properties(device);
        let name = properties.device_name_as_c_str().map(text).unwrap_or_default();
        match instance.create_device(device, &info, None) {
            Ok(made) => {
                let has_layer = instance.get_device_proc_addr(made.handle(), LINK_NAME.as_ptr()).is_some();
                made.destroy_device(None);
                CreatedDevice { name, failure: None, has_layer }
            }
            Err(error) => {
                let failure = Some(format!("vkCreateDevice: {error}"));
                CreatedDevice { name, failure, has_layer: false }
            }
        }
    }
}
