//! The capabilities of a device's `VK_KHR_fragment_shading_rate`.

use crate::vk::instance::Instance;
use ash::vk;
use parafovea_core::rate::ShadingRate;
use parafovea_manifest::quirks::{Effect, Quirks};
use smallvec::SmallVec;
use std::ffi::CStr;
use std::mem::transmute;

/// Rates and sizes for plans, and their limits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RateCapabilities {
    /// Width and height of the pixels under a texel of the attachment.
    pub texel: [u32; 2],
    /// Whether an attachment can have a layer for each layer or view of the picture.
    pub layered: bool,
    /// Whether there are combiners beside KEEP and REPLACE.
    pub non_trivial_combiners: bool,
    /// The rates there are with one sample a pixel, the coarsest first, 1x1 among them.
    pub rates: SmallVec<[ShadingRate; 9]>,
    /// Limits beyond which the device shades each pixel regardless of the rate.
    pub limits: Limits,
}

/// Features that the device can combine with shading rates, from `VkPhysicalDeviceFragmentShadingRatePropertiesKHR`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Sample masks of pipelines with a bit that is 0.
    pub sample_mask: bool,
    /// Conservative rasterisation.
    pub conservative_rasterization: bool,
    /// Fragment shader interlock.
    pub interlock: bool,
    /// Custom sample locations.
    pub custom_sample_locations: bool,
    /// Largest number of samples per pixel.
    pub samples: vk::SampleCountFlags,
}

