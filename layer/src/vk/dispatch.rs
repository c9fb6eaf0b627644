//! Every function that this layer calls below, and every function that it hooks: one list for each kind.
//!
//! A line is a name and its type, then `next(field)` where the next layer's function is kept in the table, and
//! `hook(function)` where `proc_addr` answers with a function of ours. The list for armed devices, in [`armed`], has
//! functions that a device may lack.

mod armed;

pub use armed::{ArmedTable, armed_hook};

use super::{device, instance, proc_addr, properties};
use ash::vk;
use std::ffi::CStr;

macro_rules! functions {
    (
        $(#[$doc:meta])* hooks $find:ident $(, table $table:ident)?;
        $($name:literal: $pfn:ident => $(next($field:ident))? $(hook($hook:path))?;)*
    ) => {
        functions!(@table $($table)?; $($($name: $pfn => $field;)?)*);

        $(#[$doc])*
        pub fn $find(name: &CStr) -> vk::PFN_vkVoidFunction {
            $($(
                if name == $name {
                    let hook: vk::$pfn = $hook;
                    // SAFETY: PFN_vkVoidFunction may carry any function; the receiver casts it back to the
                    // type that belongs to the name.
                    return Some(unsafe {
                        std::mem::transmute::<vk::$pfn, unsafe extern "system" fn()>(hook)
                    });
                }
            )?)*
            None
        }
    };
    (@table ;) => {};
    (@table $table:ident; $($name:literal: $pfn:ident => $field:ident;)*) => {
        /// The next layer's functions that this layer calls.
        pub struct $table {
            $(pub $field: vk::$pfn,)*
        }

        impl $table {
            /// Resolves every function beforehand; `None` when one is missing.
            ///
            /// # Safety
            ///
            /// For a name, `get` returns the function of that name, or `None`.
            pub unsafe fn load(get: impl Fn(&CStr) -> vk::PFN_vkVoidFunction) -> Option<Self> {
                Some(Self {
                    // SAFETY: the caller vouches that each pointer is the function of that name, and the
                    // list gives each name its type.
                    $($field: unsafe {
                        std::mem::transmute::<unsafe extern "system" fn(), vk::$pfn>(get($name)?)
                    },)*
                })
            }
        }
    };
}

functions! {
    /// Our functions that need no instance.
    hooks global_hook;
    c"vkGetInstanceProcAddr": PFN_vkGetInstanceProcAddr => hook(proc_addr::instance);
    c"vkCreateInstance": PFN_vkCreateInstance => hook(instance::create);
    c"vkEnumerateInstanceLayerProperties":
        PFN_vkEnumerateInstanceLayerProperties => hook(properties::enumerate_instance_layers);
    c"vkEnumerateInstanceExtensionProperties":
        PFN_vkEnumerateInstanceExtensionProperties => hook(properties::enumerate_instance_extensions);
}

functions! {
    /// Our hook for a function of an instance.
    hooks instance_hook, table InstanceTable;
    c"vkDestroyInstance": PFN_vkDestroyInstance => next(destroy_instance) hook(instance::destroy);
    c"vkGetPhysicalDeviceProperties": PFN_vkGetPhysicalDeviceProperties => next(physical_device_properties);
    c"vkEnumerateDeviceExtensionProperties": PFN_vkEnumerateDeviceExtensionProperties =>
        next(enumerate_device_extensions);
}

functions! {
    /// Our hook for a function of a physical device.
    hooks physical_device_hook;
    c"vkCreateDevice": PFN_vkCreateDevice => hook(device::create);
    c"vkEnumerateDeviceLayerProperties":
        PFN_vkEnumerateDeviceLayerProperties => hook(properties::enumerate_device_layers);
    c"vkEnumerateDeviceExtensionProperties":
        PFN_vkEnumerateDeviceExtensionProperties => hook(properties::enumerate_device_extensions);
}

functions! {
    /// Our hook for a function of a device.
    hooks device_hook, table DeviceTable;
    c"vkGetDeviceProcAddr": PFN_vkGetDeviceProcAddr => hook(proc_addr::device);
    c"vkDestroyDevice": PFN_vkDestroyDevice => next(destroy_device) hook(device::destroy);
}
