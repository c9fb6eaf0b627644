//! The stand-in's shading rates, and whether it lets them be enabled.

use super::types;
use crate::abi::copies::find;
use crate::backend::attachment::commands::SetRate;
use ash::vk::{self, TaggedStructure};
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char};

/// The extensions of a device that lacks rate attachments.
const OTHERS: [&CStr; 3] = [c"VK_a", c"VK_b", c"VK_KHR_multiview"];

thread_local! {
    static OFFERED: Cell<bool> = const { Cell::new(false) };
    static REFUSED: Cell<bool> = const { Cell::new(false) };
    static ENABLED: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
    static DRIVER: Cell<vk::DriverId> = const { Cell::new(vk::DriverId::from_raw(0)) };
    static NAME: Cell<&'static [u8]> = const { Cell::new(b"") };
    static HAS_DEVICE_SCOPE: Cell<bool> = const { Cell::new(false) };
    static MEMORY_MODEL: Cell<[u32; 2]> = const { Cell::new([0; 2]) };
    static FEATURES: Cell<[u32; 3]> = const { Cell::new([0; 3]) };
    static SET: RefCell<Vec<SetRate>> = const { RefCell::new(Vec::new()) };
}

/// The rates that were set since the last call.
pub fn taken_set() -> Vec<SetRate> {
    SET.take()
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn set_rate(
    _: vk::CommandBuffer,
    size: *const vk::Extent2D,
    combiners: *const [vk::FragmentShadingRateCombinerOpKHR; 2],
) {
    // SAFETY: the caller's valid pointers.
    let rate = unsafe { SetRate { size: *size, combiners: *combiners } };
    SET.with_borrow_mut(|set| set.push(rate));
}

/// From now on, devices on this thread have rate attachments, or not; creation with them is `refused`.
pub fn capabilities(offered: bool, refused: bool) {
    OFFERED.set(offered);
    REFUSED.set(refused);
}

/// From now on, devices on this thread have the memory model's device scope, or not.
pub fn scope(offered: bool) {
    HAS_DEVICE_SCOPE.set(offered);
}

/// The memory model and its device scope, as the last device enabled them.
pub fn memory_model() -> [u32; 2] {
    MEMORY_MODEL.get()
}

/// From now on, devices on this thread are of this driver, of version 25.0.7, and have this name.
pub fn drive(driver: vk::DriverId, name: &'static [u8]) {
    DRIVER.set(driver);
    NAME.set(name);
}

/// Writes the name and the driver's version.
pub fn describe(properties: &mut vk::PhysicalDeviceProperties) {
    properties.driver_version = vk::make_api_version(0, 25, 0, 7);
    for (to, from) in properties.device_name.iter_mut().zip(NAME.get()) {
        *to = from.cast_signed();
    }
}

/// Whether devices have rate attachments, and with them all functions.
pub fn is_offered() -> bool {
    OFFERED.get()
}

/// The extensions that the last instance or device enabled.
pub fn enabled() -> Vec<String> {
    ENABLED.with_borrow(Clone::clone)
}

/// The rate features that the last device enabled: of pipelines, primitives, attachments.
pub fn features() -> [u32; 3] {
    FEATURES.get()
}

fn extensions() -> Vec<&'static CStr> {
    let own =
        [vk::KHR_FRAGMENT_SHADING_RATE_NAME, vk::KHR_CREATE_RENDERPASS2_NAME, vk::KHR_MAINTENANCE2_NAME];
    OTHERS.into_iter().chain(own.into_iter().filter(|_| OFFERED.get())).collect()
}

/// # Safety
///
/// There are that many valid names.
unsafe fn note_names(first: *const *const c_char, count: u32) -> Result<(), vk::Result> {
    let mut names = Vec::new();
    for index in 0..count as usize {
        // SAFETY: the caller passes so many names.
        names.push(unsafe { CStr::from_ptr(*first.add(index)) }.to_string_lossy().into_owned());
    }
    let refused = REFUSED.get()
        && names.iter().any(|name| name.contains("fragment_shading_rate") || name.contains("properties2"));
    ENABLED.set(names);
    if refused { Err(vk::Result::ERROR_EXTENSION_NOT_PRESENT) } else { Ok(()) }
}

/// # Safety
///
/// The structure is valid.
pub unsafe fn instance_created(info: &vk::InstanceCreateInfo<'_>) -> Result<(), vk::Result> {
    // SAFETY: the caller's valid structure.
    unsafe { note_names(info.pp_enabled_extension_names, info.enabled_extension_count) }
}

