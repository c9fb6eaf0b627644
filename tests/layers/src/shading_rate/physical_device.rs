//! Answers about a physical device: the next layer's, and the extension.

use super::Emulator;
use super::chain::{LeftOut, find};
use super::lower::{self, RATE_USAGE};
use super::profile::{SHADING_RATE_GPU_VARIABLE, ShadingRateProfile};
use crate::functions::PhysicalDeviceFunctions;
use crate::layer::{hooks, instance_of};
use ash::vk;
use std::ffi::{CStr, c_char};

/// The format of rate attachments, which is the only one that the specification requires.
pub(super) const FORMAT: vk::Format = vk::Format::R8_UINT;

pub(super) fn hook(name: &CStr) -> vk::PFN_vkVoidFunction {
    hooks! { name;
        c"vkEnumerateDeviceExtensionProperties": PFN_vkEnumerateDeviceExtensionProperties = extensions;
        c"vkGetPhysicalDeviceFeatures2": PFN_vkGetPhysicalDeviceFeatures2 = features2;
        c"vkGetPhysicalDeviceFeatures2KHR": PFN_vkGetPhysicalDeviceFeatures2 = features2;
        c"vkGetPhysicalDeviceProperties": PFN_vkGetPhysicalDeviceProperties = properties;
        c"vkGetPhysicalDeviceProperties2": PFN_vkGetPhysicalDeviceProperties2 = properties2;
        c"vkGetPhysicalDeviceProperties2KHR": PFN_vkGetPhysicalDeviceProperties2 = properties2;
        c"vkGetPhysicalDeviceFormatProperties": PFN_vkGetPhysicalDeviceFormatProperties = format_properties;
        c"vkGetPhysicalDeviceFormatProperties2": PFN_vkGetPhysicalDeviceFormatProperties2 = format_properties2;
        c"vkGetPhysicalDeviceFormatProperties2KHR":
            PFN_vkGetPhysicalDeviceFormatProperties2 = format_properties2;
        c"vkGetPhysicalDeviceImageFormatProperties":
            PFN_vkGetPhysicalDeviceImageFormatProperties = image_format_properties;
        c"vkGetPhysicalDeviceImageFormatProperties2":
            PFN_vkGetPhysicalDeviceImageFormatProperties2 = image_format_properties2;
        c"vkGetPhysicalDeviceImageFormatProperties2KHR":
            PFN_vkGetPhysicalDeviceImageFormatProperties2 = image_format_properties2;
    }
    None
}

/// # Safety
///
/// `physical_device` is a live one.
unsafe fn next(physical_device: vk::PhysicalDevice) -> PhysicalDeviceFunctions {
    // SAFETY: the caller vouches for it.
    match unsafe { instance_of::<Emulator>(physical_device) } {
        Some(instance) => instance.physical_device,
        None => panic!("a physical device of an instance that was created without this layer"),
    }
}

/// Answers a question for a list in Vulkan's way: the number alone, or as many as there is room for.
///
/// # Safety
///
/// `count` is valid; `to` is null or has room for that many.
unsafe fn list<T: Copy>(from: &[T], count: *mut u32, to: *mut T, copy: impl Fn(&T, &mut T)) -> vk::Result {
    // SAFETY: the caller vouches for the room.
    unsafe {
        if to.is_null() {
            *count = from.len() as u32;
            return vk::Result::SUCCESS;
        }
        let room = (*count as usize).min(from.len());
        for (index, element) in from.iter().take(room).enumerate() {
            copy(element, &mut *to.add(index));
        }
        *count = room as u32;
        if room < from.len() { vk::Result::INCOMPLETE } else { vk::Result::SUCCESS }
    }
}

