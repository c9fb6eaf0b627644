//! Memory that the system still has for this process on a device: VK_EXT_memory_budget.

use crate::link::DeviceRecord;
use ash::vk;
use std::ffi::CStr;
use std::mem::transmute;

/// The budget query of a device that has the extension. It belongs to the physical device, so that it need not be enabled.
pub(super) struct MemoryBudget(vk::PFN_vkGetPhysicalDeviceMemoryProperties2);

impl MemoryBudget {
    /// `None` where the device lacks the extension, or the application asked for Vulkan 1.0.
    ///
    /// # Safety
    /// `record` is of a live device.
    pub(super) unsafe fn of(record: &DeviceRecord) -> Option<Self> {
        if record.api_version < vk::API_VERSION_1_1 {
            return None;
        }
        // SAFETY: the instance is live, as `# Safety` demands; the names are C strings and give the functions' types.
        let (extensions, get) = unsafe {
            let function = |name: &CStr| (record.next_get_instance_proc_addr)(record.instance, name.as_ptr());
            let extensions = transmute::<
                vk::PFN_vkVoidFunction,
                Option<vk::PFN_vkEnumerateDeviceExtensionProperties>,
            >(function(c"vkEnumerateDeviceExtensionProperties"))?;
            let get = transmute::<
                vk::PFN_vkVoidFunction,
                Option<vk::PFN_vkGetPhysicalDeviceMemoryProperties2>,
            >(function(c"vkGetPhysicalDeviceMemoryProperties2"))?;
            (extensions, get)
        };
        let (device, no_layer) = (record.physical_device, std::ptr::null());
        let mut count = 0;
        // SAFETY: the physical device is live, as above; without room the count is asked for.
        unsafe { extensions(device, no_layer, &mut count, std::ptr::null_mut()) }.result().ok()?;
        let mut all = vec![vk::ExtensionProperties::default(); count as usize];
        // SAFETY: as above; there is room for as many extensions as the count states.
        unsafe { extensions(device, no_layer, &mut count, all.as_mut_ptr()) }.result().ok()?;
        let is_it = |extension: &vk::ExtensionProperties| {
            extension.extension_name_as_c_str() == Ok(vk::EXT_MEMORY_BUDGET_NAME)
        };
        all.iter().any(is_it).then_some(Self(get))
    }

    /// Memory of a heap beyond that in use, bytes.
    ///
    /// # Safety
    /// The physical device is the one of [`Self::of`], and live.
    pub(super) unsafe fn remaining(&self, device: vk::PhysicalDevice, heap: u32) -> Option<u64> {
        let mut budget = vk::PhysicalDeviceMemoryBudgetPropertiesEXT::default();
        let mut properties = vk::PhysicalDeviceMemoryProperties2::default().push_next(&mut budget);
        // SAFETY: the physical device is live and has the extension, as `# Safety` demands; the structures outlive the call.
        unsafe { (self.0)(device, &mut properties) };
        let heap = heap as usize;
        let (has, used) = (budget.heap_budget.get(heap)?, budget.heap_usage.get(heap)?);
        Some(has.saturating_sub(*used))
    }
}
