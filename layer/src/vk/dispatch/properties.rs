//! The layer's own properties. It adds no extension, to an instance or a device.

use crate::abi::guard;
use crate::vk::{LAYER_NAME, instance};
use ash::vk;
use parafovea_manifest::json::VULKAN_VERSION;
use std::ffi::{CStr, c_char};

/// `vkEnumerateInstanceLayerProperties`, of this layer alone.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn enumerate_instance_layers(
    count: *mut u32,
    properties: *mut vk::LayerProperties,
) -> vk::Result {
    // SAFETY: the caller passes a count, and null or as many structures as the count states.
    guard(
        "vkEnumerateInstanceLayerProperties",
        || vk::Result::ERROR_OUT_OF_HOST_MEMORY,
        |_| unsafe {
            let Some(count) = count.as_mut() else { return vk::Result::ERROR_INITIALIZATION_FAILED };
            let Some(first) = properties.as_mut() else {
                *count = 1;
                return vk::Result::SUCCESS;
            };
            if *count == 0 {
                return vk::Result::INCOMPLETE;
            }
            *count = 1;
            *first = own_properties();
            vk::Result::SUCCESS
        },
    )
}

/// `vkEnumerateDeviceLayerProperties`: the same, as the specification deprecates layers of devices.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn enumerate_device_layers(
    _physical_device: vk::PhysicalDevice,
    count: *mut u32,
    properties: *mut vk::LayerProperties,
) -> vk::Result {
    // SAFETY: the caller's arguments, with the same meaning.
    unsafe { enumerate_instance_layers(count, properties) }
}

/// `vkEnumerateInstanceExtensionProperties`: none of ours, and an error for other layers.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn enumerate_instance_extensions(
    layer: *const c_char,
    count: *mut u32,
    _properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    // SAFETY: the caller passes null or a null-terminated name, and a count.
    unsafe { no_extensions(layer, count).unwrap_or(vk::Result::ERROR_LAYER_NOT_PRESENT) }
}

/// `vkEnumerateDeviceExtensionProperties`: none of ours; every other question goes on to the next layer.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn enumerate_device_extensions(
    physical_device: vk::PhysicalDevice,
    layer: *const c_char,
    count: *mut u32,
    properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;
    guard(
        "vkEnumerateDeviceExtensionProperties",
        || {
            // SAFETY: a live physical device, and the caller's arguments for the next layer's function.
            unsafe {
                instance::of(physical_device).map_or(FAILED, |known| {
                    (known.next.enumerate_device_extensions)(physical_device, layer, count, properties)
                })
            }
        },
        |_| {
            // SAFETY: the caller passes null or a null-terminated name, a count, and a live physical device; a query that the layer does not
            // answer goes to the next layer's function with the same arguments.
            unsafe {
                if let Some(result) = no_extensions(layer, count) {
                    return result;
                }
                let Some(known) = instance::of(physical_device) else { return FAILED };
                (known.next.enumerate_device_extensions)(physical_device, layer, count, properties)
            }
        },
    )
}

/// Answers with no extension where `layer` names this one.
///
/// # Safety
///
/// `layer` is null or a null-terminated string; `count` is null or valid.
unsafe fn no_extensions(layer: *const c_char, count: *mut u32) -> Option<vk::Result> {
    // SAFETY: each pointer is null or valid, as `# Safety` demands.
    unsafe {
        if layer.is_null() || CStr::from_ptr(layer) != LAYER_NAME {
            return None;
        }
        *count.as_mut()? = 0;
    }
    Some(vk::Result::SUCCESS)
}

fn own_properties() -> vk::LayerProperties {
    let [major, minor] = VULKAN_VERSION;
    let mut properties = vk::LayerProperties {
        spec_version: vk::make_api_version(0, major, minor, 0),
        implementation_version: 1,
        ..Default::default()
    };
    copy_text(&mut properties.layer_name, LAYER_NAME);
    copy_text(&mut properties.description, c"Foveated rendering for existing OpenXR applications");
    properties
}

/// Copies `from` with its terminator; cut to the length of `to`.
fn copy_text(to: &mut [c_char], from: &CStr) {
    let room = to.len().saturating_sub(1);
    for (to, from) in to.iter_mut().zip(from.to_bytes().iter().take(room)) {
        *to = from.cast_signed();
    }
}
