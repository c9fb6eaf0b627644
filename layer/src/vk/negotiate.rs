//! The first call of the Vulkan loader.

use super::chain::{INTERFACE_VERSION, NEGOTIATE_INTERFACE_STRUCT, NegotiateLayerInterface};
use crate::abi::guard;
use crate::vk::dispatch::proc_addr;
use ash::vk;

/// `vkNegotiateLoaderLayerInterfaceVersion`: agrees on interface version 2 and hands out our functions. The
/// manifest's `functions` maps the loader's name to this one, which collides with no other.
///
/// Fails with `ERROR_INITIALIZATION_FAILED`, upon which the loader leaves us out, for an invalid structure and for
/// a loader that does not speak version 2.
///
/// # Safety
///
/// `interface` is null or points to a valid structure.
#[unsafe(export_name = "parafovea_vkNegotiateLoaderLayerInterfaceVersion")]
pub unsafe extern "system" fn negotiate(interface: *mut NegotiateLayerInterface) -> vk::Result {
    const FAILED: vk::Result = vk::Result::ERROR_INITIALIZATION_FAILED;
    guard(
        "vkNegotiateLoaderLayerInterfaceVersion",
        || FAILED,
        |_| {
            crate::log::start();
            // SAFETY: the pointer is null or valid, as `# Safety` demands, and no other code uses it during the call.
            let Some(interface) = (unsafe { interface.as_mut() }) else { return FAILED };
            if interface.s_type != NEGOTIATE_INTERFACE_STRUCT
                || interface.loader_layer_interface_version < INTERFACE_VERSION
            {
                return FAILED;
            }
            interface.loader_layer_interface_version = INTERFACE_VERSION;
            interface.get_instance_proc_addr = Some(proc_addr::instance);
            interface.get_device_proc_addr = Some(proc_addr::device);
            interface.get_physical_device_proc_addr = Some(proc_addr::physical_device);
            vk::Result::SUCCESS
        },
    )
}
