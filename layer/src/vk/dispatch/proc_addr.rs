//! Function lookup for the loader and the layers above: finds our functions and, through us, those below.
//!
//! A hook of ours is given out only if the next layer has the function too: a function that the driver lacks stays missing.

use crate::abi::guard;
use crate::link::GET_LINK_NAME;
use crate::vk::armed::Armed;
use crate::vk::device::Device;
use crate::vk::dispatch::{
    armed_hook, device_hook, global_hook, hook_of, instance_hook, physical_device_hook,
};
use crate::vk::{device, instance, link_table};
use ash::vk;
use std::ffi::{CStr, c_char};

/// `vkGetInstanceProcAddr`.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn instance(handle: vk::Instance, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a null-terminated name, and an instance that is null or live.
    guard(
        "vkGetInstanceProcAddr",
        // SAFETY: as above.
        || unsafe {
            let name = text(&name)?;
            global_hook(name)
                // The loader makes devices, and ends all, through these.
                .or_else(|| instance_hook(name))
                .or_else(|| physical_device_hook(name))
                .or_else(|| device_hook(name))
                .or_else(|| (instance::of(handle)?.get_instance_proc_addr)(handle, name.as_ptr()))
        },
        |_| unsafe {
            let name = text(&name)?;
            // Before any look-up: the instance may be null, or not tracked yet.
            if let Some(own) = global_hook(name) {
                return Some(own);
            }
            let known = instance::of(handle)?;
            let next = (known.get_instance_proc_addr)(handle, name.as_ptr())?;
            instance_hook(name)
                .or_else(|| physical_device_hook(name))
                .or_else(|| device_hook(name))
                .or_else(|| if known.enabled { armed_hook(name) } else { None })
                .or(Some(next))
        },
    )
}

/// `vkGetDeviceProcAddr`. Answers the OpenXR half's question for the link, for an armed device and for one that the
/// configuration keeps inert.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn device(handle: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a null-terminated name and a live device.
    guard(
        "vkGetDeviceProcAddr",
        // SAFETY: as above.
        || unsafe { (device::of(handle)?.get_device_proc_addr)(handle, text(&name)?.as_ptr()) },
        |_| unsafe {
            let name = text(&name)?;
            let known = device::of(handle)?;
            if name == GET_LINK_NAME {
                return known.is_linked.then(link_table::get_link);
            }
            let next = (known.get_device_proc_addr)(handle, name.as_ptr())?;
            if is_frequent(name) && !is_wanted(&known, name) {
                return Some(next);
            }
            let armed = || known.armed.as_ref().and_then(|_| hook_of(&known.hooked, name));
            device_hook(name).or_else(armed).or(Some(next))
        },
    )
}

/// Whether a command draws, or binds state of draws and dispatches, which happens so often that it goes straight down unless we
/// have to know.
fn is_frequent(name: &CStr) -> bool {
    let name = name.to_bytes();
    name == b"vkCmdBindPipeline"
        || [
            &b"vkCmdBindDescriptor"[..],
            b"vkCmdPushDescriptor",
            b"vkCmdSetDescriptor",
            PUSH_CONSTANTS,
            PUSH_DATA,
            STENCIL,
            VIEWPORT,
            SCISSOR,
            DRAW,
        ]
        .iter()
        .any(|begin| name.starts_with(begin))
}

/// Prefix of the names of commands that set stencil tests.
const STENCIL: &[u8] = b"vkCmdSetStencil";

/// Prefixes of the names of commands that set viewports and scissors.
const VIEWPORT: &[u8] = b"vkCmdSetViewport";
const SCISSOR: &[u8] = b"vkCmdSetScissor";

/// Prefix of the names of commands that push constants.
const PUSH_CONSTANTS: &[u8] = b"vkCmdPushConstants";

/// Prefix of the names of commands that push data beside descriptor heaps.
const PUSH_DATA: &[u8] = b"vkCmdPushData";

/// Prefix of the names of draw commands.
const DRAW: &[u8] = b"vkCmdDraw";

/// Whether it is of interest: stencil tests, scissors and pushed data where passes may have masks, and constants too where there are heaps;
/// draws, viewports and descriptors where passes may be made coarser; pipelines where rates may have to be set then, or masks must know of them.
fn is_wanted(device: &Device, name: &CStr) -> bool {
    if [STENCIL, SCISSOR, PUSH_DATA].iter().any(|begin| name.to_bytes().starts_with(begin)) {
        return device.masks().is_some();
    }
    if name.to_bytes().starts_with(PUSH_CONSTANTS) {
        return device.masks().is_some() && device.hooked.cmd_bind_resource_heap.is_some();
    }
    if name != c"vkCmdBindPipeline" {
        return device.armed.as_deref().is_some_and(Armed::follows_passes);
    }
    device.masks().is_some() || device.rate_attachments().is_some_and(|rates| rates.sets_rates_at_bind)
}

/// `vk_layerGetPhysicalDeviceProcAddr`: functions of physical devices, and nothing else.
///
/// # Safety
///
/// The valid usage of the call.
pub unsafe extern "system" fn physical_device(
    handle: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller passes a null-terminated name and a live instance.
    guard(
        "vk_layerGetPhysicalDeviceProcAddr",
        // SAFETY: as above.
        || unsafe { (instance::of(handle)?.get_physical_device_proc_addr?)(handle, text(&name)?.as_ptr()) },
        |_| unsafe {
            let name = text(&name)?;
            let known = instance::of(handle)?;
            physical_device_hook(name).or_else(|| known.get_physical_device_proc_addr?(handle, name.as_ptr()))
        },
    )
}

/// A name given by a caller.
///
/// # Safety
///
/// `name` is null or a null-terminated string.
unsafe fn text(name: &*const c_char) -> Option<&CStr> {
    // SAFETY: the string is valid, as `# Safety` demands, and lives as long as the call.
    (!name.is_null()).then(|| unsafe { CStr::from_ptr(*name) })
}
