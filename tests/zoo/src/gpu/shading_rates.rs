//! The shading rates of devices (`--shading-rates`).

use super::{Gpu, RATES};
use anyhow::Result;
use ash::khr::fragment_shading_rate;
use ash::vk;
use parafovea_test_layers::{ShadingRate, ShadingRateDevice, ShadingRateLimits};
use std::ffi::CStr;

impl Gpu {
    /// Shading rates of each device of the instance with VK_KHR_fragment_shading_rate.
    ///
    /// # Errors
    /// Errors of the queries.
    pub fn shading_rates(&self) -> Result<Vec<ShadingRateDevice>> {
        // SAFETY: the instance is live.
        let devices = unsafe { self.instance.enumerate_physical_devices() }?;
        let mut found = Vec::new();
        for device in devices {
            // SAFETY: the physical device is of this instance.
            let extensions = unsafe { self.instance.enumerate_device_extension_properties(device) }?;
            if extensions.iter().any(|extension| extension.extension_name_as_c_str() == Ok(RATES)) {
                found.push(self.describe_rates(device)?);
            }
        }
        Ok(found)
    }

    fn describe_rates(&self, device: vk::PhysicalDevice) -> Result<ShadingRateDevice> {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut limits = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
        let mut properties =
            vk::PhysicalDeviceProperties2::default().push_next(&mut driver).push_next(&mut limits);
        let mut own = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default();
        let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut own);
        // SAFETY: the physical device is of this instance, and the chains hold structures of its extensions.
        unsafe {
            self.instance.get_physical_device_properties2(device, &mut properties);
            self.instance.get_physical_device_features2(device, &mut features);
        }
        let text = |text: Result<&CStr, _>| text.map(CStr::to_string_lossy).unwrap_or_default().into_owned();
        let name = text(properties.properties.device_name_as_c_str());
        Ok(ShadingRateDevice {
            device: name.trim().to_owned(),
            driver: format!(
                "{} {}",
                text(driver.driver_name_as_c_str()),
                text(driver.driver_info_as_c_str())
            ),
            pipeline: own.pipeline_fragment_shading_rate == vk::TRUE,
            primitive: own.primitive_fragment_shading_rate == vk::TRUE,
            attachment: own.attachment_fragment_shading_rate == vk::TRUE,
            limits: ShadingRateLimits::from(&limits),
            rates: self.rates_of(device)?,
        })
    }

    fn rates_of(&self, device: vk::PhysicalDevice) -> Result<Vec<ShadingRate>> {
        let functions = fragment_shading_rate::Instance::new(&self.entry, &self.instance);
        let ask = functions.fp().get_physical_device_fragment_shading_rates_khr;
        let mut count = 0;
        // SAFETY: the physical device is of this instance and has the extension; no array is given.
        unsafe { ask(device, &mut count, std::ptr::null_mut()) }.result()?;
        let mut rates = vec![vk::PhysicalDeviceFragmentShadingRateKHR::default(); count as usize];
        // SAFETY: as above; the array has room for `count`.
        unsafe { ask(device, &mut count, rates.as_mut_ptr()) }.result()?;
        rates.truncate(count as usize);
        let rate = |rate: &vk::PhysicalDeviceFragmentShadingRateKHR<'_>| ShadingRate {
            size: [rate.fragment_size.width, rate.fragment_size.height],
            samples: rate.sample_counts.as_raw(),
        };
        Ok(rates.iter().map(rate).collect())
    }
}
