//! The devices that the layer can look like.
//!
//! Limits are those that Mesa's drivers report for real devices, as far as a rate attachment is concerned.

use ash::vk;
use std::str::FromStr;

/// The variable with the name of a [`ShadingRateProfile`]; without it, the layer is `layered16`.
pub const SHADING_RATE_PROFILE_VARIABLE: &str = "PARAFOVEA_TEST_SHADING_RATE_PROFILE";

/// The variable that, set to 1, has the device say that it is a discrete GPU, whatever it is.
pub const SHADING_RATE_GPU_VARIABLE: &str = "PARAFOVEA_TEST_SHADING_RATE_GPU";

/// A device that the layer can look like.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShadingRateProfile {
    /// Texels of 16x16, rates up to 4x4, layered attachments: NVIDIA from Turing on (NVK's limits).
    Layered16,
    /// Texels of 8x8, rates up to 2x2, one layer: AMD RDNA 2 and 3 (RADV's limits, which has no layered
    /// attachments either).
    Rdna,
    /// Texels of 16x16, rates up to 4x4, one layer, and no combiner but KEEP and REPLACE. No single device is
    /// so; what is missing is missing in some (Turnip has no layers, Intel before Gfx12.5 has neither).
    Unlayered,
}

type Rate = ([u32; 2], vk::SampleCountFlags);

const fn samples(bits: u32) -> vk::SampleCountFlags {
    vk::SampleCountFlags::from_raw(bits)
}

/// The coarsest first, as vkGetPhysicalDeviceFragmentShadingRatesKHR orders them; 1x1 goes with every number of
/// samples. A fragment covers at most 16 samples.
const UP_TO_4X4: [Rate; 7] = [
    ([4, 4], samples(0b1)),
    ([4, 2], samples(0b11)),
    ([2, 4], samples(0b11)),
    ([2, 2], samples(0b111)),
    ([2, 1], samples(0b1111)),
    ([1, 2], samples(0b1111)),
    ([1, 1], samples(!0)),
];

const UP_TO_2X2: [Rate; 4] =
    [([2, 2], samples(0b1111)), ([2, 1], samples(0b1111)), ([1, 2], samples(0b1111)), ([1, 1], samples(!0))];

impl ShadingRateProfile {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Layered16, Self::Rdna, Self::Unlayered];

    /// Its name in [`SHADING_RATE_PROFILE_VARIABLE`].
    pub fn name(self) -> &'static str {
        match self {
            Self::Layered16 => "layered16",
            Self::Rdna => "rdna",
            Self::Unlayered => "unlayered",
        }
    }

    /// Width and height of what a texel of the attachment covers, in pixels: the least and the most.
    pub fn texel(self) -> u32 {
        if self == Self::Rdna { 8 } else { 16 }
    }

    /// Whether an attachment may have a layer for each layer of the framebuffer.
    pub fn layered(self) -> bool {
        self == Self::Layered16
    }

    /// Whether there are combiners other than KEEP and REPLACE.
    pub fn non_trivial_combiners(self) -> bool {
        self != Self::Unlayered
    }

    /// Whether fragments of that size can be shaded at all.
    pub fn has_rate(self, width: u32, height: u32) -> bool {
        self.rates().iter().any(|&(size, _)| size == [width, height])
    }

    pub(super) fn rates(self) -> &'static [Rate] {
        if self == Self::Rdna { &UP_TO_2X2 } else { &UP_TO_4X4 }
    }

    /// The profile of this process. A name that is none ends the process: a test that misspelled it would
    /// not know.
    pub(super) fn of_environment() -> Self {
        match std::env::var(SHADING_RATE_PROFILE_VARIABLE) {
            Err(_) => Self::Layered16,
            Ok(name) => match name.parse() {
                Ok(profile) => profile,
                Err(reason) => panic!("{SHADING_RATE_PROFILE_VARIABLE}={name}: {reason}"),
            },
        }
    }

    /// Writes the limits, and leaves the structure's chain as it is.
    pub(super) fn write_properties(self, to: &mut vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>) {
        let rdna = self == Self::Rdna;
        let texel = vk::Extent2D { width: self.texel(), height: self.texel() };
        let side = if rdna { 2 } else { 4 };
        *to = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR {
            p_next: to.p_next,
            min_fragment_shading_rate_attachment_texel_size: texel,
            max_fragment_shading_rate_attachment_texel_size: texel,
            max_fragment_shading_rate_attachment_texel_size_aspect_ratio: 1,
            primitive_fragment_shading_rate_with_multiple_viewports: vk::TRUE,
            layered_shading_rate_attachments: self.layered().into(),
            fragment_shading_rate_non_trivial_combiner_ops: self.non_trivial_combiners().into(),
            max_fragment_size: vk::Extent2D { width: side, height: side },
            max_fragment_size_aspect_ratio: 2,
            max_fragment_shading_rate_coverage_samples: if rdna { 32 } else { 16 },
            max_fragment_shading_rate_rasterization_samples: if rdna {
                vk::SampleCountFlags::TYPE_8
            } else {
                vk::SampleCountFlags::TYPE_16
            },
            fragment_shading_rate_with_shader_depth_stencil_writes: (!rdna).into(),
            fragment_shading_rate_with_sample_mask: vk::TRUE,
            fragment_shading_rate_with_shader_sample_mask: (!rdna).into(),
            fragment_shading_rate_with_conservative_rasterization: vk::TRUE,
            fragment_shading_rate_with_fragment_shader_interlock: vk::FALSE,
            fragment_shading_rate_with_custom_sample_locations: (!rdna).into(),
            fragment_shading_rate_strict_multiply_combiner: self.non_trivial_combiners().into(),
            ..Default::default()
        };
    }
}

impl FromStr for ShadingRateProfile {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|profile| profile.name() == name);
        found.ok_or_else(|| format!("not one of {}", Self::ALL.map(Self::name).join(", ")))
    }
}