/// # Safety
///
/// The structure and its chain are valid.
pub unsafe fn device_created(info: &vk::DeviceCreateInfo<'_>) -> Result<(), vk::Result> {
    type Features<'a> = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'a>;
    let own = Features::STRUCTURE_TYPE.as_raw();
    let count = types(info.p_next).into_iter().filter(|&s_type| s_type == own).count();
    assert!(count <= 1, "a structure is doubled");
    // SAFETY: the caller's valid structures.
    unsafe {
        let features = find::<Features<'_>>(info.p_next);
        FEATURES.set(features.map_or([0; 3], |features| {
            [
                features.pipeline_fragment_shading_rate,
                features.primitive_fragment_shading_rate,
                features.attachment_fragment_shading_rate,
            ]
        }));
        MEMORY_MODEL.set(memory_model_of(info));
        note_names(info.pp_enabled_extension_names, info.enabled_extension_count)
    }
}

/// # Safety
///
/// The structure and its chain are valid.
unsafe fn memory_model_of(info: &vk::DeviceCreateInfo<'_>) -> [u32; 2] {
    // SAFETY: the caller's valid structures.
    let (alone, vulkan12) = unsafe {
        (
            find::<vk::PhysicalDeviceVulkanMemoryModelFeatures<'_>>(info.p_next),
            find::<vk::PhysicalDeviceVulkan12Features<'_>>(info.p_next),
        )
    };
    let alone = alone.map(|found| [found.vulkan_memory_model, found.vulkan_memory_model_device_scope]);
    let in_12 = vulkan12.map(|found| [found.vulkan_memory_model, found.vulkan_memory_model_device_scope]);
    alone.or(in_12).unwrap_or_default()
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn enumerate_device_extensions(
    _: vk::PhysicalDevice,
    _: *const c_char,
    count: *mut u32,
    properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    let all = extensions();
    // SAFETY: the caller passes a count, and null or room for as many.
    unsafe {
        *count = all.len() as u32;
        if !properties.is_null() {
            for (index, name) in all.iter().enumerate() {
                let mut extension = vk::ExtensionProperties::default();
                for (to, from) in extension.extension_name.iter_mut().zip(name.to_bytes()) {
                    *to = from.cast_signed();
                }
                *properties.add(index) = extension;
            }
        }
    }
    vk::Result::SUCCESS
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn features2(
    _: vk::PhysicalDevice,
    features: *mut vk::PhysicalDeviceFeatures2<'_>,
) {
    // SAFETY: the layer chains one structure to write to.
    unsafe {
        let model = (*features).p_next.cast::<vk::PhysicalDeviceVulkanMemoryModelFeatures<'_>>();
        if (*model).s_type == vk::PhysicalDeviceVulkanMemoryModelFeatures::STRUCTURE_TYPE {
            (*model).vulkan_memory_model = vk::TRUE;
            (*model).vulkan_memory_model_device_scope = vk::Bool32::from(HAS_DEVICE_SCOPE.get());
            return;
        }
        let own = (*features).p_next.cast::<vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'_>>();
        (*own).pipeline_fragment_shading_rate = vk::TRUE;
        (*own).attachment_fragment_shading_rate = vk::TRUE;
    }
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn properties2(
    _: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties2<'_>,
) {
    let texel = vk::Extent2D { width: 16, height: 16 };
    // SAFETY: as above.
    unsafe {
        let driver = (*properties).p_next.cast::<vk::PhysicalDeviceDriverProperties<'_>>();
        if (*driver).s_type == vk::PhysicalDeviceDriverProperties::STRUCTURE_TYPE {
            (*driver).driver_id = DRIVER.get();
            return;
        }
        let own = (*properties).p_next.cast::<vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>>();
        (*own).min_fragment_shading_rate_attachment_texel_size = texel;
        (*own).max_fragment_shading_rate_attachment_texel_size = texel;
        (*own).max_fragment_shading_rate_attachment_texel_size_aspect_ratio = 1;
        (*own).layered_shading_rate_attachments = vk::TRUE;
        (*own).max_fragment_shading_rate_rasterization_samples = vk::SampleCountFlags::TYPE_8;
    }
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn memory_properties(
    _: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceMemoryProperties,
) {
    // SAFETY: the caller passes a structure to write to.
    unsafe { *properties = vk::PhysicalDeviceMemoryProperties::default() };
}

/// # Safety
///
/// As the call.
pub unsafe extern "system" fn shading_rates(
    _: vk::PhysicalDevice,
    count: *mut u32,
    rates: *mut vk::PhysicalDeviceFragmentShadingRateKHR<'_>,
) -> vk::Result {
    // SAFETY: the caller passes a count, and null or room for as many.
    unsafe {
        *count = 2;
        if !rates.is_null() {
            for (index, side) in [2, 1].into_iter().enumerate() {
                *rates.add(index) = vk::PhysicalDeviceFragmentShadingRateKHR::default()
                    .sample_counts(vk::SampleCountFlags::TYPE_1)
                    .fragment_size(vk::Extent2D { width: side, height: side });
            }
        }
    }
    vk::Result::SUCCESS
}
