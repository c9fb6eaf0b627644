//! Live instances.

use super::chain::GetPhysicalDeviceProcAddr;
use super::dispatch_key::DispatchKey;
use super::functions::InstanceTable;
use crate::registry::Registry;
use ash::vk;
use std::sync::Arc;

/// One live instance.
pub struct Instance {
    pub handle: vk::Instance,
    /// Whether its devices are armed.
    pub enabled: bool,
    /// The version that the application asked for.
    pub api_version: u32,
    /// The engine that it names (`VkApplicationInfo::pEngineName`); empty without.
    pub engine: String,
    pub next: InstanceTable,
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
}

static INSTANCES: Registry<DispatchKey, Instance> = Registry::new();

/// The instance that an instance or physical device handle belongs to.
///
/// # Safety
///
/// `object` is null, or a live instance or physical device.
pub unsafe fn of<H: vk::Handle>(object: H) -> Option<Arc<Instance>> {
    // SAFETY: the object is null or live, as `# Safety` demands.
    INSTANCES.get(unsafe { DispatchKey::of(object) }?)
}

/// The instance of that key.
pub fn get(key: DispatchKey) -> Option<Arc<Instance>> {
    INSTANCES.get(key)
}

/// Begins to track an instance.
pub fn insert(key: DispatchKey, instance: Arc<Instance>) {
    INSTANCES.insert(key, instance);
}

/// Forgets an instance.
pub fn remove(key: DispatchKey) {
    INSTANCES.remove(key);
}

/// The properties of a physical device, from the next layer.
///
/// # Safety
///
/// `physical_device` is a live one of `instance`.
pub unsafe fn properties(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
) -> vk::PhysicalDeviceProperties {
    let mut properties = vk::PhysicalDeviceProperties::default();
    // SAFETY: the next layer's function, a live physical device and a structure to write to.
    unsafe { (instance.next.physical_device_properties)(physical_device, &mut properties) };
    properties
}
