//! The Vulkan loader's side of the layer interface: the structures of `vk_layer.h`, which ash leaves out.
//!
//! Source: `vulkan/vk_layer.h` and "Layer Interface" of the Vulkan loader's documentation
//! (LoaderLayerInterface.md).

use crate::abi::pnext;
use ash::vk;
use std::ffi::{c_char, c_void};

/// `VK_LAYER_LINK_INFO`: the structure carries the list of the layers below.
pub const LINK_INFO: i32 = 0;

/// `VK_LOADER_DATA_CALLBACK`: the structure carries a callback that initialises dispatchable objects.
pub const LOADER_DATA_CALLBACK: i32 = 1;

/// `LAYER_NEGOTIATE_INTERFACE_STRUCT`.
pub const NEGOTIATE_INTERFACE_STRUCT: i32 = 1;

/// The interface version that this layer speaks.
pub const INTERFACE_VERSION: u32 = 2;

/// `PFN_GetPhysicalDeviceProcAddr`: it has the shape of `vkGetInstanceProcAddr`.
pub type GetPhysicalDeviceProcAddr =
    unsafe extern "system" fn(vk::Instance, *const c_char) -> vk::PFN_vkVoidFunction;

/// `PFN_vkSetDeviceLoaderData`.
pub type SetDeviceLoaderData = unsafe extern "system" fn(vk::Device, *mut c_void) -> vk::Result;

/// `VkNegotiateLayerInterface`: the first exchange of the loader and a layer.
#[repr(C)]
pub struct NegotiateLayerInterface {
    /// Always 1, `LAYER_NEGOTIATE_INTERFACE_STRUCT`.
    pub s_type: i32,
    /// Always null.
    pub p_next: *mut c_void,
    /// In: the newest version that the loader speaks. Out: the version that both speak.
    pub loader_layer_interface_version: u32,
    /// Out: the layer's `vkGetInstanceProcAddr`.
    pub get_instance_proc_addr: Option<vk::PFN_vkGetInstanceProcAddr>,
    /// Out: the layer's `vkGetDeviceProcAddr`.
    pub get_device_proc_addr: Option<vk::PFN_vkGetDeviceProcAddr>,
    /// Out: the layer's `vk_layerGetPhysicalDeviceProcAddr`.
    pub get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
}

/// `VkLayerInstanceLink`: one layer of an instance's chain.
#[repr(C)]
pub struct InstanceLink {
    pub next: *mut InstanceLink,
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
}

/// `VkLayerDeviceLink`: one layer of a device's chain.
#[repr(C)]
pub struct DeviceLink {
    pub next: *mut DeviceLink,
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
}

/// `VkLayerInstanceCreateInfo`, in the pNext chain of `VkInstanceCreateInfo`.
#[repr(C)]
pub struct LayerInstanceCreateInfo {
    pub s_type: vk::StructureType,
    pub p_next: *const c_void,
    pub function: i32,
    pub payload: InstancePayload,
}

/// The payload of [`LayerInstanceCreateInfo`], chosen by `function`.
#[repr(C)]
pub union InstancePayload {
    pub link: *mut InstanceLink,
    pub other: *mut c_void,
}

/// `VkLayerDeviceCreateInfo`, in the pNext chain of `VkDeviceCreateInfo`.
#[repr(C)]
pub struct LayerDeviceCreateInfo {
    pub s_type: vk::StructureType,
    pub p_next: *const c_void,
    pub function: i32,
    pub payload: DevicePayload,
}

/// The payload of [`LayerDeviceCreateInfo`], chosen by `function`.
#[repr(C)]
pub union DevicePayload {
    pub link: *mut DeviceLink,
    pub set_device_loader_data: Option<SetDeviceLoaderData>,
}

/// The next layer of an instance's chain.
#[derive(Clone, Copy)]
pub struct NextInstance {
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_physical_device_proc_addr: Option<GetPhysicalDeviceProcAddr>,
}

/// The next layer of a device's chain.
#[derive(Clone, Copy)]
pub struct NextDevice {
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    pub get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
    pub set_device_loader_data: Option<SetDeviceLoaderData>,
}

/// Address of the link to the next layer, in the loader's structure of an instance's chain. `None` if the chain has no such structure.
///
/// # Safety
///
/// As for [`advance_instance`].
pub unsafe fn instance_link(info: *const vk::InstanceCreateInfo<'_>) -> Option<*mut *mut InstanceLink> {
    // SAFETY: `info` is null or valid with its chain, as `# Safety` demands; a loader structure has the layout of
    // LayerInstanceCreateInfo, its `function` determines which member of the union is set.
    unsafe {
        structures(info.as_ref()?.p_next, vk::StructureType::LOADER_INSTANCE_CREATE_INFO)
            .map(|found| found.cast::<LayerInstanceCreateInfo>())
            .find(|found| (**found).function == LINK_INFO)
            .map(|found| &raw mut (*found).payload.link)
    }
}

