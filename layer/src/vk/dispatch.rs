//! Our hooks by name: one list for each kind of function, and in [`armed`] the functions of armed devices. `proc_addr` answers with them.

mod armed;
pub mod proc_addr;
mod properties;

pub use armed::{armed_hook, hook_of};

use super::hooks::{device, instance};
use ash::vk;
use std::ffi::CStr;

macro_rules! hooks {
    ($(#[$doc:meta])* $find:ident; $($name:literal: $pfn:ident => $hook:path;)*) => {
        $(#[$doc])*
        pub fn $find(name: &CStr) -> vk::PFN_vkVoidFunction {
            $(
                if name == $name {
                    let hook: vk::$pfn = $hook;
                    // SAFETY: PFN_vkVoidFunction may carry any function; the receiver casts it back to the
                    // type that belongs to the name.
                    return Some(unsafe {
                        std::mem::transmute::<vk::$pfn, unsafe extern "system" fn()>(hook)
                    });
                }
            )*
            None
        }
    };
}

hooks! {
    /// Our functions that need no instance.
    global_hook;
    c"vkGetInstanceProcAddr": PFN_vkGetInstanceProcAddr => proc_addr::instance;
    c"vkCreateInstance": PFN_vkCreateInstance => instance::create;
    c"vkEnumerateInstanceLayerProperties":
        PFN_vkEnumerateInstanceLayerProperties => properties::enumerate_instance_layers;
    c"vkEnumerateInstanceExtensionProperties":
        PFN_vkEnumerateInstanceExtensionProperties => properties::enumerate_instance_extensions;
}

hooks! {
    /// Our hook for a function of an instance.
    instance_hook;
    c"vkDestroyInstance": PFN_vkDestroyInstance => instance::destroy;
}

hooks! {
    /// Our hook for a function of a physical device.
    physical_device_hook;
    c"vkCreateDevice": PFN_vkCreateDevice => device::create;
    c"vkEnumerateDeviceLayerProperties":
        PFN_vkEnumerateDeviceLayerProperties => properties::enumerate_device_layers;
    c"vkEnumerateDeviceExtensionProperties":
        PFN_vkEnumerateDeviceExtensionProperties => properties::enumerate_device_extensions;
}

hooks! {
    /// Our hook for a function of a device.
    device_hook;
    c"vkGetDeviceProcAddr": PFN_vkGetDeviceProcAddr => proc_addr::device;
    c"vkDestroyDevice": PFN_vkDestroyDevice => device::destroy;
}
