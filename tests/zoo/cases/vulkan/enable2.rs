//! XR_KHR_vulkan_enable2: the runtime creates the VkInstance and the VkDevice for the application.

use super::{Application, Vulkan, graphics_family, load, with_device_info, with_instance_info};
use crate::failure::{Failure, succeeded};
use crate::functions::extension_function;
use crate::xr::Xr;
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use openxr_sys::platform::VkGetInstanceProcAddr;
use std::ffi::c_void;
use std::ptr::{from_ref, null, null_mut};

pub fn create(xr: &Xr, application: Application<'_>) -> Result<Vulkan, Failure> {
    let get = extension_function!(xr, GetVulkanGraphicsRequirements2KHR)?;
    let mut requirements = xr::GraphicsRequirementsVulkanKHR::out(null_mut());
    // SAFETY: the instance is live and the output outlives the call.
    let result = unsafe { get(xr.instance, xr.system, requirements.as_mut_ptr()) };
    succeeded("xrGetVulkanGraphicsRequirements2KHR", result)?;

    let (library, entry) = load()?;
    let instance = with_instance_info(application, &[], |info| create_instance(xr, &entry, info))?;
    let physical_device = graphics_device(xr, instance.handle())?;
    let family = graphics_family(&instance, physical_device)?;
    let device =
        with_device_info(family, &[], |info| create_device(xr, &entry, &instance, physical_device, info))?;
    Ok(Vulkan::assemble(library, instance, physical_device, device, family))
}

fn create_instance(
    xr: &Xr,
    entry: &ash::Entry,
    info: &vk::InstanceCreateInfo,
) -> Result<ash::Instance, Failure> {
    let create = extension_function!(xr, CreateVulkanInstanceKHR)?;
    let info = xr::VulkanInstanceCreateInfoKHR {
        ty: xr::VulkanInstanceCreateInfoKHR::TYPE,
        next: null(),
        system_id: xr.system,
        create_flags: xr::VulkanInstanceCreateFlagsKHR::EMPTY,
        pfn_get_instance_proc_addr: Some(get_instance_proc_addr(entry)),
        vulkan_create_info: from_ref(info).cast(),
        vulkan_allocator: null(),
    };
    let mut instance: *const c_void = null();
    let mut vulkan_result = 0;
    // SAFETY: the structures and the data that they point to outlive the call.
    let result = unsafe { create(xr.instance, &info, &mut instance, &mut vulkan_result) };
    succeeded("xrCreateVulkanInstanceKHR", result)?;
    vk::Result::from_raw(vulkan_result).result()?;
    // SAFETY: the call created this instance with the entry's loader.
    Ok(unsafe { ash::Instance::load(entry.static_fn(), vk::Instance::from_raw(instance as u64)) })
}

fn graphics_device(xr: &Xr, instance: vk::Instance) -> Result<vk::PhysicalDevice, Failure> {
    let get = extension_function!(xr, GetVulkanGraphicsDevice2KHR)?;
    let info = xr::VulkanGraphicsDeviceGetInfoKHR {
        ty: xr::VulkanGraphicsDeviceGetInfoKHR::TYPE,
        next: null(),
        system_id: xr.system,
        vulkan_instance: instance.as_raw() as *const c_void,
    };
    let mut device: *const c_void = null();
    // SAFETY: both instances are live and the structures outlive the call.
    let result = unsafe { get(xr.instance, &info, &mut device) };
    succeeded("xrGetVulkanGraphicsDevice2KHR", result)?;
    Ok(vk::PhysicalDevice::from_raw(device as u64))
}

fn create_device(
    xr: &Xr,
    entry: &ash::Entry,
    instance: &ash::Instance,
    physical_device: vk::PhysicalDevice,
    info: &vk::DeviceCreateInfo,
) -> Result<ash::Device, Failure> {
    let create = extension_function!(xr, CreateVulkanDeviceKHR)?;
    let info = xr::VulkanDeviceCreateInfoKHR {
        ty: xr::VulkanDeviceCreateInfoKHR::TYPE,
        next: null(),
        system_id: xr.system,
        create_flags: xr::VulkanDeviceCreateFlagsKHR::EMPTY,
        pfn_get_instance_proc_addr: Some(get_instance_proc_addr(entry)),
        vulkan_physical_device: physical_device.as_raw() as *const c_void,
        vulkan_create_info: from_ref(info).cast(),
        vulkan_allocator: null(),
    };
    let mut device: *const c_void = null();
    let mut vulkan_result = 0;
    // SAFETY: the structures and the data that they point to outlive the call.
    let result = unsafe { create(xr.instance, &info, &mut device, &mut vulkan_result) };
    succeeded("xrCreateVulkanDeviceKHR", result)?;
    vk::Result::from_raw(vulkan_result).result()?;
    // SAFETY: the call created this device of the instance.
    Ok(unsafe { ash::Device::load(instance.fp_v1_0(), vk::Device::from_raw(device as u64)) })
}

fn get_instance_proc_addr(entry: &ash::Entry) -> VkGetInstanceProcAddr {
    // SAFETY: both types are vkGetInstanceProcAddr; they differ in how they spell VkInstance.
    unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, VkGetInstanceProcAddr>(
            entry.static_fn().get_instance_proc_addr,
        )
    }
}
