//! Shading rates: number of pixels per invocation of the fragment shader.

/// Size of the block of pixels that is shaded once, each side 1, 2 or 4 pixels: a fragment size of
/// `VK_KHR_fragment_shading_rate`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShadingRate {
    log2_width: u8,
    log2_height: u8,
}

impl ShadingRate {
    /// Every pixel is shaded.
    pub const R1X1: Self = Self { log2_width: 0, log2_height: 0 };
    /// One invocation for 2 x 1 pixels, 1/2.
    pub const R2X1: Self = Self { log2_width: 1, log2_height: 0 };
    /// One invocation for 1 x 2 pixels, 1/2.
    pub const R1X2: Self = Self { log2_width: 0, log2_height: 1 };
    /// One invocation for 2 x 2 pixels, 1/4.
    pub const R2X2: Self = Self { log2_width: 1, log2_height: 1 };
    /// One invocation for 4 x 2 pixels, 1/8.
    pub const R4X2: Self = Self { log2_width: 2, log2_height: 1 };
    /// One invocation for 2 x 4 pixels, 1/8.
    pub const R2X4: Self = Self { log2_width: 1, log2_height: 2 };
    /// One invocation for 4 x 4 pixels, 1/16.
    pub const R4X4: Self = Self { log2_width: 2, log2_height: 2 };

    /// Width of the block, pixels: 1, 2 or 4.
    pub const fn width(self) -> u32 {
        1 << self.log2_width
    }

    /// Height of the block, pixels: 1, 2 or 4.
    pub const fn height(self) -> u32 {
        1 << self.log2_height
    }

    /// The area rate `sr` of paper A: invocations per pixel, 1/16..=1.
    pub fn fraction(self) -> f32 {
        1.0 / (1u32 << (self.log2_width + self.log2_height)) as f32
    }

    /// -log2 of the square root of [`Self::fraction`]: octaves of spatial frequency that the block removes, averaged
    /// over both directions, 0..=2.
    pub fn octaves(self) -> f32 {
        f32::from(self.log2_width + self.log2_height) * 0.5
    }

    /// The texel of a rate image, as Vulkan reads it: width = 2^((texel / 4) & 3), height = 2^(texel & 3)
    /// (Vulkan specification, "Attachment Fragment Shading Rate").
    pub const fn texel(self) -> u8 {
        self.log2_width << 2 | self.log2_height
    }

    /// The rate of a texel of a rate image; nothing for a block larger than 4 or with bits beyond the two sides.
    pub const fn from_texel(texel: u8) -> Option<Self> {
        let (log2_width, log2_height) = (texel >> 2, texel & 3);
        if log2_width > 2 || log2_height > 2 { None } else { Some(Self { log2_width, log2_height }) }
    }

    /// The rate that is as fine as both in each direction.
    pub fn finer(self, other: Self) -> Self {
        Self {
            log2_width: self.log2_width.min(other.log2_width),
            log2_height: self.log2_height.min(other.log2_height),
        }
    }
}

/// Paper A's array SR: the rates of its device, coarsest first (Algorithm 2 tries them in this order).
pub const PAPER_RATES: [ShadingRate; 4] =
    [ShadingRate::R4X4, ShadingRate::R2X4, ShadingRate::R2X2, ShadingRate::R1X1];

/// The seven rates of `VK_KHR_fragment_shading_rate` that its devices commonly offer, coarsest first. Of rates that remove
/// equally many octaves, the wider block comes first, as in Vulkan's own order.
pub const VULKAN_RATES: [ShadingRate; 7] = [
    ShadingRate::R4X4,
    ShadingRate::R4X2,
    ShadingRate::R2X4,
    ShadingRate::R2X2,
    ShadingRate::R2X1,
    ShadingRate::R1X2,
    ShadingRate::R1X1,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_read_back() {
        let rates: Vec<ShadingRate> = (0..=u8::MAX).filter_map(ShadingRate::from_texel).collect();
        assert_eq!(rates.len(), 9);
        for rate in rates {
            assert_eq!(ShadingRate::from_texel(rate.texel()), Some(rate));
            assert_eq!(rate.fraction(), 1.0 / (rate.width() * rate.height()) as f32);
            assert_eq!(rate.fraction().sqrt().log2(), -rate.octaves());
        }
        // Vulkan specification: 4 x 2 pixels is texel 2 << 2 | 1.
        assert_eq!(ShadingRate::R4X2.texel(), 9);
    }

    #[test]
    fn paper_rates_become_finer() {
        assert_eq!(PAPER_RATES.map(ShadingRate::fraction), [0.0625, 0.125, 0.25, 1.0]);
    }

    #[test]
    fn finer_is_finer_in_both_directions() {
        assert_eq!(ShadingRate::R4X2.finer(ShadingRate::R2X4), ShadingRate::R2X2);
        assert_eq!(ShadingRate::R4X4.finer(ShadingRate::R1X1), ShadingRate::R1X1);
    }
}
