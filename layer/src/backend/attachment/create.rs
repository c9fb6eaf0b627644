//! The creation of instances and devices, with the additions that rate attachments need.

use super::capabilities::{NoRates, Questions, RateCapabilities, extensions_of};
use crate::abi::copies::{Copies, find, slice};
use crate::vk::instance::{Instance, properties};
use crate::vk::quirks;
use ash::vk;
use parafovea_manifest::quirks::Quirks;
use std::ffi::CStr;

/// The creation of an instance, with `VK_KHR_get_physical_device_properties2` added if the application asked for a version without it.
/// `None` if it is enabled already.
///
/// # Safety
///
/// `info` is valid (valid usage of vkCreateInstance). The result points to memory of `info` and of `copies`.
pub unsafe fn instance<'c>(
    info: &vk::InstanceCreateInfo<'c>,
    api_version: u32,
    copies: &mut Copies<'_>,
) -> Option<vk::InstanceCreateInfo<'c>> {
    let name = vk::KHR_GET_PHYSICAL_DEVICE_PROPERTIES2_NAME;
    // SAFETY: the names are valid, by the valid usage of vkCreateInstance.
    let names = unsafe { Names::new(info.pp_enabled_extension_names, info.enabled_extension_count) };
    if api_version >= vk::API_VERSION_1_1 || names.has(name) {
        return None;
    }
    let (first, count) = names.with(&[name], copies);
    Some(vk::InstanceCreateInfo {
        pp_enabled_extension_names: first,
        enabled_extension_count: count,
        ..*info
    })
}

type Features<'a> = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'a>;

/// The extensions and features of a created device.
#[derive(Clone, Debug)]
pub struct Enabled {
    /// The capabilities of its rate attachments.
    pub capabilities: RateCapabilities,
    /// Its quirks.
    pub quirks: Quirks,
    /// Families of its queues, each once.
    pub families: Vec<u32>,
    /// Whether `VK_KHR_image_format_list` is available.
    pub has_format_lists: bool,
    /// Whether the application enables the extension itself.
    pub application_enables_rates: bool,
    /// Whether it enables the feature, too, with which it has to set a rate before it draws with shader objects.
    pub application_sets_rates: bool,
    /// Whether it may attach rates of its own to passes.
    pub application_attaches_rates: bool,
    /// Whether pipelines may be linked from parts.
    pub links_pipelines: bool,
}

