//! The answers of the Vulkan loader and the drivers.

use ash::khr::fragment_shading_rate;
use ash::{Entry, Instance, vk};
use parafovea_manifest::doctor::{Device, VulkanAnswer};
use std::ffi::CStr;

/// Names of the layers that the loader lists: implicit ones where they are enabled, and explicit ones.
pub fn layers() -> Result<Vec<String>, String> {
    // SAFETY: the loader is loaded, and no other thread uses it.
    let layers = unsafe { entry()?.enumerate_instance_layer_properties() };
    let layers = layers.map_err(|error| format!("vkEnumerateInstanceLayerProperties: {error}"))?;
    let name = |layer: &vk::LayerProperties| layer.layer_name_as_c_str().map(text).unwrap_or_default();
    Ok(layers.iter().map(name).collect())
}

/// The devices and their shading rates.
pub fn answer() -> Result<VulkanAnswer, String> {
    let entry = entry()?;
    let (instance, version) = instance(&entry)?;
    // SAFETY: a live instance, which is destroyed last; the queries need Vulkan 1.1, which `describe` checks.
    let devices = unsafe {
        let devices = instance
            .enumerate_physical_devices()
            .map(|devices| {
                devices.iter().map(|device| describe(&entry, &instance, version, *device)).collect()
            })
            .map_err(|error| format!("vkEnumeratePhysicalDevices: {error}"));
        instance.destroy_instance(None);
        devices
    };
    Ok(VulkanAnswer { version: parts(version), devices: devices? })
}

/// An instance of the newest version that the loader speaks, up to 1.3, without layers and extensions; and the loader's
/// version.
pub(crate) fn instance(entry: &Entry) -> Result<(Instance, u32), String> {
    // SAFETY: the loader is loaded; one of Vulkan 1.0 has no such function, which ash takes care of.
    let version =
        unsafe { entry.try_enumerate_instance_version() }.ok().flatten().unwrap_or(vk::API_VERSION_1_0);
    let application = vk::ApplicationInfo::default()
        .application_name(c"parafovea-probe")
        .api_version(version.min(vk::API_VERSION_1_3));
    let info = vk::InstanceCreateInfo::default().application_info(&application);
    // SAFETY: valid usage: neither layers nor extensions; all pointers outlive the call.
    let instance = unsafe { entry.create_instance(&info, None) };
    Ok((instance.map_err(|error| format!("vkCreateInstance: {error}"))?, version))
}

pub(crate) fn entry() -> Result<Entry, String> {
    // SAFETY: the system's Vulkan loader is one.
    unsafe { Entry::load() }.map_err(|error| format!("the Vulkan loader cannot be loaded: {error}"))
}

/// # Safety
///
/// A live instance of that version at most, and a device of it.
unsafe fn describe(entry: &Entry, instance: &Instance, version: u32, device: vk::PhysicalDevice) -> Device {
    // SAFETY: the caller vouches for the instance and the device.
    let properties = unsafe { instance.get_physical_device_properties(device) };
    let mut described = Device {
        name: properties.device_name_as_c_str().map(text).unwrap_or_default(),
        is_cpu: properties.device_type == vk::PhysicalDeviceType::CPU,
        version: parts(properties.api_version),
        ..Device::default()
    };
    if version.min(properties.api_version) < vk::API_VERSION_1_1 {
        return described;
    }
    // SAFETY: as above; both the instance and the device are of Vulkan 1.1 or newer, as these functions ask for.
    unsafe {
        let extensions = instance.enumerate_device_extension_properties(device).unwrap_or_default();
        let has = |name: &CStr| extensions.iter().any(|found| found.extension_name_as_c_str() == Ok(name));
        if properties.api_version >= vk::API_VERSION_1_2 || has(ash::khr::driver_properties::NAME) {
            let mut driver = vk::PhysicalDeviceDriverProperties::default();
            instance.get_physical_device_properties2(
                device,
                &mut vk::PhysicalDeviceProperties2::default().push_next(&mut driver),
            );
            let name = driver.driver_name_as_c_str().map(text).unwrap_or_default();
            let info = driver.driver_info_as_c_str().map(text).unwrap_or_default();
            described.driver = format!("{name} {info}").trim().to_owned();
            described.driver_id = driver.driver_id.as_raw().cast_unsigned();
            described.driver_version = parts(properties.driver_version);
        }
        if !has(fragment_shading_rate::NAME) {
            return described;
        }
        let mut features = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default();
        instance.get_physical_device_features2(
            device,
            &mut vk::PhysicalDeviceFeatures2::default().push_next(&mut features),
        );
        if features.attachment_fragment_shading_rate == vk::FALSE {
            return described;
        }
        let mut limits = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
        instance.get_physical_device_properties2(
            device,
            &mut vk::PhysicalDeviceProperties2::default().push_next(&mut limits),
        );
        let size = |extent: vk::Extent2D| [extent.width, extent.height];
        described.texel = [
            size(limits.min_fragment_shading_rate_attachment_texel_size),
            size(limits.max_fragment_shading_rate_attachment_texel_size),
        ];
        described.layered = limits.layered_shading_rate_attachments == vk::TRUE;
        described.samples = limits.max_fragment_shading_rate_rasterization_samples.as_raw();
        let functions = fragment_shading_rate::Instance::new(entry, instance);
        let ask = functions.fp().get_physical_device_fragment_shading_rates_khr;
        let mut count = 0;
        let mut rates = Vec::new();
        if ask(device, &mut count, std::ptr::null_mut()).result().is_ok() {
            rates.resize(count as usize, vk::PhysicalDeviceFragmentShadingRateKHR::default());
            let asked = ask(device, &mut count, rates.as_mut_ptr());
            rates.truncate(if asked.result().is_ok() { count as usize } else { 0 });
        }
        described.rates = rates
            .iter()
            .filter(|rate| rate.sample_counts.contains(vk::SampleCountFlags::TYPE_1))
            .map(|rate| format!("{}x{}", rate.fragment_size.width, rate.fragment_size.height))
            .collect();
    }
    described
}

pub(crate) fn text(name: &CStr) -> String {
    name.to_string_lossy().into_owned()
}

fn parts(version: u32) -> [u32; 3] {
    [vk::api_version_major(version), vk::api_version_minor(version), vk::api_version_patch(version)]
}
