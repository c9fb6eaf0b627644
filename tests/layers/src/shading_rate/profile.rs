//! Profiles of devices that the layer can present: answers of Mesa's real drivers over its no-op kernel shims, in `tests/layers/profiles`
//! (`cargo dev drivers --profiles` writes them).

use super::device_limits::{ShadingRate, ShadingRateDevice};
use ash::vk;
use std::str::FromStr;
use std::sync::LazyLock;

/// The variable with the name of a [`ShadingRateProfile`]; without it, the layer is `nvk-turing`.
pub const SHADING_RATE_PROFILE_VARIABLE: &str = "PARAFOVEA_TEST_SHADING_RATE_PROFILE";

/// The variable that, set to 1, has any device report that it is a discrete GPU.
pub const SHADING_RATE_GPU_VARIABLE: &str = "PARAFOVEA_TEST_SHADING_RATE_GPU";

/// A device that the layer can look like.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShadingRateProfile {
    /// NVIDIA Turing with NVK: texels of 16x16, rates up to 4x4, layered attachments.
    NvkTuring,
    /// AMD RDNA 2 with RADV: texels of 8x8, rates up to 2x2, one layer, no rates with depth or stencil writes.
    Navi21,
    /// [`Self::NvkTuring`] with one layer and no combiner but KEEP and REPLACE, which the extension allows.
    Unlayered,
    /// Adreno 750 with Turnip: texels of 8x8, rates up to 4x4, one layer.
    Turnip750,
    /// Intel Arc A770 with ANV: texels of 8x8, rates up to 4x4, layered attachments.
    Dg2,
    /// AMD RDNA 3 with RADV: as RDNA 2, also with depth and stencil writes.
    Navi31,
}

static NVK_TURING: LazyLock<ShadingRateDevice> =
    LazyLock::new(|| read(include_str!("../../profiles/nvk-turing.json")));
static NAVI21: LazyLock<ShadingRateDevice> =
    LazyLock::new(|| read(include_str!("../../profiles/navi21.json")));
static UNLAYERED: LazyLock<ShadingRateDevice> = LazyLock::new(|| {
    let mut device = NVK_TURING.clone();
    device.limits.layered_attachments = false;
    device.limits.non_trivial_combiners = false;
    device.limits.strict_multiply = false;
    device
});
static TURNIP_750: LazyLock<ShadingRateDevice> =
    LazyLock::new(|| read(include_str!("../../profiles/turnip-750.json")));
static DG2: LazyLock<ShadingRateDevice> = LazyLock::new(|| read(include_str!("../../profiles/dg2.json")));
static NAVI31: LazyLock<ShadingRateDevice> =
    LazyLock::new(|| read(include_str!("../../profiles/navi31.json")));

/// A test layer that cannot read its own data is useless: it ends the process.
fn read(text: &str) -> ShadingRateDevice {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("tests/layers/profiles: {error}"))
}

impl ShadingRateProfile {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::NvkTuring, Self::Navi21, Self::Unlayered, Self::Turnip750, Self::Dg2, Self::Navi31];

    /// Its name in [`SHADING_RATE_PROFILE_VARIABLE`].
    pub fn name(self) -> &'static str {
        match self {
            Self::NvkTuring => "nvk-turing",
            Self::Navi21 => "navi21",
            Self::Unlayered => "unlayered",
            Self::Turnip750 => "turnip-750",
            Self::Dg2 => "dg2",
            Self::Navi31 => "navi31",
        }
    }

    /// That device's shading rates.
    pub fn device(self) -> &'static ShadingRateDevice {
        match self {
            Self::NvkTuring => &NVK_TURING,
            Self::Navi21 => &NAVI21,
            Self::Unlayered => &UNLAYERED,
            Self::Turnip750 => &TURNIP_750,
            Self::Dg2 => &DG2,
            Self::Navi31 => &NAVI31,
        }
    }

    /// Width and height of the area of a texel of the attachment, in pixels: the least and the most.
    pub fn texel(self) -> u32 {
        self.device().limits.min_texel[0]
    }

    /// Whether an attachment may have a layer for each layer of the framebuffer.
    pub fn layered(self) -> bool {
        self.device().limits.layered_attachments
    }

    /// Whether there are combiners other than KEEP and REPLACE.
    pub fn non_trivial_combiners(self) -> bool {
        self.device().limits.non_trivial_combiners
    }

    /// Whether fragments of that size can be shaded at all.
    pub fn has_rate(self, width: u32, height: u32) -> bool {
        self.rates().iter().any(|rate| rate.size == [width, height])
    }

    pub(super) fn rates(self) -> &'static [ShadingRate] {
        &self.device().rates
    }

    /// The profile of this process. A name that is none ends the process: a test that misspelled it would
    /// not know.
    pub(super) fn of_environment() -> Self {
        match std::env::var(SHADING_RATE_PROFILE_VARIABLE) {
            Err(_) => Self::NvkTuring,
            Ok(name) => match name.parse() {
                Ok(profile) => profile,
                Err(reason) => panic!("{SHADING_RATE_PROFILE_VARIABLE}={name}: {reason}"),
            },
        }
    }

    /// Writes the limits, and leaves the structure's chain alone.
    pub(super) fn write_properties(self, to: &mut vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'_>) {
        self.device().limits.write(to);
    }
}

impl FromStr for ShadingRateProfile {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|profile| profile.name() == name);
        found.ok_or_else(|| format!("not one of {}", Self::ALL.map(Self::name).join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other layers of tests take texels for squares of one size.
    #[test]
    fn every_device_has_square_texels_of_one_size_and_attachments() {
        for profile in ShadingRateProfile::ALL {
            let device = profile.device();
            assert!(device.attachment, "{}", profile.name());
            assert_eq!(device.limits.min_texel, [profile.texel(); 2], "{}", profile.name());
            assert_eq!(device.limits.max_texel, device.limits.min_texel, "{}", profile.name());
            assert!(profile.has_rate(1, 1) && profile.has_rate(2, 2), "{}", profile.name());
        }
    }
}
