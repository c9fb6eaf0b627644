//! `XR_KHR_vulkan_enable2`: the runtime makes the application's `VkInstance` and `VkDevice`.

use super::enable::{load_instance, requirements_for};
use crate::abi::pointers::{In, Out};
use crate::fault::{Fault, section};
use crate::runtime::call;
use crate::system;
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use openxr_sys::platform;
use std::ffi::{CString, c_char};

/// `xrCreateVulkanInstanceKHR`.
pub(crate) extern "system" fn create_instance(
    instance: xr::Instance,
    info: In<xr::VulkanInstanceCreateInfoKHR>,
    vk_instance: Out<platform::VkInstance>,
    vk_result: Out<platform::VkResult>,
) -> xr::Result {
    const NAME: &str = "xrCreateVulkanInstanceKHR";
    let mut job = None;
    let result = call(NAME, |runtime| {
        let info = runtime.read(&info)?;
        system::check(runtime, instance, info.system_id)?;
        vk_result.set("vulkanResult", 0)?;
        let loader = application_loader(info.pfn_get_instance_proc_addr)?;
        let parameters = info.vulkan_create_info.cast::<vk::InstanceCreateInfo<'_>>();
        if parameters.is_null() {
            return Err(Fault::validation(section::VULKAN, "vulkanCreateInfo is NULL"));
        }
        let allocator = info.vulkan_allocator.cast::<vk::AllocationCallbacks<'_>>();
        job = Some((loader, parameters, allocator, names(&runtime.scenario.vulkan.instance_extensions)?));
        Ok(xr::Result::SUCCESS)
    });
    let Some((loader, parameters, allocator, extensions)) = job else { return result };
    // Without the lock: Vulkan layers are loaded here, and they may be users of OpenXR.
    // SAFETY: the application's structure, with a longer list of extensions, which lives for the call; the function is
    // the one that the name stands for.
    let (created, outcome) = unsafe {
        let parameters = *parameters;
        let extensions =
            joined(parameters.pp_enabled_extension_names, parameters.enabled_extension_count, &extensions);
        let parameters = parameters.enabled_extension_names(&extensions);
        let Some(create) = loader(vk::Instance::null(), c"vkCreateInstance".as_ptr()) else {
            return call(NAME, |_| Err(Fault::validation(section::VULKAN, "there is no vkCreateInstance")));
        };
        let create = std::mem::transmute::<unsafe extern "system" fn(), vk::PFN_vkCreateInstance>(create);
        let mut created = vk::Instance::null();
        let outcome = create(&parameters, allocator, &mut created);
        (created, outcome)
    };
    call(NAME, |runtime| {
        vk_result.set("vulkanResult", outcome.as_raw())?;
        vk_instance.set("vulkanInstance", created.as_raw() as platform::VkInstance)?;
        if outcome == vk::Result::SUCCESS {
            runtime.instances.get_mut(instance)?.vulkan.loaders.insert(created.as_raw(), loader);
        }
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrCreateVulkanDeviceKHR`.
pub(crate) extern "system" fn create_device(
    instance: xr::Instance,
    info: In<xr::VulkanDeviceCreateInfoKHR>,
    vk_device: Out<platform::VkDevice>,
    vk_result: Out<platform::VkResult>,
) -> xr::Result {
    const NAME: &str = "xrCreateVulkanDeviceKHR";
    let mut job = None;
    let result = call(NAME, |runtime| {
        let info = runtime.read(&info)?;
        system::check(runtime, instance, info.system_id)?;
        vk_result.set("vulkanResult", 0)?;
        let loader = application_loader(info.pfn_get_instance_proc_addr)?;
        let parameters = info.vulkan_create_info.cast::<vk::DeviceCreateInfo<'_>>();
        if parameters.is_null() || info.vulkan_physical_device.is_null() {
            return Err(Fault::validation(
                section::VULKAN,
                "vulkanCreateInfo or vulkanPhysicalDevice is NULL",
            ));
        }
        let setup = &runtime.instances.get(instance)?.vulkan;
        let physical = vk::PhysicalDevice::from_raw(info.vulkan_physical_device as u64);
        let owner = setup.loaders.keys().map(|&raw| vk::Instance::from_raw(raw)).find(|&owner| {
            setup
                .physical_device(owner, &runtime.scenario.vulkan.device)
                .is_ok_and(|device| device == physical)
        });
        let owner = owner.ok_or_else(|| {
            Fault::validation(
                section::VULKAN,
                "vulkanPhysicalDevice is not from xrGetVulkanGraphicsDevice2KHR",
            )
        })?;
        let allocator = info.vulkan_allocator.cast::<vk::AllocationCallbacks<'_>>();
        let extensions = names(&runtime.scenario.vulkan.device_extensions)?;
        job = Some((load_instance(loader, owner), physical, parameters, allocator, extensions));
        Ok(xr::Result::SUCCESS)
    });
    let Some((functions, physical, parameters, allocator, extensions)) = job else { return result };
    // SAFETY: as in `create_instance`; the device is of the instance whose functions these are.
    let created = unsafe {
        let parameters = *parameters;
        let extensions =
            joined(parameters.pp_enabled_extension_names, parameters.enabled_extension_count, &extensions);
        let parameters = parameters.enabled_extension_names(&extensions);
        let mut created = vk::Device::null();
        let outcome = (functions.fp_v1_0().create_device)(physical, &parameters, allocator, &mut created);
        outcome.result().map(|()| created)
    };
    call(NAME, |_| {
        vk_result.set("vulkanResult", created.err().unwrap_or(vk::Result::SUCCESS).as_raw())?;
        vk_device.set("vulkanDevice", created.unwrap_or_default().as_raw() as platform::VkDevice)?;
        Ok(xr::Result::SUCCESS)
    })
}

fn application_loader(
    loader: Option<platform::VkGetInstanceProcAddr>,
) -> Result<vk::PFN_vkGetInstanceProcAddr, Fault> {
    let loader =
        loader.ok_or_else(|| Fault::validation(section::VULKAN, "pfnGetInstanceProcAddr is NULL"))?;
    // SAFETY: the same function type, which both crates declare for themselves.
    Ok(unsafe {
        std::mem::transmute::<platform::VkGetInstanceProcAddr, vk::PFN_vkGetInstanceProcAddr>(loader)
    })
}

fn names(names: &[String]) -> Result<Vec<CString>, Fault> {
    let convert =
        |name: &String| CString::new(name.as_str()).map_err(|error| Fault::runtime(error.to_string()));
    names.iter().map(convert).collect()
}

/// The application's extensions, and ours that are not among them.
///
/// # Safety
/// `first` points to `count` NUL-terminated strings, or `count` is 0; they live as long as the result is used.
unsafe fn joined(first: *const *const c_char, count: u32, ours: &[CString]) -> Vec<*const c_char> {
    let mut all = if count == 0 {
        Vec::new()
    } else {
        // SAFETY: this function's contract.
        unsafe { std::slice::from_raw_parts(first, count as usize) }.to_vec()
    };
    for name in ours {
        // SAFETY: this function's contract.
        let known = all.iter().any(|&known| unsafe { std::ffi::CStr::from_ptr(known) } == name.as_c_str());
        if !known {
            all.push(name.as_ptr());
        }
    }
    all
}

/// `xrGetVulkanGraphicsDevice2KHR`.
pub(crate) extern "system" fn get_graphics_device(
    instance: xr::Instance,
    info: In<xr::VulkanGraphicsDeviceGetInfoKHR>,
    device: Out<platform::VkPhysicalDevice>,
) -> xr::Result {
    call("xrGetVulkanGraphicsDevice2KHR", |runtime| {
        let info = runtime.read(&info)?;
        system::check(runtime, instance, info.system_id)?;
        let setup = &runtime.instances.get(instance)?.vulkan;
        let vk_instance = vk::Instance::from_raw(info.vulkan_instance as u64);
        let found = setup.physical_device(vk_instance, &runtime.scenario.vulkan.device)?;
        device.set("vulkanPhysicalDevice", found.as_raw() as platform::VkPhysicalDevice)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetVulkanGraphicsRequirements2KHR`.
pub(crate) extern "system" fn get_requirements(
    instance: xr::Instance,
    system: xr::SystemId,
    requirements: Out<xr::GraphicsRequirementsVulkanKHR>,
) -> xr::Result {
    requirements_for("xrGetVulkanGraphicsRequirements2KHR", instance, system, requirements)
}
