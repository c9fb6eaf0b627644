//! XR_KHR_vulkan_enable: the runtime names the extensions and the device, the application creates.

use super::{Application, Vulkan, graphics_family, load, with_device_info, with_instance_info};
use crate::failure::{Failure, succeeded};
use crate::functions::extension_function;
use crate::xr::Xr;
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use std::ffi::{CString, c_char, c_void};
use std::ptr::null_mut;

pub fn create(xr: &Xr, application: Application<'_>) -> Result<Vulkan, Failure> {
    require_graphics(xr)?;
    let (library, entry) = load()?;
    let get = extension_function!(xr, GetVulkanInstanceExtensionsKHR)?;
    let extensions = names(|capacity, count, buffer| {
        // SAFETY: the instance is live, the buffer has the capacity that is passed.
        unsafe { get(xr.instance, xr.system, capacity, count, buffer) }
    })?;
    let instance = with_instance_info(application, &extensions, |info| {
        // SAFETY: the structure and the data that it points to outlive the call.
        Ok(unsafe { entry.create_instance(info, None) }?)
    })?;
    let physical_device = graphics_device(xr, instance.handle())?;
    let get = extension_function!(xr, GetVulkanDeviceExtensionsKHR)?;
    let extensions = names(|capacity, count, buffer| {
        // SAFETY: as above.
        unsafe { get(xr.instance, xr.system, capacity, count, buffer) }
    })?;
    let family = graphics_family(&instance, physical_device)?;
    let device = with_device_info(family, &extensions, |info| {
        // SAFETY: the physical device is this instance's; the structure outlives the call.
        Ok(unsafe { instance.create_device(physical_device, info, None) }?)
    })?;
    Ok(Vulkan::assemble(library, instance, physical_device, device, family))
}

/// For a device that existed before OpenXR: it must be the runtime's device.
pub fn require_same_device(xr: &Xr, vulkan: &Vulkan) -> Result<(), Failure> {
    require_graphics(xr)?;
    if graphics_device(xr, vulkan.instance.handle())? == vulkan.physical_device {
        Ok(())
    } else {
        Err(Failure::Unsupported("the runtime uses another Vulkan device than the first".to_owned()))
    }
}

/// xrCreateSession is an error before this call.
fn require_graphics(xr: &Xr) -> Result<(), Failure> {
    let get = extension_function!(xr, GetVulkanGraphicsRequirementsKHR)?;
    let mut requirements = xr::GraphicsRequirementsVulkanKHR::out(null_mut());
    // SAFETY: the instance is live and the output outlives the call.
    let result = unsafe { get(xr.instance, xr.system, requirements.as_mut_ptr()) };
    succeeded("xrGetVulkanGraphicsRequirementsKHR", result).map(drop)
}

fn graphics_device(xr: &Xr, instance: vk::Instance) -> Result<vk::PhysicalDevice, Failure> {
    let get = extension_function!(xr, GetVulkanGraphicsDeviceKHR)?;
    let mut device: *const c_void = std::ptr::null();
    // SAFETY: both instances are live and the output outlives the call.
    let result = unsafe { get(xr.instance, xr.system, instance.as_raw() as *const c_void, &mut device) };
    succeeded("xrGetVulkanGraphicsDeviceKHR", result)?;
    Ok(vk::PhysicalDevice::from_raw(device as u64))
}

/// Reads names separated by spaces with the two calls of the buffer size idiom.
fn names(get: impl Fn(u32, *mut u32, *mut c_char) -> xr::Result) -> Result<Vec<CString>, Failure> {
    const CALL: &str = "xrGetVulkan*ExtensionsKHR";
    let mut count = 0;
    succeeded(CALL, get(0, &mut count, null_mut()))?;
    let mut buffer = vec![0u8; count as usize];
    succeeded(CALL, get(count, &mut count, buffer.as_mut_ptr().cast()))?;
    let names = buffer
        .split(|byte| matches!(byte, 0 | b' '))
        .filter(|name| !name.is_empty())
        .filter_map(|name| CString::new(name).ok())
        .collect();
    Ok(names)
}
