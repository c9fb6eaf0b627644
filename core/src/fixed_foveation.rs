//! Fixed foveation: the shading rate by eccentricity alone (paper A's baseline FR, section 3.2.1, after Patney et al.
//! 2016 and Guenter et al. 2012).

mod centres;
mod mean;

pub use mean::eccentricities_deg;

use crate::rate::ShadingRate;

/// FR(E_f, E_t): full rate up to `foveal_deg`, falling linearly to the peripheral rate at `transitional_deg`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedFoveation {
    /// E_f, eccentricity up to which every pixel is shaded, degrees, 0..=180.
    pub foveal_deg: f32,
    /// E_t, eccentricity from which on the peripheral rate holds, degrees, 0..=180. Up to E_f means a step at E_f.
    pub transitional_deg: f32,
    /// The coarsest rate. In the paper "the lowest" of variable rate shading, 4x4; with 2x2 its own figures of speed
    /// fit better, so any claim against this baseline has to state it.
    pub peripheral: ShadingRate,
}

/// The paper's three E_f by level L1..L3, degrees.
const FOVEAL_DEG: [f32; 3] = [14.34, 12.26, 9.44];
/// The paper's three E_t by condition C1..C3, degrees.
const TRANSITIONAL_DEG: [f32; 3] = [27.08, 23.49, 18.39];

impl FixedFoveation {
    /// FR_L1-C1, the state of the art that paper A compares with: 14.34 and 27.08 degrees.
    pub const L1_C1: Self = Self::pilot(0, 0);
    /// 14.34 and 23.49 degrees.
    pub const L1_C2: Self = Self::pilot(0, 1);
    /// 14.34 and 18.39 degrees.
    pub const L1_C3: Self = Self::pilot(0, 2);
    /// 12.26 and 27.08 degrees.
    pub const L2_C1: Self = Self::pilot(1, 0);
    /// 12.26 and 23.49 degrees.
    pub const L2_C2: Self = Self::pilot(1, 1);
    /// 12.26 and 18.39 degrees.
    pub const L2_C3: Self = Self::pilot(1, 2);
    /// 9.44 and 27.08 degrees.
    pub const L3_C1: Self = Self::pilot(2, 0);
    /// 9.44 and 23.49 degrees.
    pub const L3_C2: Self = Self::pilot(2, 1);
    /// 9.44 and 18.39 degrees.
    pub const L3_C3: Self = Self::pilot(2, 2);

    /// The peripheral rate everywhere.
    pub const ANYWHERE: Self = Self { foveal_deg: 0.0, transitional_deg: 0.0, peripheral: ShadingRate::R4X4 };

    /// Map for an unknown gaze: full rate to 30 degrees around the axes of both lenses ([`Self::lens_centres`]), and 2x2 from 40 on, the range of
    /// eye movements without the head (Carpenter 1988).
    pub const WITHOUT_TRACKER: Self =
        Self { foveal_deg: 30.0, transitional_deg: 40.0, peripheral: ShadingRate::R2X2 };

    /// The nine of paper A's pilot study (section 3.2.1) in its order, all with a periphery of 4x4.
    pub const PILOT: [Self; 9] = [
        Self::L1_C1,
        Self::L1_C2,
        Self::L1_C3,
        Self::L2_C1,
        Self::L2_C2,
        Self::L2_C3,
        Self::L3_C1,
        Self::L3_C2,
        Self::L3_C3,
    ];

    const fn pilot(level: usize, condition: usize) -> Self {
        Self {
            foveal_deg: FOVEAL_DEG[level],
            transitional_deg: TRANSITIONAL_DEG[condition],
            peripheral: ShadingRate::R4X4,
        }
    }

    /// The same radii with another periphery.
    pub const fn with_peripheral(self, peripheral: ShadingRate) -> Self {
        Self { peripheral, ..self }
    }

    /// This map, nowhere coarser than the periphery of another, and with its radii at least.
    pub fn limited_by(self, other: &Self) -> Self {
        Self {
            foveal_deg: self.foveal_deg.max(other.foveal_deg),
            transitional_deg: self.transitional_deg.max(other.transitional_deg),
            peripheral: if other.peripheral.octaves() < self.peripheral.octaves() {
                other.peripheral
            } else {
                self.peripheral
            },
        }
    }

    /// The area rate at an eccentricity in degrees, 1/16..=1, not rising with it.
    ///
    /// 1 if eccentricity or a radius is NaN: an unknown position is treated as at the gaze.
    #[inline]
    pub fn rate_at(&self, eccentricity_deg: f32) -> f32 {
        if eccentricity_deg.is_nan() || self.foveal_deg.is_nan() || self.transitional_deg.is_nan() {
            return 1.0;
        }
        let (foveal, peripheral) = (self.foveal_deg.max(0.0), self.peripheral.fraction());
        if eccentricity_deg <= foveal {
            1.0
        } else if eccentricity_deg >= self.transitional_deg {
            peripheral
        } else {
            let into = (eccentricity_deg - foveal) / (self.transitional_deg - foveal);
            1.0 - into * (1.0 - peripheral)
        }
    }

    /// The eccentricity from which on [`Self::rate_at`] is at most `fraction`, degrees: the radius of the ring in which
    /// a rate of that fraction is permitted. At 1 and above it is 0; infinite for less than the periphery has, and
    /// where `fraction` or a radius is NaN.
    pub fn reaches_deg(&self, fraction: f32) -> f32 {
        let (foveal, peripheral) = (self.foveal_deg.max(0.0), self.peripheral.fraction());
        if fraction >= 1.0 {
            return 0.0;
        }
        let known = !self.foveal_deg.is_nan() && !self.transitional_deg.is_nan();
        if !(fraction >= peripheral && known) {
            f32::INFINITY
        } else if self.transitional_deg <= foveal {
            // Not by the difference, which both may be too large for.
            foveal
        } else {
            foveal + (self.transitional_deg - foveal) * ((1.0 - fraction) / (1.0 - peripheral))
        }
    }

    /// The coarsest of the paper's rates ([`crate::rate::PAPER_RATES`]) that is at least as fine as [`Self::rate_at`].
    pub fn shading_rate(&self, eccentricity_deg: f32) -> ShadingRate {
        self.shading_rate_of(eccentricity_deg, &crate::rate::PAPER_RATES)
    }

    /// The coarsest of `rates` that is at least as fine as [`Self::rate_at`], 1x1 where none is.
    ///
    /// `rates` may have any order; of equal fractions (2x4 and 4x2) the first wins.
    #[inline]
    pub fn shading_rate_of(&self, eccentricity_deg: f32, rates: &[ShadingRate]) -> ShadingRate {
        let wanted = self.rate_at(eccentricity_deg);
        let finer = rates.iter().copied().filter(|rate| rate.fraction() >= wanted);
        finer.fold(
            ShadingRate::R1X1,
            |best, next| {
                if next.fraction() < best.fraction() { next } else { best }
            },
        )
    }
}

#[cfg(test)]
mod tests;
