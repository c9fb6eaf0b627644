//! The shading rates of a device, as `parafovea-zoo --shading-rates` asks for them and `tests/layers/profiles` keeps them.

use ash::vk;
use serde::{Deserialize, Serialize};

/// A device's features, properties and rates of `VK_KHR_fragment_shading_rate`.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct ShadingRateDevice {
    /// Its name.
    pub device: String,
    /// The driver's name and version.
    pub driver: String,
    /// `pipelineFragmentShadingRate`.
    pub pipeline: bool,
    /// `primitiveFragmentShadingRate`.
    pub primitive: bool,
    /// `attachmentFragmentShadingRate`.
    pub attachment: bool,
    /// `VkPhysicalDeviceFragmentShadingRatePropertiesKHR`.
    pub limits: ShadingRateLimits,
    /// Rates of `vkGetPhysicalDeviceFragmentShadingRatesKHR`, in its order.
    pub rates: Vec<ShadingRate>,
}

/// `VkPhysicalDeviceFragmentShadingRatePropertiesKHR`, in the order of its members; sizes are width and height in pixels.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct ShadingRateLimits {
    /// `minFragmentShadingRateAttachmentTexelSize`.
    pub min_texel: [u32; 2],
    /// `maxFragmentShadingRateAttachmentTexelSize`.
    pub max_texel: [u32; 2],
    /// `maxFragmentShadingRateAttachmentTexelSizeAspectRatio`.
    pub max_texel_aspect_ratio: u32,
    /// `primitiveFragmentShadingRateWithMultipleViewports`.
    pub primitive_with_multiple_viewports: bool,
    /// `layeredShadingRateAttachments`.
    pub layered_attachments: bool,
    /// `fragmentShadingRateNonTrivialCombinerOps`.
    pub non_trivial_combiners: bool,
    /// `maxFragmentSize`.
    pub max_size: [u32; 2],
    /// `maxFragmentSizeAspectRatio`.
    pub max_size_aspect_ratio: u32,
    /// `maxFragmentShadingRateCoverageSamples`.
    pub max_coverage_samples: u32,
    /// `maxFragmentShadingRateRasterizationSamples`: one bit of `VkSampleCountFlagBits`.
    pub max_samples: u32,
    /// `fragmentShadingRateWithShaderDepthStencilWrites`.
    pub with_depth_stencil_writes: bool,
    /// `fragmentShadingRateWithSampleMask`.
    pub with_sample_mask: bool,
    /// `fragmentShadingRateWithShaderSampleMask`.
    pub with_shader_sample_mask: bool,
    /// `fragmentShadingRateWithConservativeRasterization`.
    pub with_conservative_rasterization: bool,
    /// `fragmentShadingRateWithFragmentShaderInterlock`.
    pub with_interlock: bool,
    /// `fragmentShadingRateWithCustomSampleLocations`.
    pub with_custom_sample_locations: bool,
    /// `fragmentShadingRateStrictMultiplyCombiner`.
    pub strict_multiply: bool,
}

/// A size of fragments, and the numbers of samples that it goes with.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct ShadingRate {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Bits of `VkSampleCountFlags`.
    pub samples: u32,
}

impl From<&vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>> for ShadingRateLimits {
    fn from(from: &vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>) -> Self {
        let size = |extent: vk::Extent2D| [extent.width, extent.height];
        let is = |flag: vk::Bool32| flag == vk::TRUE;
        Self {
            min_texel: size(from.min_fragment_shading_rate_attachment_texel_size),
            max_texel: size(from.max_fragment_shading_rate_attachment_texel_size),
            max_texel_aspect_ratio: from.max_fragment_shading_rate_attachment_texel_size_aspect_ratio,
            primitive_with_multiple_viewports: is(
                from.primitive_fragment_shading_rate_with_multiple_viewports
            ),
            layered_attachments: is(from.layered_shading_rate_attachments),
            non_trivial_combiners: is(from.fragment_shading_rate_non_trivial_combiner_ops),
            max_size: size(from.max_fragment_size),
            max_size_aspect_ratio: from.max_fragment_size_aspect_ratio,
            max_coverage_samples: from.max_fragment_shading_rate_coverage_samples,
            max_samples: from.max_fragment_shading_rate_rasterization_samples.as_raw(),
            with_depth_stencil_writes: is(from.fragment_shading_rate_with_shader_depth_stencil_writes),
            with_sample_mask: is(from.fragment_shading_rate_with_sample_mask),
            with_shader_sample_mask: is(from.fragment_shading_rate_with_shader_sample_mask),
            with_conservative_rasterization: is(from.fragment_shading_rate_with_conservative_rasterization),
            with_interlock: is(from.fragment_shading_rate_with_fragment_shader_interlock),
            with_custom_sample_locations: is(from.fragment_shading_rate_with_custom_sample_locations),
            strict_multiply: is(from.fragment_shading_rate_strict_multiply_combiner),
        }
    }
}

impl ShadingRateLimits {
    /// Writes the limits, and leaves the structure's chain alone.
    pub(super) fn write(&self, to: &mut vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>) {
        let extent = |[width, height]: [u32; 2]| vk::Extent2D { width, height };
        *to = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR {
            p_next: to.p_next,
            min_fragment_shading_rate_attachment_texel_size: extent(self.min_texel),
            max_fragment_shading_rate_attachment_texel_size: extent(self.max_texel),
            max_fragment_shading_rate_attachment_texel_size_aspect_ratio: self.max_texel_aspect_ratio,
            primitive_fragment_shading_rate_with_multiple_viewports: self
                .primitive_with_multiple_viewports
                .into(),
            layered_shading_rate_attachments: self.layered_attachments.into(),
            fragment_shading_rate_non_trivial_combiner_ops: self.non_trivial_combiners.into(),
            max_fragment_size: extent(self.max_size),
            max_fragment_size_aspect_ratio: self.max_size_aspect_ratio,
            max_fragment_shading_rate_coverage_samples: self.max_coverage_samples,
            max_fragment_shading_rate_rasterization_samples: vk::SampleCountFlags::from_raw(self.max_samples),
            fragment_shading_rate_with_shader_depth_stencil_writes: self.with_depth_stencil_writes.into(),
            fragment_shading_rate_with_sample_mask: self.with_sample_mask.into(),
            fragment_shading_rate_with_shader_sample_mask: self.with_shader_sample_mask.into(),
            fragment_shading_rate_with_conservative_rasterization: self
                .with_conservative_rasterization
                .into(),
            fragment_shading_rate_with_fragment_shader_interlock: self.with_interlock.into(),
            fragment_shading_rate_with_custom_sample_locations: self.with_custom_sample_locations.into(),
            fragment_shading_rate_strict_multiply_combiner: self.strict_multiply.into(),
            ..Default::default()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::super::ShadingRateProfile;
    use super::*;

    #[test]
    fn limits_are_read_as_they_were_written() {
        for profile in ShadingRateProfile::ALL {
            let mut properties = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR::default();
            profile.device().limits.write(&mut properties);
            assert_eq!(ShadingRateLimits::from(&properties), profile.device().limits, "{}", profile.name());
        }
    }
}
