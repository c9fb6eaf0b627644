//! The features that counting needs, added to the application's.

use super::Kind;
use crate::layer::{Instance, NextDevice};
use ash::vk;

/// Features of the device.
pub(super) struct Features {
    kind: Kind,
    /// The queries of that kind.
    queries: bool,
    pub inherited_queries: bool,
    /// Nanoseconds of a timestamp's step.
    pub timestamp_period_ns: f32,
}

/// Capabilities of a queue family.
pub(super) struct Family {
    /// They draw.
    pub draws: bool,
    /// Bits of their timestamps that hold; 0: there are none.
    pub timestamp_bits: u32,
}

impl Features {
    /// # Safety
    ///
    /// The physical device is a live one of the instance.
    pub unsafe fn of(kind: Kind, instance: &Instance, physical_device: vk::PhysicalDevice) -> Self {
        let mut features = vk::PhysicalDeviceFeatures::default();
        let mut properties = vk::PhysicalDeviceProperties::default();
        // SAFETY: the caller vouches for the handle.
        unsafe {
            (instance.features)(physical_device, &mut features);
            if let Some(ask) = instance.physical_device.properties {
                ask(physical_device, &mut properties);
            }
        }
        let timestamp_period_ns = properties.limits.timestamp_period;
        let queries = match kind {
            Kind::Invocations => features.pipeline_statistics_query == vk::TRUE,
            Kind::Samples => features.occlusion_query_precise == vk::TRUE,
            Kind::Times => timestamp_period_ns > 0.0,
        };
        let inherited_queries = features.inherited_queries == vk::TRUE;
        Self { kind, queries, inherited_queries, timestamp_period_ns }
    }

    /// Creates the device with the features on; returns also why counting is not possible, if so.
    ///
    /// Features that the application chains are amended in place, because there must be only one such
    /// structure, and put back after the call.
    ///
    /// # Safety
    ///
    /// `info` is a valid structure, whose chain no other code uses during the call.
    pub unsafe fn amend(
        &self,
        mut info: vk::DeviceCreateInfo<'_>,
        create: &mut dyn FnMut(&vk::DeviceCreateInfo<'_>) -> Result<NextDevice, vk::Result>,
    ) -> Result<(NextDevice, Option<&'static str>), vk::Result> {
        // SAFETY: the caller vouches for `info` and its chain.
        unsafe {
            let chained = chained_features(&info);
            let asked = chained.as_deref().or(info.p_enabled_features.as_ref());
            let own_statistics = asked.is_some_and(|asked| asked.pipeline_statistics_query == vk::TRUE);
            let missing = match (self.kind, self.queries) {
                (Kind::Invocations, false) => Some("the device has no pipelineStatisticsQuery"),
                (Kind::Samples, false) => Some("the device has no occlusionQueryPrecise"),
                (Kind::Times, false) => Some("the device has no timestamps"),
                (Kind::Invocations, true) if own_statistics => {
                    Some("the application uses pipeline statistics itself")
                }
                (_, true) => None,
            };
            if missing.is_some() || self.kind == Kind::Times {
                return create(&info).map(|next| (next, missing));
            }
            let before = asked.copied().unwrap_or_default();
            let mut amended = vk::PhysicalDeviceFeatures {
                inherited_queries: before.inherited_queries | vk::Bool32::from(self.inherited_queries),
                ..before
            };
            match self.kind {
                Kind::Invocations => amended.pipeline_statistics_query = vk::TRUE,
                Kind::Samples => amended.occlusion_query_precise = vk::TRUE,
                Kind::Times => {}
            }
            let created = if let Some(chained) = chained {
                *chained = amended;
                let created = create(&info);
                *chained = before;
                created
            } else {
                info.p_enabled_features = &amended;
                create(&info)
            };
            created.map(|next| (next, None))
        }
    }
}

/// The features in the application's VkPhysicalDeviceFeatures2, if it chains one.
///
/// # Safety
///
/// `info` is a valid structure, whose chain no other code uses while the result lives.
unsafe fn chained_features<'a>(
    info: &vk::DeviceCreateInfo<'_>,
) -> Option<&'a mut vk::PhysicalDeviceFeatures> {
    let mut at = info.p_next.cast_mut().cast::<vk::BaseOutStructure<'_>>();
    while !at.is_null() {
        // SAFETY: the caller vouches for the chain; the type identifies the structure.
        unsafe {
            if (*at).s_type == vk::StructureType::PHYSICAL_DEVICE_FEATURES_2 {
                return Some(&mut (*at.cast::<vk::PhysicalDeviceFeatures2<'_>>()).features);
            }
            at = (*at).p_next;
        }
    }
    None
}

/// Capabilities of the queue families: a family without graphics has no queries of draws.
///
/// # Safety
///
/// The physical device is a live one of the instance.
pub(super) unsafe fn families(instance: &Instance, physical_device: vk::PhysicalDevice) -> Vec<Family> {
    // SAFETY: the caller vouches for the handle; the second call has the room that the first asked for.
    let families = unsafe {
        let mut count = 0;
        (instance.queue_families)(physical_device, &mut count, std::ptr::null_mut());
        let mut families = vec![vk::QueueFamilyProperties::default(); count as usize];
        (instance.queue_families)(physical_device, &mut count, families.as_mut_ptr());
        families
    };
    let family = |family: &vk::QueueFamilyProperties| Family {
        draws: family.queue_flags.contains(vk::QueueFlags::GRAPHICS),
        timestamp_bits: family.timestamp_valid_bits,
    };
    families.iter().map(family).collect()
}