/// As [`instance_link`], for a device.
///
/// # Safety
///
/// As for [`advance_instance`].
pub unsafe fn device_link(info: *const vk::DeviceCreateInfo<'_>) -> Option<*mut *mut DeviceLink> {
    // SAFETY: as in instance_link, with LayerDeviceCreateInfo.
    unsafe {
        structures(info.as_ref()?.p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO)
            .map(|found| found.cast::<LayerDeviceCreateInfo>())
            .find(|found| (**found).function == LINK_INFO)
            .map(|found| &raw mut (*found).payload.link)
    }
}

/// Finds the next layer, and moves the loader's structure on to it, so that it finds its own next layer.
/// `None` without a link, which means that the caller is not a Vulkan loader.
///
/// # Safety
///
/// `info` is null or points to a valid structure whose pNext chain is valid; layers may write the loader's structures in it, by the loader's
/// interface.
pub unsafe fn advance_instance(info: *const vk::InstanceCreateInfo<'_>) -> Option<NextInstance> {
    // SAFETY: `info` is null or valid with its chain, as `# Safety` demands, and the loader's structure may be written.
    unsafe {
        let at = instance_link(info)?;
        let link = (*at).as_ref()?;
        *at = link.next;
        Some(NextInstance {
            get_instance_proc_addr: link.get_instance_proc_addr,
            get_physical_device_proc_addr: link.get_physical_device_proc_addr,
        })
    }
}

/// As [`advance_instance`], for a device.
///
/// # Safety
///
/// As for [`advance_instance`].
pub unsafe fn advance_device(info: *const vk::DeviceCreateInfo<'_>) -> Option<NextDevice> {
    // SAFETY: `info` is null or valid with its chain, as `# Safety` demands; a loader structure has the layout of
    // LayerDeviceCreateInfo.
    unsafe {
        let set_device_loader_data =
            structures(info.as_ref()?.p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO)
                .map(|found| found.cast::<LayerDeviceCreateInfo>())
                .find(|found| (**found).function == LOADER_DATA_CALLBACK)
                .and_then(|found| (*found).payload.set_device_loader_data);
        let at = device_link(info)?;
        let link = (*at).as_ref()?;
        *at = link.next;
        Some(NextDevice {
            get_instance_proc_addr: link.get_instance_proc_addr,
            get_device_proc_addr: link.get_device_proc_addr,
            set_device_loader_data,
        })
    }
}

/// The handle that a creation writes, and the loader's link in its chain, as they were before the call: the loader below reads its own
/// pointers out of both and may change them, and a second call needs them as they were.
pub struct Saved<H, L> {
    handle: (*mut H, H),
    link: Option<(*mut *mut L, *mut L)>,
}

impl<H: vk::Handle + Copy, L> Saved<H, L> {
    /// # Safety
    ///
    /// Both pointers are valid for reads.
    pub unsafe fn of(handle: *mut H, link: Option<*mut *mut L>) -> Self {
        // SAFETY: both are valid for reads, as `# Safety` demands.
        unsafe { Self { handle: (handle, *handle), link: link.map(|at| (at, *at)) } }
    }

    /// Writes them as they were.
    ///
    /// # Safety
    ///
    /// Both pointers are still valid, for writes.
    pub unsafe fn restore(&self) {
        let (handle, before) = self.handle;
        // SAFETY: both are valid for writes, as `# Safety` demands.
        unsafe {
            *handle = before;
            if let Some((at, link)) = self.link {
                *at = link;
            }
        }
    }
}

/// The first structure of type `T` in a pNext chain.
///
/// # Safety
///
/// `p_next` is null or starts a valid pNext chain, unchanged for `'a`.
pub unsafe fn extension<'a, T: vk::TaggedStructure>(p_next: *const c_void) -> Option<&'a T> {
    // SAFETY: the chain is valid, as `# Safety` demands; a structure of that type is a T.
    unsafe {
        let mut chain = pnext::chain(p_next);
        let found = Iterator::find(&mut chain, |header| header.ty == T::STRUCTURE_TYPE.as_raw())?;
        Some(&*std::ptr::from_ref(found).cast::<T>())
    }
}

/// The structures of one type in a pNext chain, in its order, as pointers that may be written through.
///
/// # Safety
///
/// `p_next` is null or starts a valid pNext chain, which outlives the iterator.
unsafe fn structures(
    p_next: *const c_void,
    wanted: vk::StructureType,
) -> impl Iterator<Item = *mut vk::BaseOutStructure<'static>> {
    let mut at = p_next.cast_mut().cast::<vk::BaseOutStructure<'static>>();
    std::iter::from_fn(move || {
        while !at.is_null() {
            let found = at;
            // SAFETY: `found` is a structure of the chain, which is valid, as `# Safety` demands; each starts with
            // a type and a pointer to the next.
            let s_type = unsafe {
                at = (*found).p_next;
                (*found).s_type
            };
            if s_type == wanted {
                return Some(found);
            }
        }
        None
    })
}
