//! A stand-in for VK_EXT_memory_budget, with the remaining memory of [`BUDGET_VARIABLE`]; without the variable, the driver answers.

use super::{BUDGET_VARIABLE, Live};
use crate::layer::{hooks, instance_of};
use ash::vk;
use std::ffi::{CStr, c_char};

/// The hook for a question about a physical device.
pub(super) fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
    remaining()?;
    hooks! { name;
        c"vkEnumerateDeviceExtensionProperties": PFN_vkEnumerateDeviceExtensionProperties = extensions;
        c"vkGetPhysicalDeviceMemoryProperties2":
            PFN_vkGetPhysicalDeviceMemoryProperties2 = memory_properties2;
    }
    None
}

/// Memory that the system still has for the process, bytes.
fn remaining() -> Option<u64> {
    std::env::var(BUDGET_VARIABLE).ok()?.parse().ok()
}

/// # Safety
/// As `vkEnumerateDeviceExtensionProperties`.
unsafe extern "system" fn extensions(
    physical_device: vk::PhysicalDevice,
    layer: *const c_char,
    count: *mut u32,
    properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    // SAFETY: the caller's own arguments; of an array that is there, one more than the driver has is asked for and written where there is room.
    unsafe {
        let next =
            instance_of::<Live>(physical_device).and_then(|instance| instance.physical_device.extensions);
        let Some(next) = next else { return vk::Result::ERROR_UNKNOWN };
        if !layer.is_null() {
            return next(physical_device, layer, count, properties);
        }
        let mut known = 0;
        let result = next(physical_device, layer, &mut known, std::ptr::null_mut());
        if result != vk::Result::SUCCESS {
            return result;
        }
        let all = known + 1;
        if properties.is_null() {
            *count = all;
            return vk::Result::SUCCESS;
        }
        let room = *count;
        let result = next(physical_device, layer, count, properties);
        if result != vk::Result::SUCCESS || *count == room {
            return if room < all { vk::Result::INCOMPLETE } else { result };
        }
        let mut own = vk::ExtensionProperties::default().spec_version(vk::EXT_MEMORY_BUDGET_SPEC_VERSION);
        for (to, from) in own.extension_name.iter_mut().zip(vk::EXT_MEMORY_BUDGET_NAME.to_bytes_with_nul()) {
            *to = *from as c_char;
        }
        *properties.add(*count as usize) = own;
        *count += 1;
        vk::Result::SUCCESS
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceMemoryProperties2`.
unsafe extern "system" fn memory_properties2(
    physical_device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceMemoryProperties2<'_>,
) {
    // SAFETY: the caller's own arguments: a chain of structures, each of which begins as every one does.
    unsafe {
        let next = instance_of::<Live>(physical_device)
            .and_then(|instance| instance.physical_device.memory_properties2);
        let Some(next) = next else { return };
        next(physical_device, properties);
        let Some(remaining) = remaining() else { return };
        let mut chained = (*properties).p_next.cast::<vk::BaseOutStructure<'_>>();
        while let Some(structure) = chained.as_mut() {
            if structure.s_type == vk::StructureType::PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT {
                let budget = &mut *chained.cast::<vk::PhysicalDeviceMemoryBudgetPropertiesEXT<'_>>();
                for (has, used) in budget.heap_budget.iter_mut().zip(&budget.heap_usage) {
                    *has = used + remaining;
                }
            }
            chained = structure.p_next;
        }
    }
}