/// Reason why a device gets no rate attachments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRates {
    /// Not one of the device's extensions.
    #[error("the device has no {}", .0.to_string_lossy())]
    Extension(&'static CStr),
    /// A feature of the extension is missing.
    #[error("the device has no {0}")]
    Feature(&'static str),
    /// The application's own technique, with which the specification does not allow ours.
    #[error("the application enables {0}, which excludes VK_KHR_fragment_shading_rate")]
    Excluded(&'static str),
    /// The instance answers no questions about extensions.
    #[error("the instance has no {}", .0.to_string_lossy())]
    Function(&'static CStr),
    /// The device reports impossible properties.
    #[error("the device reports impossible shading rates: {0}")]
    Properties(&'static str),
    /// The device could not be created with our additions.
    #[error("the driver refuses to create the device with shading rates: {0:?}")]
    Refused(vk::Result),
}

/// The questions to a physical device.
pub struct Questions {
    features2: vk::PFN_vkGetPhysicalDeviceFeatures2,
    properties2: vk::PFN_vkGetPhysicalDeviceProperties2,
    rates: vk::PFN_vkGetPhysicalDeviceFragmentShadingRatesKHR,
}

impl Questions {
    /// Resolves the functions.
    ///
    /// # Safety
    ///
    /// The instance is live.
    pub unsafe fn new(instance: &Instance) -> Result<Self, NoRates> {
        // Layers below may answer for names that the driver lacks.
        let is_core = instance.api_version >= vk::API_VERSION_1_1;
        let function = |core: &'static CStr, extension: &'static CStr| {
            let name = if is_core { core } else { extension };
            // SAFETY: the next layer's function for a live instance.
            unsafe { (instance.get_instance_proc_addr)(instance.handle, name.as_ptr()) }
                .ok_or(NoRates::Function(name))
        };
        let features2 = function(c"vkGetPhysicalDeviceFeatures2", c"vkGetPhysicalDeviceFeatures2KHR")?;
        let properties2 = function(c"vkGetPhysicalDeviceProperties2", c"vkGetPhysicalDeviceProperties2KHR")?;
        let name = c"vkGetPhysicalDeviceFragmentShadingRatesKHR";
        let rates = function(name, name)?;
        type Function = unsafe extern "system" fn();
        // SAFETY: the names give the types.
        unsafe {
            Ok(Self {
                features2: transmute::<Function, vk::PFN_vkGetPhysicalDeviceFeatures2>(features2),
                properties2: transmute::<Function, vk::PFN_vkGetPhysicalDeviceProperties2>(properties2),
                rates: transmute::<Function, vk::PFN_vkGetPhysicalDeviceFragmentShadingRatesKHR>(rates),
            })
        }
    }

    /// The capabilities of the device, with both features that rate attachments need.
    ///
    /// # Safety
    ///
    /// `physical_device` is a live one of the instance, and has the extension.
    pub unsafe fn ask(&self, physical_device: vk::PhysicalDevice) -> Result<RateCapabilities, NoRates> {
        let mut features = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR::default();
        let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut features);
        // SAFETY: the handle is live, as `# Safety` demands; the chain is of structures to write to.
        unsafe { (self.features2)(physical_device, &mut all) };
        if features.pipeline_fragment_shading_rate == vk::FALSE {
            return Err(NoRates::Feature("pipelineFragmentShadingRate"));
        }
        if features.attachment_fragment_shading_rate == vk::FALSE {
            return Err(NoRates::Feature("attachmentFragmentShadingRate"));
        }
        let mut properties = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
        let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut properties);
        // SAFETY: as above.
        unsafe { (self.properties2)(physical_device, &mut all) };
        // SAFETY: the handle is live, as `# Safety` demands.
        let rates = unsafe { self.rates(physical_device) };
        RateCapabilities::new(&properties, &rates)
    }

    /// `VkDriverId` of the device's driver.
    ///
    /// # Safety
    ///
    /// `physical_device` is a live one of the instance, and has Vulkan 1.2 or `VK_KHR_driver_properties`.
    pub unsafe fn driver_id(&self, physical_device: vk::PhysicalDevice) -> vk::DriverId {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        // SAFETY: the handle is live, as `# Safety` demands; the chain is of structures to write to.
        unsafe { (self.properties2)(physical_device, &mut all) };
        driver.driver_id
    }

    /// # Safety
    ///
    /// As for [`Self::ask`].
    unsafe fn rates(
        &self,
        physical_device: vk::PhysicalDevice,
    ) -> Vec<vk::PhysicalDeviceFragmentShadingRateKHR<'static>> {
        let mut count = 0;
        // SAFETY: the handle is live, as `# Safety` demands; without an array only the count is written.
        let result = unsafe { (self.rates)(physical_device, &mut count, std::ptr::null_mut()) };
        if result != vk::Result::SUCCESS {
            return Vec::new();
        }
        let mut rates = vec![vk::PhysicalDeviceFragmentShadingRateKHR::default(); count as usize];
        // SAFETY: as above, with room for as many as were counted.
        let result = unsafe { (self.rates)(physical_device, &mut count, rates.as_mut_ptr()) };
        rates.truncate(if result == vk::Result::SUCCESS { count as usize } else { 0 });
        rates
    }
}

/// The best size of the pixels under a texel: smaller ones make larger maps, and few devices have them.
const WANTED_TEXEL: u32 = 16;

impl RateCapabilities {
    /// From the device's properties and its list of rates.
    ///
    /// # Errors
    ///
    /// [`NoRates::Properties`] where they contradict the specification.
    pub fn new(
        properties: &vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>,
        rates: &[vk::PhysicalDeviceFragmentShadingRateKHR<'_>],
    ) -> Result<Self, NoRates> {
        let (least, most) = (
            properties.min_fragment_shading_rate_attachment_texel_size,
            properties.max_fragment_shading_rate_attachment_texel_size,
        );
        let side = |least: u32, most: u32| WANTED_TEXEL.clamp(least.min(most), most);
        let texel = [side(least.width, most.width), side(least.height, most.height)];
        if !texel.iter().all(|side| side.is_power_of_two()) {
            return Err(NoRates::Properties("the texel size is not a power of two"));
        }
        // The sides may differ by this factor; a device where both cannot be alike has a reason to allow more.
        let aspect = properties.max_fragment_shading_rate_attachment_texel_size_aspect_ratio;
        if texel[0].max(texel[1]) > aspect.saturating_mul(texel[0].min(texel[1])) {
            return Err(NoRates::Properties("no texel has an allowed aspect ratio"));
        }
        let with_one_sample =
            rates.iter().filter(|rate| rate.sample_counts.contains(vk::SampleCountFlags::TYPE_1));
        let mut rates: SmallVec<[ShadingRate; 9]> =
            with_one_sample.filter_map(|rate| rate_of(rate.fragment_size)).collect();
        if !rates.contains(&ShadingRate::R1X1) {
            rates.push(ShadingRate::R1X1);
        }
        if rates.len() == 1 {
            return Err(NoRates::Properties("no rate is coarser than 1x1"));
        }
        Ok(Self {
            texel,
            layered: properties.layered_shading_rate_attachments == vk::TRUE,
            non_trivial_combiners: properties.fragment_shading_rate_non_trivial_combiner_ops == vk::TRUE,
            rates,
            limits: Limits::new(properties),
        })
    }

    /// As quirks of the device limit it.
    pub fn limited(mut self, quirks: &Quirks) -> Self {
        self.layered &= !quirks.has(Effect::FirstLayerOnly);
        if let Some(most) = quirks.max_samples() {
            self.limits.samples = self.limits.samples.min(vk::SampleCountFlags::from_raw(most));
        }
        self
    }

    /// Number of texels that cover a picture, columns and rows.
    pub fn texels(&self, extent: [u32; 2]) -> [u32; 2] {
        [0, 1].map(|axis| extent[axis].div_ceil(self.texel[axis]).max(1))
    }

    /// Layers of an attachment for so many layers or views of a picture: all have the same rates where there is but one.
    pub fn layers(&self, of_picture: u32) -> u32 {
        if self.layered { of_picture.max(1) } else { 1 }
    }

    /// The second combiner of a pipeline that obeys the attachment.
    pub fn combiner(&self) -> vk::FragmentShadingRateCombinerOpKHR {
        if self.non_trivial_combiners {
            vk::FragmentShadingRateCombinerOpKHR::MAX
        } else {
            vk::FragmentShadingRateCombinerOpKHR::REPLACE
        }
    }

    /// The size of a texel as Vulkan takes it.
    pub fn texel_size(&self) -> vk::Extent2D {
        vk::Extent2D { width: self.texel[0], height: self.texel[1] }
    }
}

impl Limits {
    fn new(properties: &vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>) -> Self {
        let yes = |limit: vk::Bool32| limit == vk::TRUE;
        Self {
            sample_mask: yes(properties.fragment_shading_rate_with_sample_mask),
            conservative_rasterization: yes(properties.fragment_shading_rate_with_conservative_rasterization),
            interlock: yes(properties.fragment_shading_rate_with_fragment_shader_interlock),
            custom_sample_locations: yes(properties.fragment_shading_rate_with_custom_sample_locations),
            samples: properties.max_fragment_shading_rate_rasterization_samples,
        }
    }
}

/// The rate with fragments of that size; none for sizes beyond 4, which Vulkan does not have.
fn rate_of(size: vk::Extent2D) -> Option<ShadingRate> {
    let log2 =
        |side: u32| side.is_power_of_two().then(|| side.trailing_zeros() as u8).filter(|&log2| log2 <= 2);
    ShadingRate::from_texel(log2(size.width)? << 2 | log2(size.height)?)
}

/// Whether a physical device has an extension.
///
/// # Safety
///
/// `physical_device` is a live one of `instance`.
pub unsafe fn extensions_of(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
) -> Vec<vk::ExtensionProperties> {
    let next = instance.next.enumerate_device_extensions;
    let mut count = 0;
    // SAFETY: the handle is live, as `# Safety` demands; without an array only the count is written.
    let result = unsafe { next(physical_device, std::ptr::null(), &mut count, std::ptr::null_mut()) };
    if result != vk::Result::SUCCESS {
        return Vec::new();
    }
    let mut extensions = vec![vk::ExtensionProperties::default(); count as usize];
    // SAFETY: as above, with room for as many as were counted.
    let result = unsafe { next(physical_device, std::ptr::null(), &mut count, extensions.as_mut_ptr()) };
    extensions.truncate(if result == vk::Result::SUCCESS { count as usize } else { 0 });
    extensions
}

#[cfg(test)]
pub(super) mod tests;