/// # Safety
/// As `vkEnumerateDeviceExtensionProperties`.
unsafe extern "system" fn extensions(
    physical_device: vk::PhysicalDevice,
    layer: *const c_char,
    count: *mut u32,
    properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    // SAFETY: the application's valid arguments; the second call has the room that the first asked for.
    unsafe {
        let Some(next) = next(physical_device).extensions else { return vk::Result::ERROR_UNKNOWN };
        if !layer.is_null() {
            return next(physical_device, layer, count, properties);
        }
        let mut known = 0;
        let result = next(physical_device, layer, &mut known, std::ptr::null_mut());
        if result != vk::Result::SUCCESS {
            return result;
        }
        let mut all = vec![vk::ExtensionProperties::default(); known as usize];
        let result = next(physical_device, layer, &mut known, all.as_mut_ptr());
        if result != vk::Result::SUCCESS {
            return result;
        }
        all.truncate(known as usize);
        let name = vk::KHR_FRAGMENT_SHADING_RATE_NAME;
        if !all.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name)) {
            let version = vk::KHR_FRAGMENT_SHADING_RATE_SPEC_VERSION;
            let mut own = vk::ExtensionProperties::default().spec_version(version);
            for (to, from) in own.extension_name.iter_mut().zip(name.to_bytes_with_nul()) {
                *to = *from as c_char;
            }
            all.push(own);
        }
        list(&all, count, properties, |from, to| *to = *from)
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceFeatures2`.
unsafe extern "system" fn features2(
    physical_device: vk::PhysicalDevice,
    features: *mut vk::PhysicalDeviceFeatures2<'_>,
) {
    type Rates<'a> = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'a>;
    // SAFETY: the application's valid arguments, whose chain is for writing.
    unsafe {
        let Some(next) = next(physical_device).features2 else { return };
        let own = find::<Rates<'_>>((*features).p_next).map(|own| std::ptr::from_ref(own).cast_mut());
        let mut left_out = LeftOut::new();
        left_out.leave_out(features, vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_SHADING_RATE_FEATURES_KHR);
        next(physical_device, features);
        drop(left_out);
        if let Some(own) = own {
            let device = ShadingRateProfile::of_environment().device();
            (*own).pipeline_fragment_shading_rate = device.pipeline.into();
            (*own).primitive_fragment_shading_rate = device.primitive.into();
            (*own).attachment_fragment_shading_rate = device.attachment.into();
        }
    }
}

/// Whether the device reports that it is a discrete GPU.
fn is_gpu() -> bool {
    std::env::var_os(SHADING_RATE_GPU_VARIABLE).is_some_and(|value| value == "1")
}

/// # Safety
/// As `vkGetPhysicalDeviceProperties`.
unsafe extern "system" fn properties(
    physical_device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(next) = next(physical_device).properties else { return };
        next(physical_device, properties);
        if is_gpu() {
            (*properties).device_type = vk::PhysicalDeviceType::DISCRETE_GPU;
        }
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceProperties2`.
unsafe extern "system" fn properties2(
    physical_device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties2<'_>,
) {
    type Rates<'a> = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'a>;
    // SAFETY: the application's valid arguments, whose chain is for writing.
    unsafe {
        let Some(next) = next(physical_device).properties2 else { return };
        let own = find::<Rates<'_>>((*properties).p_next).map(|own| std::ptr::from_ref(own).cast_mut());
        let mut left_out = LeftOut::new();
        left_out
            .leave_out(properties, vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_SHADING_RATE_PROPERTIES_KHR);
        next(physical_device, properties);
        drop(left_out);
        if is_gpu() {
            (*properties).properties.device_type = vk::PhysicalDeviceType::DISCRETE_GPU;
        }
        if let Some(own) = own {
            ShadingRateProfile::of_environment().write_properties(&mut *own);
        }
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceFragmentShadingRatesKHR`.
pub(super) unsafe extern "system" fn rates(
    _: vk::PhysicalDevice,
    count: *mut u32,
    rates: *mut vk::PhysicalDeviceFragmentShadingRateKHR<'_>,
) -> vk::Result {
    let profile = ShadingRateProfile::of_environment();
    let own: Vec<_> = profile
        .rates()
        .iter()
        .map(|rate| {
            let [width, height] = rate.size;
            vk::PhysicalDeviceFragmentShadingRateKHR::default()
                .sample_counts(vk::SampleCountFlags::from_raw(rate.samples))
                .fragment_size(vk::Extent2D { width, height })
        })
        .collect();
    // SAFETY: the application's valid arguments.
    unsafe {
        list(&own, count, rates, |from, to| {
            to.sample_counts = from.sample_counts;
            to.fragment_size = from.fragment_size;
        })
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceFormatProperties`.
unsafe extern "system" fn format_properties(
    physical_device: vk::PhysicalDevice,
    format: vk::Format,
    properties: *mut vk::FormatProperties,
) {
    // SAFETY: the application's valid arguments.
    unsafe {
        let Some(next) = next(physical_device).format_properties else { return };
        next(physical_device, format, properties);
        if format == FORMAT {
            (*properties).optimal_tiling_features |=
                vk::FormatFeatureFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
        }
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceFormatProperties2`.
unsafe extern "system" fn format_properties2(
    physical_device: vk::PhysicalDevice,
    format: vk::Format,
    properties: *mut vk::FormatProperties2<'_>,
) {
    // SAFETY: the application's valid arguments, whose chain is for writing.
    unsafe {
        let Some(next) = next(physical_device).format_properties2 else { return };
        next(physical_device, format, properties);
        if format == FORMAT {
            (*properties).format_properties.optimal_tiling_features |=
                vk::FormatFeatureFlags::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
            if let Some(third) = find::<vk::FormatProperties3<'_>>((*properties).p_next) {
                let third = std::ptr::from_ref(third).cast_mut();
                (*third).optimal_tiling_features |=
                    vk::FormatFeatureFlags2::FRAGMENT_SHADING_RATE_ATTACHMENT_KHR;
            }
        }
    }
}

/// Whether an image of these can be a rate attachment, if it is to be one.
fn is_supported(
    format: vk::Format,
    image_type: vk::ImageType,
    tiling: vk::ImageTiling,
    usage: vk::ImageUsageFlags,
) -> bool {
    !usage.contains(RATE_USAGE)
        || (format == FORMAT && image_type == vk::ImageType::TYPE_2D && tiling == vk::ImageTiling::OPTIMAL)
}

/// # Safety
/// As `vkGetPhysicalDeviceImageFormatProperties`.
unsafe extern "system" fn image_format_properties(
    physical_device: vk::PhysicalDevice,
    format: vk::Format,
    image_type: vk::ImageType,
    tiling: vk::ImageTiling,
    usage: vk::ImageUsageFlags,
    flags: vk::ImageCreateFlags,
    properties: *mut vk::ImageFormatProperties,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let next = next(physical_device).image_format_properties;
        let Some(next) = next.filter(|_| is_supported(format, image_type, tiling, usage)) else {
            return vk::Result::ERROR_FORMAT_NOT_SUPPORTED;
        };
        let lowered = lower::usage(usage);
        let result = next(physical_device, format, image_type, tiling, lowered, flags, properties);
        if result == vk::Result::SUCCESS && lowered != usage {
            (*properties).sample_counts = vk::SampleCountFlags::TYPE_1;
        }
        result
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceImageFormatProperties2`.
unsafe extern "system" fn image_format_properties2(
    physical_device: vk::PhysicalDevice,
    info: *const vk::PhysicalDeviceImageFormatInfo2<'_>,
    properties: *mut vk::ImageFormatProperties2<'_>,
) -> vk::Result {
    // SAFETY: the application's valid arguments.
    unsafe {
        let mut lowered = *info;
        lowered.usage = lower::usage(lowered.usage);
        let supported = is_supported((*info).format, (*info).ty, (*info).tiling, (*info).usage);
        let Some(next) = next(physical_device).image_format_properties2.filter(|_| supported) else {
            return vk::Result::ERROR_FORMAT_NOT_SUPPORTED;
        };
        let result = next(physical_device, &lowered, properties);
        if result == vk::Result::SUCCESS && lowered.usage != (*info).usage {
            (*properties).image_format_properties.sample_counts = vk::SampleCountFlags::TYPE_1;
        }
        result
    }
}
