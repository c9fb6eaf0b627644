//! Foveated rendering cost optimisation: the coarsest shading rate whose loss the budget covers (paper A, section 4.2,
//! "Audio-visual aware Foveated Rendering").
//!
//! A block of n pixels a side is taken to remove log2(n) octaves of spatial frequency, finest first. The loss is the
//! sensitivity in the removed bands. Eq. 19 as printed compares it with the wrong sign, and then coarsens where the
//! loss is most visible; here the loss must not exceed alpha, as in Eq. 18, from which Eq. 19 is derived.

mod visual_loss;

pub use visual_loss::{Block, perceived_quality, visual_loss};

use crate::perception::BANDS;
use crate::rate::ShadingRate;

/// Half octaves that the coarsest rate, 4x4, removes.
pub const HALF_OCTAVES: usize = 4;

/// Loss of a block at a rate: sum over i of `C_i` clamp(octaves - i, 0, 1), paper A Eq. 19 with the corrected sign.
///
/// `band_sensitivity` is C_n(f, b) of Eq. 7 by band, finest first: contrast times sensitivity, >= 0, without a unit but
/// with the scale of the sensitivity function. The answer is >= 0, 0 at 1x1, and does not fall towards coarser rates. A
/// negative band counts as its magnitude; one that is NaN or infinite makes every rate but 1x1 cost infinitely much.
#[inline]
pub fn loss(band_sensitivity: [f32; BANDS], rate: ShadingRate) -> f32 {
    let loss = match half_octaves(rate) {
        0 => return 0.0,
        half_octaves => losses(band_sensitivity)[half_octaves - 1],
    };
    if loss.is_nan() { f32::INFINITY } else { loss }
}

/// Number of half octaves of spatial frequency that can be removed within the budget `alpha` (Eq. 17), 0..=4.
///
/// [`by_half_octaves`] gives the rate of a set for each number. Without a branch, so that a loop over tiles runs on several at
/// a time. A loss equal to the budget is within it: a block without any contrast may lose all, even at `alpha` = 0.
/// Negative, NaN and infinite `alpha` give 0.
#[inline]
pub fn half_octaves_within(band_sensitivity: [f32; BANDS], alpha: f32) -> u8 {
    // An infinite budget is a fault upstream, not a wish.
    let budget = if alpha.is_finite() { alpha } else { -1.0 };
    // The losses do not fall, so the number of those within the budget is the index of the last one.
    let [half, one, three_halves, two] = losses(band_sensitivity).map(|loss| i32::from(loss <= budget));
    (half + one + three_halves + two) as u8
}

/// Number of half octaves to remove where a sample is worth `price` in loss, 0..=4, with the least cost of loss and samples together.
///
/// Tiles with one price lose least together of all maps that shade no more samples than theirs (Everett 1963): their marginal losses are equal.
/// No tile loses more than the price, as it saves no more than all of its samples. Of several that cost the same the coarsest counts. Bad
/// input as for [`half_octaves_within`].
#[inline]
pub fn half_octaves_at(band_sensitivity: [f32; BANDS], price: f32) -> u8 {
    // Samples that are left, as a part of those at 1x1.
    const LEFT: [f32; HALF_OCTAVES] = [0.5, 0.25, 0.125, 0.0625];
    let price = if price.is_finite() { price } else { -1.0 };
    let losses = losses(band_sensitivity);
    let (mut best, mut least) = (0, price);
    for (index, (loss, left)) in (1..).zip(losses.into_iter().zip(LEFT)) {
        let cost = loss + price * left;
        (best, least) = if cost <= least { (index, cost) } else { (best, least) };
    }
    best
}

/// Allocation of a budget to tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Allocation {
    /// Each tile may lose the budget: [`half_octaves_within`], paper A's Algorithm 2.
    PerTile,
    /// The budget is the worth of a sample: [`half_octaves_at`].
    #[default]
    EqualMarginalLoss,
}

impl Allocation {
    /// Number of half octaves to remove, 0..=4.
    #[inline]
    pub fn half_octaves(self, band_sensitivity: [f32; BANDS], budget: f32) -> u8 {
        match self {
            Self::PerTile => half_octaves_within(band_sensitivity, budget),
            Self::EqualMarginalLoss => half_octaves_at(band_sensitivity, budget),
        }
    }

    /// A tile becomes as coarse as it can where visible contrast of the two finest bands together is at most the budget over this.
    pub fn greatest_factor(self) -> f32 {
        match self {
            Self::PerTile => 1.0,
            // The last step loses half of the second band, and saves 1/16 of the samples.
            Self::EqualMarginalLoss => 8.0,
        }
    }
}

/// For 0..=4 half octaves, the coarsest of `rates` that removes no more; 1x1 where there is none.
///
/// `rates` may have any order; of several that remove as many octaves (2x4 and 4x2) the first wins. Index it with
/// [`half_octaves_within`]; a loop over tiles makes it once.
#[inline]
pub fn by_half_octaves(rates: &[ShadingRate]) -> [ShadingRate; HALF_OCTAVES + 1] {
    let mut coarsest = [ShadingRate::R1X1; HALF_OCTAVES + 1];
    for index in 1..=HALF_OCTAVES {
        let exact = rates.iter().find(|&&rate| half_octaves(rate) == index);
        coarsest[index] = exact.copied().unwrap_or(coarsest[index - 1]);
    }
    coarsest
}

/// The coarsest of `rates` whose [`loss`] is at most `alpha`: paper A's Algorithm 2 and Eq. 20 with the corrected sign.
///
/// `rates` are as in [`by_half_octaves`], which a loop over tiles should use. 1x1 is always permitted, also when it is
/// not listed, and is the answer where `alpha` is negative, NaN or infinite, where a band is NaN or infinite, and for no rates.
#[inline]
pub fn coarsest(band_sensitivity: [f32; BANDS], alpha: f32, rates: &[ShadingRate]) -> ShadingRate {
    by_half_octaves(rates)[usize::from(half_octaves_within(band_sensitivity, alpha))]
}

/// The loss of 1, 2, 3 and 4 half octaves: never falling, NaN where a band is not finite.
#[inline]
fn losses(band_sensitivity: [f32; BANDS]) -> [f32; HALF_OCTAVES] {
    let [a, b, c, d] = band_sensitivity.map(f32::abs);
    // Finite x 0 is 0, anything else NaN. The bands that no rate removes count too: contrast that is not a number in
    // one band is not to be trusted in the others.
    let doubt = a * 0.0 + b * 0.0 + c * 0.0 + d * 0.0;
    [0.5 * a + doubt, a + doubt, a + 0.5 * b + doubt, a + b + doubt]
}

/// Twice the octaves that a rate removes, 0..=[`HALF_OCTAVES`].
#[inline]
fn half_octaves(rate: ShadingRate) -> usize {
    (rate.octaves() * 2.0) as usize
}

#[cfg(test)]
mod tests;
