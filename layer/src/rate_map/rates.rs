//! The rates of a device, and unary.

use parafovea_core::rate::ShadingRate;
use parafovea_core::reuse::STALE;

/// Unary of 1x1.
pub(super) const FULL: u8 = 0;

/// Number of rates in unary, including impossible ones.
const UNARY: usize = 16;

/// The rates of a device, as a table from permitted to available rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceRates {
    /// Texel of the coarsest rate that a unary rate permits.
    texels: [u8; UNARY],
    offered: RateSet,
}

impl DeviceRates {
    /// From the rates offered, in any order; 1x1 is always there. Of two that are as coarse (4x2 and 2x4 where 4x4
    /// is permitted) the one offered first is taken.
    pub fn new(offered: impl Iterator<Item = ShadingRate> + Clone) -> Self {
        let texels = std::array::from_fn(|permitted| {
            let permits = |rate: &ShadingRate| unary(*rate) & !(permitted as u8) == 0;
            let coarser = |best: ShadingRate, rate: ShadingRate| {
                if rate.fraction() < best.fraction() { rate } else { best }
            };
            offered.clone().filter(permits).fold(ShadingRate::R1X1, coarser).texel()
        });
        let mut set = RateSet::default();
        set.insert(ShadingRate::R1X1);
        offered.for_each(|rate| set.insert(rate));
        Self { texels, offered: set }
    }

    /// The texel of the coarsest rate of the device that is as fine as a unary one; both with [`STALE`].
    pub(super) fn of_unary(&self, permitted: u8) -> u8 {
        self.texels[usize::from(permitted) % UNARY] | permitted & STALE
    }

    /// The texel of the coarsest rate that each unary rate permits.
    pub fn available(&self) -> [u8; UNARY] {
        self.texels
    }

    /// Sets stale texels to the coarsest rate, for passes that shade everything.
    pub fn coarsen_stale(&self, texels: &mut [u8]) {
        let coarsest = self.texels[UNARY - 1];
        for texel in texels {
            *texel = if *texel & STALE == 0 { *texel } else { coarsest };
        }
    }

    /// Whether the device has all of `rates`.
    pub(super) fn has_all(&self, rates: RateSet) -> bool {
        rates.0 & !self.offered.0 == 0
    }
}

/// Makes texels that are not stale 1x1.
pub fn refine_fresh(texels: &mut [u8]) {
    for texel in texels {
        *texel = if *texel & STALE == 0 { ShadingRate::R1X1.texel() } else { *texel };
    }
}

/// Some rates, a bit for each texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct RateSet(u16);

impl RateSet {
    pub(super) fn insert(&mut self, rate: ShadingRate) {
        self.0 |= 1 << rate.texel();
    }
}

/// A rate as unary: two bits a side, of which the lower ones are set first.
pub(super) fn unary(rate: ShadingRate) -> u8 {
    // 1, 2, 4 pixels: 0b00, 0b01, 0b11.
    let side = |pixels: u32| (pixels - 1) as u8;
    side(rate.width()) << 2 | side(rate.height())
}

/// The texel of a tile's byte, with [`STALE`]; 1x1 for a byte that is not a rate.
pub(super) fn clean(byte: u8) -> u8 {
    // As `ShadingRate::from_texel`, in comparisons that the compiler makes for many tiles at once.
    let is_rate = byte & !STALE < 0b1100 && byte & 0b11 != 0b11;
    if is_rate { byte } else { byte & STALE }
}

/// The unary rate of a texel of [`clean`], with [`STALE`].
pub(super) fn unary_of(texel: u8) -> u8 {
    // The upper bit of each side sets the lower one, too: 0b10 becomes 0b11.
    texel | texel >> 1 & 0b0101
}

/// Some rates, and whether any tile with one of them is coarser than 1x1 and not stale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct UsedRates(u32);

impl UsedRates {
    const COARSENS: u32 = 1 << 16;

    /// Rates of texels of [`clean`].
    pub(super) fn of(texels: &[u8]) -> Self {
        let mut has = [false; 256];
        for texel in texels {
            has[usize::from(*texel)] = true;
        }
        let has = |texel: usize| has[texel];
        let rates = (0..16).filter(|rate| has(*rate) || has(rate | usize::from(STALE)));
        let used = rates.fold(0, |used, rate| used | 1 << rate);
        let coarsens = (1..16).any(has);
        Self(used | if coarsens { Self::COARSENS } else { 0 })
    }

    pub(super) fn rates(self) -> RateSet {
        RateSet(self.0 as u16)
    }

    pub(super) fn coarsens(self) -> bool {
        self.0 & Self::COARSENS != 0
    }
}
