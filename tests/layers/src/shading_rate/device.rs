//! The creation of a device: the extension and its features are taken out, and checked.

use super::chain::{LeftOut, count, find, slice};
use super::findings::Findings;
use super::profile::ShadingRateProfile;
use super::state::State;
use super::{Emulator, Functions};
use crate::layer::{Instance, NextDevice};
use ash::vk;
use std::ffi::CStr;
use std::sync::Mutex;

/// Features that the application enabled.
#[derive(Clone, Copy, Default)]
pub(super) struct Enabled {
    pub extension: bool,
    pub pipeline: bool,
    pub primitive: bool,
    pub attachment: bool,
}

const KIND: &str = "device";

/// # Safety
///
/// The handle is live; `info` is a valid structure, whose chain no other code uses during the call.
pub(super) unsafe fn create(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
    mut info: vk::DeviceCreateInfo<'_>,
    create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
) -> Result<Emulator, vk::Result> {
    // SAFETY: the caller vouches for `info` and its chain, which live until the removed structures are put back.
    unsafe {
        let mut findings = Findings::default();
        let enabled = check(instance, physical_device, &info, &mut findings);
        let kept: Vec<_> = slice(info.pp_enabled_extension_names, info.enabled_extension_count)
            .iter()
            .copied()
            .filter(|&name| CStr::from_ptr(name) != vk::KHR_FRAGMENT_SHADING_RATE_NAME)
            .collect();
        info.enabled_extension_count = kept.len() as u32;
        info.pp_enabled_extension_names = kept.as_ptr();
        let mut left_out = LeftOut::new();
        let features = vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_SHADING_RATE_FEATURES_KHR;
        left_out.leave_out(&mut info, features);
        let next = create(&info)?;
        drop(left_out);
        let mut memory = vk::PhysicalDeviceMemoryProperties::default();
        if let Some(memory_properties) = instance.physical_device.memory_properties {
            memory_properties(physical_device, &mut memory);
        }
        Ok(Emulator {
            functions: Functions::load(|name| next.function(name)),
            next,
            profile: ShadingRateProfile::of_environment(),
            enabled,
            state: Mutex::new(State::new(findings, memory)),
        })
    }
}

/// Features that the application enables, with a check of each.
///
/// # Safety
///
/// As for [`create`].
unsafe fn check(
    instance: &Instance,
    physical_device: vk::PhysicalDevice,
    info: &vk::DeviceCreateInfo<'_>,
    findings: &mut Findings,
) -> Enabled {
    type Rates<'a> = vk::PhysicalDeviceFragmentShadingRateFeaturesKHR<'a>;
    // SAFETY: the caller vouches for `info`, its names and its chain.
    unsafe {
        let names = slice(info.pp_enabled_extension_names, info.enabled_extension_count);
        let has = |name: &CStr| names.iter().any(|&other| CStr::from_ptr(other) == name);
        let extension = has(vk::KHR_FRAGMENT_SHADING_RATE_NAME);
        if extension {
            let rule = "VUID-vkCreateDevice-ppEnabledExtensionNames-01387";
            let core = instance.api_version >= vk::API_VERSION_1_2;
            let holds = core || has(vk::KHR_CREATE_RENDERPASS2_NAME);
            findings.require(holds, KIND, rule, physical_device, || {
                "VK_KHR_fragment_shading_rate needs VK_KHR_create_renderpass2 or Vulkan 1.2".to_owned()
            });
            let rule = "VK_KHR_get_physical_device_properties2";
            findings.require(instance.properties2, KIND, rule, physical_device, || {
                "VK_KHR_fragment_shading_rate needs it, or Vulkan 1.1".to_owned()
            });
        }
        let structures = count(info.p_next, <Rates<'_> as vk::TaggedStructure>::STRUCTURE_TYPE);
        findings.require(
            structures <= 1,
            KIND,
            "VUID-VkDeviceCreateInfo-sType-unique",
            physical_device,
            || format!("{structures} structures VkPhysicalDeviceFragmentShadingRateFeaturesKHR"),
        );
        let holds = extension || structures == 0;
        findings.require(holds, KIND, "VUID-VkDeviceCreateInfo-pNext-pNext", physical_device, || {
            "VkPhysicalDeviceFragmentShadingRateFeaturesKHR without the extension".to_owned()
        });
        let Some(rates) = find::<Rates<'_>>(info.p_next).filter(|_| extension) else {
            return Enabled { extension, ..Enabled::default() };
        };
        let enabled = Enabled {
            extension,
            pipeline: rates.pipeline_fragment_shading_rate == vk::TRUE,
            primitive: rates.primitive_fragment_shading_rate == vk::TRUE,
            attachment: rates.attachment_fragment_shading_rate == vk::TRUE,
        };
        let density = find::<vk::PhysicalDeviceFragmentDensityMapFeaturesEXT<'_>>(info.p_next)
            .is_some_and(|features| features.fragment_density_map == vk::TRUE);
        let image = find::<vk::PhysicalDeviceShadingRateImageFeaturesNV<'_>>(info.p_next)
            .is_some_and(|features| features.shading_rate_image == vk::TRUE);
        for (other, name, ids) in [
            (density, "fragmentDensityMap", ["04481", "04482", "04483"]),
            (image, "shadingRateImage", ["04478", "04479", "04480"]),
        ] {
            for (own, id) in [enabled.pipeline, enabled.primitive, enabled.attachment].into_iter().zip(ids) {
                let rule = format!("VUID-VkDeviceCreateInfo-{name}-{id}");
                findings.require(!(other && own), KIND, &rule, physical_device, || {
                    format!("{name} with a feature of VK_KHR_fragment_shading_rate")
                });
            }
        }
        enabled
    }
}
