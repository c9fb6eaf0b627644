//! Functions of the next layer that may be missing, each under its names in the core and in an extension.

/// A table of functions that may be missing.
macro_rules! functions {
    ($(#[$doc:meta])* $table:ident { $($field:ident: $pfn:ident = $name:literal $(| $other:literal)*;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub(crate) struct $table {
            $(pub $field: Option<ash::vk::$pfn>,)*
        }

        impl $table {
            /// # Safety
            ///
            /// `function` gives the function of a name, or none.
            pub unsafe fn load(function: impl Fn(&std::ffi::CStr) -> ash::vk::PFN_vkVoidFunction) -> Self {
                Self {
                    $($field: {
                        let found = function($name)$(.or_else(|| function($other)))*;
                        // SAFETY: all of the names have this type.
                        unsafe {
                            std::mem::transmute::<ash::vk::PFN_vkVoidFunction, Option<ash::vk::$pfn>>(found)
                        }
                    },)*
                }
            }
        }
    };
}
pub(crate) use functions;

functions! {
    /// Queries of a physical device.
    PhysicalDeviceFunctions {
        memory_properties: PFN_vkGetPhysicalDeviceMemoryProperties = c"vkGetPhysicalDeviceMemoryProperties";
        memory_properties2: PFN_vkGetPhysicalDeviceMemoryProperties2
            = c"vkGetPhysicalDeviceMemoryProperties2" | c"vkGetPhysicalDeviceMemoryProperties2KHR";
        extensions: PFN_vkEnumerateDeviceExtensionProperties = c"vkEnumerateDeviceExtensionProperties";
        properties: PFN_vkGetPhysicalDeviceProperties = c"vkGetPhysicalDeviceProperties";
        features2: PFN_vkGetPhysicalDeviceFeatures2
            = c"vkGetPhysicalDeviceFeatures2" | c"vkGetPhysicalDeviceFeatures2KHR";
        properties2: PFN_vkGetPhysicalDeviceProperties2
            = c"vkGetPhysicalDeviceProperties2" | c"vkGetPhysicalDeviceProperties2KHR";
        queue_families2: PFN_vkGetPhysicalDeviceQueueFamilyProperties2
            = c"vkGetPhysicalDeviceQueueFamilyProperties2" | c"vkGetPhysicalDeviceQueueFamilyProperties2KHR";
        format_properties: PFN_vkGetPhysicalDeviceFormatProperties = c"vkGetPhysicalDeviceFormatProperties";
        format_properties2: PFN_vkGetPhysicalDeviceFormatProperties2
            = c"vkGetPhysicalDeviceFormatProperties2" | c"vkGetPhysicalDeviceFormatProperties2KHR";
        image_format_properties: PFN_vkGetPhysicalDeviceImageFormatProperties
            = c"vkGetPhysicalDeviceImageFormatProperties";
        image_format_properties2: PFN_vkGetPhysicalDeviceImageFormatProperties2
            = c"vkGetPhysicalDeviceImageFormatProperties2" | c"vkGetPhysicalDeviceImageFormatProperties2KHR";
    }
}
