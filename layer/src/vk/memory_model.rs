//! The memory scope of our shaders on devices with the Vulkan memory model.
//!
//! Atomics of our shaders have the scope of the device. With `vulkanMemoryModel`, that scope needs a feature of its own
//! (VUID-RuntimeSpirv-vulkanMemoryModel-06265), which DXVK does not enable.

use super::instance::Instance;
use crate::abi::copies::{Copies, find};
use ash::vk;
use std::mem::transmute;

type Model<'a> = vk::PhysicalDeviceVulkanMemoryModelFeatures<'a>;
type Vulkan12<'a> = vk::PhysicalDeviceVulkan12Features<'a>;

/// The creation of a device with `vulkanMemoryModelDeviceScope` too, where the application enables the memory model alone and the device
/// has both; else as the application asks. Whether it differs.
///
/// # Safety
///
/// The physical device is a live one of the instance; `info` and its chain are valid, outlive `copies`, and are not used elsewhere
/// meanwhile. The result points to memory of `info` and of `copies`.
pub unsafe fn with_device_scope<'c>(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
    info: &vk::DeviceCreateInfo<'c>,
    copies: &mut Copies<'_>,
) -> (vk::DeviceCreateInfo<'c>, bool) {
    // SAFETY: the chain is valid, as `# Safety` demands.
    let (model, vulkan12) = unsafe { (find::<Model<'_>>(info.p_next), find::<Vulkan12<'_>>(info.p_next)) };
    let lacks_scope = |model, scope| model == vk::TRUE && scope == vk::FALSE;
    let in_model = model
        .is_some_and(|found| lacks_scope(found.vulkan_memory_model, found.vulkan_memory_model_device_scope));
    let in_12 = vulkan12
        .is_some_and(|found| lacks_scope(found.vulkan_memory_model, found.vulkan_memory_model_device_scope));
    // SAFETY: the physical device is a live one of the instance, as `# Safety` demands.
    if !(in_model || in_12) || !unsafe { has_device_scope(instance, physical_device) } {
        return (*info, false);
    }
    // SAFETY: the chain is valid, as above.
    let p_next = unsafe {
        if in_12 {
            copies.amend::<Vulkan12<'_>>(info.p_next, |found| {
                found.vulkan_memory_model_device_scope = vk::TRUE;
            })
        } else {
            copies.amend::<Model<'_>>(info.p_next, |found| found.vulkan_memory_model_device_scope = vk::TRUE)
        }
    };
    (vk::DeviceCreateInfo { p_next, ..*info }, true)
}

/// Whether a device has the feature.
///
/// # Safety
///
/// The physical device is a live one of the instance.
unsafe fn has_device_scope(instance: &Instance, physical_device: vk::PhysicalDevice) -> bool {
    // The memory model is a part of Vulkan 1.2, and an extension of 1.1.
    if instance.api_version < vk::API_VERSION_1_1 {
        return false;
    }
    let name = c"vkGetPhysicalDeviceFeatures2".as_ptr();
    // SAFETY: the next layer's function for a live instance.
    let found = unsafe { (instance.get_instance_proc_addr)(instance.handle, name) };
    // SAFETY: the name gives the type.
    let ask =
        unsafe { transmute::<vk::PFN_vkVoidFunction, Option<vk::PFN_vkGetPhysicalDeviceFeatures2>>(found) };
    let Some(ask) = ask else { return false };
    let mut model = Model::default();
    let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut model);
    // SAFETY: the handle is live, as `# Safety` demands; the chain is of structures to write to.
    unsafe { ask(physical_device, &mut all) };
    model.vulkan_memory_model_device_scope == vk::TRUE
}
