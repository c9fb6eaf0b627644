//! The Vulkan loader's side of the layer interface (`vulkan/vk_layer.h`), written apart from the layer's own
//! version, so that a mistake in one of them shows.

use ash::vk;
use std::ffi::{c_char, c_void};

/// `VK_LAYER_LINK_INFO`.
const LINK_INFO: i32 = 0;

/// `PFN_GetPhysicalDeviceProcAddr`.
pub(crate) type GetPhysicalDeviceProcAddr =
    unsafe extern "system" fn(vk::Instance, *const c_char) -> vk::PFN_vkVoidFunction;

/// `VkNegotiateLayerInterface`.
#[repr(C)]
pub struct NegotiateLayerInterface {
    s_type: i32,
    p_next: *mut c_void,
    pub(crate) version: u32,
    pub(crate) get_instance_proc_addr: Option<vk::PFN_vkGetInstanceProcAddr>,
    pub(crate) get_device_proc_addr: Option<vk::PFN_vkGetDeviceProcAddr>,
    pub(crate) get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
}

/// `VkLayerInstanceLink`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct InstanceLink {
    next: *mut InstanceLink,
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
}

/// `VkLayerDeviceLink`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct DeviceLink {
    next: *mut DeviceLink,
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
}

/// `VkLayerInstanceCreateInfo` and `VkLayerDeviceCreateInfo`, with a link according to `function`.
#[repr(C)]
struct LayerCreateInfo<Link> {
    s_type: vk::StructureType,
    p_next: *const c_void,
    function: i32,
    link: *mut Link,
}

/// Takes the next layer out of the loader's structure in an instance's chain, and moves the structure on.
///
/// # Safety
///
/// `p_next` is the chain of a VkInstanceCreateInfo that a Vulkan loader passed.
pub(crate) unsafe fn advance_instance(p_next: *const c_void) -> InstanceLink {
    // SAFETY: the type belongs to the structure.
    unsafe {
        let info = find(p_next, vk::StructureType::LOADER_INSTANCE_CREATE_INFO);
        let info: *mut LayerCreateInfo<InstanceLink> = info.cast();
        let link = *(*info).link;
        (*info).link = link.next;
        link
    }
}

/// As [`advance_instance`], for a device.
///
/// # Safety
///
/// `p_next` is the chain of a VkDeviceCreateInfo that a Vulkan loader passed.
pub(crate) unsafe fn advance_device(p_next: *const c_void) -> DeviceLink {
    // SAFETY: the type belongs to the structure.
    unsafe {
        let info = find(p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO);
        let info: *mut LayerCreateInfo<DeviceLink> = info.cast();
        let link = *(*info).link;
        (*info).link = link.next;
        link
    }
}

/// The loader's structure with a link; a chain without one is a bug of the loader's, which ends the test.
///
/// # Safety
///
/// `at` is a valid chain.
unsafe fn find(mut at: *const c_void, loader: vk::StructureType) -> *mut c_void {
    loop {
        assert!(!at.is_null(), "the Vulkan loader gave this layer no link to the next");
        // SAFETY: every structure of a chain starts with a type and a pointer; the loader's have `function`
        // behind those.
        unsafe {
            let header: *const vk::BaseInStructure<'_> = at.cast();
            let info: *const LayerCreateInfo<c_void> = at.cast();
            if (*header).s_type == loader && (*info).function == LINK_INFO {
                return at.cast_mut();
            }
            at = (*header).p_next.cast();
        }
    }
}
