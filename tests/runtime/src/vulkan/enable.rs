//! `XR_KHR_vulkan_enable`, and its common parts with its successor.

use super::Gpu;
use super::failed;
use crate::abi::pointers::{List, Out};
use crate::abi::text;
use crate::fault::{Fault, section};
use crate::runtime::call;
use crate::system;
use ash::vk;
use ash::vk::Handle as _;
use openxr_sys as xr;
use openxr_sys::platform;
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char};
use std::sync::OnceLock;

/// An instance's knowledge of the application's Vulkan before a session.
#[derive(Debug, Default)]
pub(crate) struct VulkanSetup {
    /// Whether the application asked for the graphics requirements.
    pub requirements_read: bool,
    /// For each `VkInstance` that the runtime made, the application's `vkGetInstanceProcAddr`.
    pub loaders: BTreeMap<u64, vk::PFN_vkGetInstanceProcAddr>,
}

/// Versions of Vulkan that applications may use: major and minor as in `XrVersion`.
const VULKAN_VERSIONS: [xr::Version; 2] = [xr::Version::new(1, 0, 0), xr::Version::new(1, 4, 0xfff)];

impl VulkanSetup {
    /// The function through which an instance's functions are found: the application's, or the Vulkan loader's.
    pub fn loader(&self, instance: vk::Instance) -> Result<vk::PFN_vkGetInstanceProcAddr, Fault> {
        match self.loaders.get(&instance.as_raw()) {
            Some(loader) => Ok(*loader),
            None => system_loader(),
        }
    }

    /// The device that the application is to use.
    pub fn physical_device(&self, instance: vk::Instance, wanted: &str) -> Result<vk::PhysicalDevice, Fault> {
        if instance.is_null() {
            return Err(Fault::validation(section::VULKAN, "vkInstance is NULL"));
        }
        let functions = load_instance(self.loader(instance)?, instance);
        // SAFETY: the application vouches for its VkInstance; the functions are that instance's.
        let devices = unsafe { functions.enumerate_physical_devices() };
        let devices = devices.map_err(failed("vkEnumeratePhysicalDevices"))?;
        let name = |device: vk::PhysicalDevice| {
            // SAFETY: a device of this instance.
            let properties = unsafe { functions.get_physical_device_properties(device) };
            properties.device_name_as_c_str().map(CStr::to_string_lossy).unwrap_or_default().into_owned()
        };
        let found =
            devices.iter().copied().find(|&device| wanted.is_empty() || name(device).contains(wanted));
        found.ok_or_else(|| {
            let names: Vec<_> = devices.iter().map(|&device| name(device)).collect();
            Fault::runtime(format!("vulkan.device is {wanted:?}; the devices are {names:?}"))
        })
    }

    /// Opens the device of a session's graphics binding.
    pub fn bind(&self, binding: &xr::GraphicsBindingVulkanKHR, wanted: &str) -> Result<Gpu, Fault> {
        if !self.requirements_read {
            let message = "xrGetVulkanGraphicsRequirements(2)KHR was not called";
            let result = xr::Result::ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING;
            return Err(Fault::new(result, section::SESSION_CREATION, message));
        }
        let invalid = |message: &str| {
            Fault::new(xr::Result::ERROR_GRAPHICS_DEVICE_INVALID, section::SESSION_CREATION, message)
        };
        if binding.instance.is_null() || binding.physical_device.is_null() || binding.device.is_null() {
            return Err(invalid("instance, physicalDevice or device is NULL"));
        }
        let instance = vk::Instance::from_raw(binding.instance as u64);
        let physical_device = vk::PhysicalDevice::from_raw(binding.physical_device as u64);
        if physical_device != self.physical_device(instance, wanted)? {
            return Err(invalid("physicalDevice is not the one that xrGetVulkanGraphicsDevice(2)KHR gives"));
        }
        let functions = load_instance(self.loader(instance)?, instance);
        // SAFETY: a device of this instance, as was just found.
        let families = unsafe { functions.get_physical_device_queue_family_properties(physical_device) };
        let family = families.get(binding.queue_family_index as usize);
        if family.is_none_or(|family| binding.queue_index >= family.queue_count) {
            return Err(invalid("queueFamilyIndex or queueIndex is beyond what the device has"));
        }
        let device = vk::Device::from_raw(binding.device as u64);
        Gpu::new(&functions, physical_device, device, binding.queue_family_index, binding.queue_index)
    }
}