/// The creation of a device, with the extension, its dependencies, and its features added.
///
/// Features that the application chains itself are amended, also if it enables them for its own rates: its own passes and pipelines are
/// distinguished later.
///
/// # Errors
///
/// The reason why the device gets no rate attachments.
///
/// # Safety
///
/// The physical device is a live one of the instance; `info` and its chain are valid, outlive `copies`, and are not used elsewhere
/// meanwhile. The result points to memory of `info` and of `copies`.
pub unsafe fn device<'c>(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
    api_version: u32,
    info: &vk::DeviceCreateInfo<'c>,
    copies: &mut Copies<'_>,
) -> Result<(vk::DeviceCreateInfo<'c>, Enabled), NoRates> {
    // SAFETY: the chain is valid, as `# Safety` demands.
    let (excluding, libraries, own_rates) = unsafe {
        let libraries = find::<vk::PhysicalDeviceGraphicsPipelineLibraryFeaturesEXT<'_>>(info.p_next);
        (excluding(info), libraries, find::<Features<'_>>(info.p_next).copied())
    };
    if let Some(other) = excluding {
        return Err(NoRates::Excluded(other));
    }
    // SAFETY: `info` is valid, as `# Safety` demands: so many names and queues.
    let (names, queues) = unsafe {
        let names = Names::new(info.pp_enabled_extension_names, info.enabled_extension_count);
        (names, slice(info.p_queue_create_infos, info.queue_create_info_count))
    };
    let missing = NEEDED.iter().filter(|(name, built_in)| api_version < *built_in && !names.has(name));
    let needed: Vec<&'static CStr> = missing.map(|(name, _)| *name).collect();
    // SAFETY: the physical device is a live one of the instance, as `# Safety` demands.
    let offered = unsafe { extensions_of(instance, physical_device) };
    let is_offered = |name: &CStr| offered.iter().any(|other| other.extension_name_as_c_str() == Ok(name));
    if let Some(missing) = needed.iter().find(|name| !is_offered(name)) {
        return Err(NoRates::Extension(missing));
    }
    let has_driver_id = api_version >= vk::API_VERSION_1_2 || is_offered(vk::KHR_DRIVER_PROPERTIES_NAME);
    // SAFETY: instance and physical device are live, as `# Safety` demands, and the latter offers the extensions of the queried properties.
    let (capabilities, quirks) = unsafe {
        let questions = Questions::new(instance)?;
        let driver_id = has_driver_id.then(|| questions.driver_id(physical_device));
        let quirks = quirks::of_device(&properties(instance, physical_device), driver_id);
        (questions.ask(physical_device)?.limited(&quirks), quirks)
    };
    let (first, count) = names.with(&needed, copies);
    let mut families: Vec<u32> = queues.iter().map(|queues| queues.queue_family_index).collect();
    families.sort_unstable();
    families.dedup();
    let amended = vk::DeviceCreateInfo {
        // SAFETY: the chain is valid, as above.
        p_next: unsafe { with_features(info.p_next, copies) },
        pp_enabled_extension_names: first,
        enabled_extension_count: count,
        ..*info
    };
    let has_format_lists = api_version >= vk::API_VERSION_1_2 || names.has(vk::KHR_IMAGE_FORMAT_LIST_NAME);
    let enabled = Enabled {
        capabilities,
        quirks,
        families,
        has_format_lists,
        application_enables_rates: names.has(vk::KHR_FRAGMENT_SHADING_RATE_NAME),
        application_sets_rates: own_rates.is_some_and(|own| own.pipeline_fragment_shading_rate == vk::TRUE),
        application_attaches_rates: own_rates
            .is_some_and(|own| own.attachment_fragment_shading_rate == vk::TRUE),
        links_pipelines: libraries.is_some_and(|found| found.graphics_pipeline_library == vk::TRUE),
    };
    Ok((amended, enabled))
}

/// The extension and its dependencies, each with the first version of Vulkan that has it built in.
const NEEDED: [(&CStr, u32); 4] = [
    (vk::KHR_FRAGMENT_SHADING_RATE_NAME, u32::MAX),
    (vk::KHR_CREATE_RENDERPASS2_NAME, vk::API_VERSION_1_2),
    (vk::KHR_MULTIVIEW_NAME, vk::API_VERSION_1_1),
    (vk::KHR_MAINTENANCE2_NAME, vk::API_VERSION_1_1),
];

/// A technique that the application enables, and which the specification excludes together with ours
/// (VUID-VkDeviceCreateInfo-shadingRateImage-04478 to fragmentDensityMap-04483).
///
/// # Safety
///
/// The chain is valid.
unsafe fn excluding(info: &vk::DeviceCreateInfo<'_>) -> Option<&'static str> {
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        let density = find::<vk::PhysicalDeviceFragmentDensityMapFeaturesEXT<'_>>(info.p_next);
        let image = find::<vk::PhysicalDeviceShadingRateImageFeaturesNV<'_>>(info.p_next);
        if density.is_some_and(|features| features.fragment_density_map == vk::TRUE) {
            Some("fragmentDensityMap")
        } else if image.is_some_and(|features| features.shading_rate_image == vk::TRUE) {
            Some("shadingRateImage")
        } else {
            None
        }
    }
}

/// The chain with both features on: in the application's structure, where there is one, else in one of ours.
///
/// # Safety
///
/// The chain is valid and outlives `copies`.
unsafe fn with_features(p_next: *const std::ffi::c_void, copies: &mut Copies<'_>) -> *const std::ffi::c_void {
    let enable = |features: &mut Features<'_>| {
        features.pipeline_fragment_shading_rate = vk::TRUE;
        features.attachment_fragment_shading_rate = vk::TRUE;
    };
    // SAFETY: the chain is valid, as `# Safety` demands.
    unsafe {
        if find::<Features<'_>>(p_next).is_some() {
            return copies.amend::<Features<'_>>(p_next, enable);
        }
    }
    let mut own = Features { p_next: p_next.cast_mut(), ..Default::default() };
    enable(&mut own);
    copies.one(own).cast_const().cast()
}

/// The names of extensions that an application enables.
struct Names<'c>(&'c [*const std::ffi::c_char]);

impl<'c> Names<'c> {
    /// # Safety
    ///
    /// So many valid names, which live for `'c`.
    unsafe fn new(first: *const *const std::ffi::c_char, count: u32) -> Self {
        // SAFETY: so many names are there, as `# Safety` demands.
        Self(unsafe { slice(first, count) })
    }

    fn has(&self, name: &CStr) -> bool {
        // SAFETY: `new` was promised that the names are valid.
        self.0.iter().any(|&other| unsafe { CStr::from_ptr(other) } == name)
    }

    /// These and `more`, which must live as long as `copies`, as an array and its length.
    fn with(&self, more: &[&CStr], copies: &mut Copies<'_>) -> (*const *const std::ffi::c_char, u32) {
        let all: Vec<_> = self.0.iter().copied().chain(more.iter().map(|name| name.as_ptr())).collect();
        (copies.many(all.iter().copied()).cast_const(), all.len() as u32)
    }
}
