//! Choice of the device (`--device`).

use super::Gpu;
use anyhow::Result;
use ash::vk;
use serde::{Deserialize, Serialize};
use std::ffi::CStr;

/// A Vulkan device, by its own properties.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Device {
    /// Its name.
    pub name: String,
    /// The driver's name and version.
    pub driver: String,
    /// Whether a CPU renders.
    pub is_cpu: bool,
    /// Whether it has rate attachments (`attachmentFragmentShadingRate` of VK_KHR_fragment_shading_rate).
    pub has_rate_attachments: bool,
    /// Smallest and largest texel of a rate attachment, pixels; 0 without.
    pub rate_texels: [[u32; 2]; 2],
    /// Bits of timestamps on queues that draw; 0: none are written there.
    pub timestamp_bits: u32,
    /// Nanoseconds of a timestamp's step.
    pub timestamp_period_ns: f32,
}

/// The extension.
pub(super) const RATES: &CStr = c"VK_KHR_fragment_shading_rate";

impl Gpu {
    /// All devices of the instance.
    ///
    /// # Errors
    /// Errors of the queries.
    pub fn devices(&self) -> Result<Vec<Device>> {
        // SAFETY: the instance is live.
        let devices = unsafe { self.instance.enumerate_physical_devices() }?;
        devices.into_iter().map(|device| describe(&self.instance, device)).collect()
    }
}

fn describe(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Result<Device> {
    // SAFETY: the physical device is of this instance.
    let extensions = unsafe { instance.enumerate_device_extension_properties(physical) }?;
    let has_rates = extensions.iter().any(|found| found.extension_name_as_c_str().is_ok_and(|n| n == RATES));
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut rates = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
    let mut rate_features = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    let mut features = vk::PhysicalDeviceFeatures2::default();
    if has_rates {
        properties = properties.push_next(&mut rates);
        features = features.push_next(&mut rate_features);
    }
    // SAFETY: as above; the chains hold structures of extensions and versions that the device has.
    let families = unsafe {
        instance.get_physical_device_properties2(physical, &mut properties);
        instance.get_physical_device_features2(physical, &mut features);
        instance.get_physical_device_queue_family_properties(physical)
    };
    let core = properties.properties;
    let drawing = families.iter().find(|family| family.queue_flags.contains(vk::QueueFlags::GRAPHICS));
    let text = |text: Result<&CStr, _>| text.map(CStr::to_string_lossy).unwrap_or_default().into_owned();
    let size = |size: vk::Extent2D| [size.width, size.height];
    Ok(Device {
        name: text(core.device_name_as_c_str()),
        driver: format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str())),
        is_cpu: core.device_type == vk::PhysicalDeviceType::CPU,
        has_rate_attachments: rate_features.attachment_fragment_shading_rate == vk::TRUE,
        rate_texels: [
            size(rates.min_fragment_shading_rate_attachment_texel_size),
            size(rates.max_fragment_shading_rate_attachment_texel_size),
        ],
        timestamp_bits: drawing.map_or(0, |family| family.timestamp_valid_bits),
        timestamp_period_ns: core.limits.timestamp_period,
    })
}
