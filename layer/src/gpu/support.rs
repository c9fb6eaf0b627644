//! Limits and formats of the device.

use super::Gpu;
use ash::vk;

impl Gpu {
    /// Whether the device is a program on the CPU.
    pub(crate) fn is_software(&self) -> bool {
        self.is_software
    }

    /// Whether every queue that can draw can compute.
    pub(crate) fn computes_where_it_draws(&self) -> bool {
        // SAFETY: the physical device is one of this live instance; this only fills structures.
        let families =
            unsafe { self.instance.get_physical_device_queue_family_properties(self.physical_device) };
        let mut drawing =
            families.iter().filter(|family| family.queue_flags.contains(vk::QueueFlags::GRAPHICS));
        drawing.all(|family| family.queue_flags.contains(vk::QueueFlags::COMPUTE))
    }

    /// Whether the device supports an image of `info`, without its chain, but with that usage.
    pub(crate) fn takes_image(&self, info: &vk::ImageCreateInfo<'_>, usage: vk::ImageUsageFlags) -> bool {
        // SAFETY: the physical device is one of this live instance.
        let limits = unsafe {
            self.instance.get_physical_device_image_format_properties(
                self.physical_device,
                info.format,
                info.image_type,
                info.tiling,
                usage,
                info.flags,
            )
        };
        limits.is_ok_and(|limits| {
            limits.max_extent.width >= info.extent.width
                && limits.max_extent.height >= info.extent.height
                && limits.max_mip_levels >= info.mip_levels
                && limits.max_array_layers >= info.array_layers
                && limits.sample_counts.contains(info.samples)
        })
    }

    /// Whether a pipeline layout may have `sets` descriptor sets, with so many storage and uniform buffers, and `all` descriptors
    /// that fragment shaders see. Limits of sets that may be updated after they are bound are no lower.
    pub(crate) fn takes_sets(&self, sets: u32, [storage, uniform]: [u32; 2], all: u32) -> bool {
        let limits = &self.limits;
        sets <= limits.max_bound_descriptor_sets
            && storage <= limits.max_per_stage_descriptor_storage_buffers
            && storage <= limits.max_descriptor_set_storage_buffers
            && uniform <= limits.max_per_stage_descriptor_uniform_buffers
            && uniform <= limits.max_descriptor_set_uniform_buffers
            && all <= limits.max_per_stage_resources
    }

    /// Whether images of this format can be sampled, drawn to and copied.
    pub(crate) fn can_compose(&self, format: vk::Format) -> bool {
        self.has_features(
            format,
            vk::FormatFeatureFlags::SAMPLED_IMAGE | vk::FormatFeatureFlags::COLOR_ATTACHMENT,
        )
    }

    /// Whether draws to images of this format can be blended with their content.
    pub(crate) fn can_blend(&self, format: vk::Format) -> bool {
        self.has_features(format, vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND)
    }

    fn has_features(&self, format: vk::Format, needed: vk::FormatFeatureFlags) -> bool {
        // SAFETY: the physical device is one of this live instance.
        let properties =
            unsafe { self.instance.get_physical_device_format_properties(self.physical_device, format) };
        properties.optimal_tiling_features.contains(needed)
    }
}