/// The functions of a living `VkInstance`.
pub(super) fn load_instance(loader: vk::PFN_vkGetInstanceProcAddr, instance: vk::Instance) -> ash::Instance {
    let load = |name: &CStr| {
        // SAFETY: the instance lives, the name is NUL-terminated.
        let function = unsafe { loader(instance, name.as_ptr()) };
        function.map_or(std::ptr::null(), |function| function as *const _)
    };
    // SAFETY: the functions are found by their names, so that each has the type that goes with its name.
    unsafe { ash::Instance::load_with(load, instance) }
}

/// `vkGetInstanceProcAddr` of the Vulkan loader of the system, which stays loaded.
fn system_loader() -> Result<vk::PFN_vkGetInstanceProcAddr, Fault> {
    static LOADER: OnceLock<Result<(libloading::Library, vk::PFN_vkGetInstanceProcAddr), String>> =
        OnceLock::new();
    let open = || {
        // SAFETY: the Vulkan loader may be loaded by anybody; the symbol has this type in it.
        unsafe {
            let library = libloading::Library::new("libvulkan.so.1").map_err(|error| error.to_string())?;
            let symbol = library.get::<vk::PFN_vkGetInstanceProcAddr>(c"vkGetInstanceProcAddr");
            let function = *symbol.map_err(|error| error.to_string())?;
            Ok((library, function))
        }
    };
    LOADER.get_or_init(open).as_ref().map(|(_, function)| *function).map_err(Fault::runtime)
}

/// `xrGetVulkanInstanceExtensionsKHR`.
pub(crate) extern "system" fn get_instance_extensions(
    instance: xr::Instance,
    system: xr::SystemId,
    capacity: u32,
    count: Out<u32>,
    items: Out<c_char>,
) -> xr::Result {
    call("xrGetVulkanInstanceExtensionsKHR", |runtime| {
        system::check(runtime, instance, system)?;
        let names = text::terminated(&runtime.scenario.vulkan.instance_extensions.join(" "));
        List { capacity, count, items }.fill("buffer", &names)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetVulkanDeviceExtensionsKHR`.
pub(crate) extern "system" fn get_device_extensions(
    instance: xr::Instance,
    system: xr::SystemId,
    capacity: u32,
    count: Out<u32>,
    items: Out<c_char>,
) -> xr::Result {
    call("xrGetVulkanDeviceExtensionsKHR", |runtime| {
        system::check(runtime, instance, system)?;
        let names = text::terminated(&runtime.scenario.vulkan.device_extensions.join(" "));
        List { capacity, count, items }.fill("buffer", &names)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetVulkanGraphicsDeviceKHR`.
pub(crate) extern "system" fn get_graphics_device(
    instance: xr::Instance,
    system: xr::SystemId,
    vk_instance: platform::VkInstance,
    device: Out<platform::VkPhysicalDevice>,
) -> xr::Result {
    call("xrGetVulkanGraphicsDeviceKHR", |runtime| {
        system::check(runtime, instance, system)?;
        let setup = &runtime.instances.get(instance)?.vulkan;
        let vk_instance = vk::Instance::from_raw(vk_instance as u64);
        let found = setup.physical_device(vk_instance, &runtime.scenario.vulkan.device)?;
        device.set("vkPhysicalDevice", found.as_raw() as platform::VkPhysicalDevice)?;
        Ok(xr::Result::SUCCESS)
    })
}

/// `xrGetVulkanGraphicsRequirementsKHR`.
pub(crate) extern "system" fn get_requirements(
    instance: xr::Instance,
    system: xr::SystemId,
    requirements: Out<xr::GraphicsRequirementsVulkanKHR>,
) -> xr::Result {
    requirements_for("xrGetVulkanGraphicsRequirementsKHR", instance, system, requirements)
}

/// The requirements, which both extensions have in common.
pub(super) fn requirements_for(
    name: &'static str,
    instance: xr::Instance,
    system: xr::SystemId,
    mut requirements: Out<xr::GraphicsRequirementsVulkanKHR>,
) -> xr::Result {
    call(name, |runtime| {
        system::check(runtime, instance, system)?;
        let filled = requirements.get()?;
        [filled.min_api_version_supported, filled.max_api_version_supported] = VULKAN_VERSIONS;
        runtime.instances.get_mut(instance)?.vulkan.requirements_read = true;
        Ok(xr::Result::SUCCESS)
    })
}
