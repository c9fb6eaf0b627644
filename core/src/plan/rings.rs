//! Rings around the gaze: from which eccentricity on a rate is permitted.

use super::lattice::chord_of_deg;
use crate::fixed_foveation::FixedFoveation;
use crate::rate::{PAPER_RATES, ShadingRate};

/// Coarser rates than 1x1 that a plan can hold: one for each half octave.
pub const COARSER_RATES: usize = 4;

/// Steps of coarseness in an octave: a tile's coarseness is kept in 64ths of [`ShadingRate::octaves`], 0..=128.
pub const STEPS_PER_OCTAVE: u8 = 64;

/// A squared chord that no angle has: the greatest one is 4. Finite, as a uniform's value should be.
const NEVER: f32 = 8.0;

/// Coarseness that no tile reaches.
const NO_LEVEL: u8 = u8::MAX;

/// The rates of a device, 1x1 first and at most one for each half octave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AvailableRates {
    coarser: [ShadingRate; COARSER_RATES],
    count: usize,
}

impl AvailableRates {
    /// From the rates of a device, in any order. 1x1 is always there; of several rates that remove as many octaves (2x4 and 4x2) the first
    /// one counts.
    pub fn new(offered: &[ShadingRate]) -> Self {
        Self::among(offered, offered)
    }

    /// As [`Self::new`], of the rates in `wanted` that are also `offered`.
    pub fn among(wanted: &[ShadingRate], offered: &[ShadingRate]) -> Self {
        let mut available = Self { coarser: [ShadingRate::R1X1; COARSER_RATES], count: 0 };
        for half_octaves in 1..=COARSER_RATES {
            let fits =
                |rate: &&ShadingRate| rate.octaves() == half_octaves as f32 * 0.5 && offered.contains(rate);
            if let Some(rate) = wanted.iter().find(fits) {
                available.coarser[available.count] = *rate;
                available.count += 1;
            }
        }
        available
    }

    /// The rates below 1x1, finest first: at most [`COARSER_RATES`].
    pub fn coarser(&self) -> &[ShadingRate] {
        &self.coarser[..self.count]
    }

    /// Coarseness of each of [`Self::coarser`] in [`STEPS_PER_OCTAVE`], unreachable beyond the last.
    pub(super) fn levels(&self) -> [u8; COARSER_RATES] {
        let mut levels = [NO_LEVEL; COARSER_RATES];
        for (level, rate) in levels.iter_mut().zip(self.coarser()) {
            *level = level_of(*rate);
        }
        levels
    }

    /// [`ShadingRate::texel`] of each of [`Self::coarser`]; 1x1 beyond the last.
    pub(super) fn texels(&self) -> [u8; COARSER_RATES] {
        self.coarser.map(ShadingRate::texel)
    }
}

/// Coarseness of a rate in [`STEPS_PER_OCTAVE`].
pub(super) fn level_of(rate: ShadingRate) -> u8 {
    (rate.octaves() * f32::from(STEPS_PER_OCTAVE)) as u8
}

impl Default for AvailableRates {
    /// Rates of paper A's device.
    fn default() -> Self {
        Self::new(&PAPER_RATES)
    }
}

impl Default for Rings {
    fn default() -> Self {
        Self::FULL
    }
}

/// For each rate of [`AvailableRates::coarser`], the eccentricity from which on it is permitted, degrees; infinite
/// where it never is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rings {
    from_deg: [f32; COARSER_RATES],
}

impl Rings {
    /// Full rate everywhere.
    pub const FULL: Self = Self { from_deg: [f32::INFINITY; COARSER_RATES] };
    /// Every rate anywhere.
    pub const OPEN: Self = Self { from_deg: [0.0; COARSER_RATES] };

    /// The rings of fixed foveation: a rate is permitted from [`FixedFoveation::reaches_deg`] on. Rates below the
    /// peripheral one are permitted nowhere.
    pub fn new(map: &FixedFoveation, available: &AvailableRates) -> Self {
        let mut rings = Self::FULL;
        for (from, rate) in rings.from_deg.iter_mut().zip(available.coarser()) {
            *from = map.reaches_deg(rate.fraction());
        }
        rings
    }

    /// These rings with every radius at least `least_deg`, and wider by `margin_deg`.
    pub fn widened(self, least_deg: f32, margin_deg: f32) -> Self {
        Self { from_deg: self.from_deg.map(|from| from.max(least_deg) + margin_deg) }
    }

    /// Eccentricity at which each rate begins, degrees, in the order of [`AvailableRates::coarser`].
    pub fn from_deg(&self) -> [f32; COARSER_RATES] {
        self.from_deg
    }

    /// The coarsest rate that is permitted at an eccentricity in degrees; 1x1 where that is NaN.
    pub fn rate_at(&self, available: &AvailableRates, eccentricity_deg: f32) -> ShadingRate {
        let permitted = available.coarser().iter().zip(self.from_deg);
        let last = permitted.rev().find(|(_, from_deg)| eccentricity_deg >= *from_deg);
        last.map_or(ShadingRate::R1X1, |(rate, _)| *rate)
    }

    /// The radii as squared chords; 180 degrees or more is never reached.
    pub(super) fn chords(&self) -> [f32; COARSER_RATES] {
        self.from_deg.map(chord_or_never)
    }
}

/// Squared chord of a radius; never reached from 180 degrees on, or where the radius is not a number.
pub(super) fn chord_or_never(radius_deg: f32) -> f32 {
    if radius_deg < 180.0 { chord_of_deg(radius_deg) } else { NEVER }
}
