//! Foveated rendering cost optimisation: the coarsest shading rate whose loss the budget covers (paper A, section 4.2,
//! "Audio-visual aware Foveated Rendering").
//!
//! A block of n pixels a side is taken to remove log2(n) octaves of spatial frequency, finest first. What is lost
//! is the sensitivity in the removed bands. Eq. 19 as printed compares it with the wrong sign, and then coarsens
//! where most would be seen; here the loss must not exceed alpha, which is what Eq. 18, from which it is derived, says.

mod visual_loss;

pub use visual_loss::{Block, perceived_quality, visual_loss};

use crate::perception::BANDS;
use crate::rate::ShadingRate;

/// Most that a rate removes, in half octaves: 4x4.
const MAX_HALF_OCTAVES: u8 = 4;

/// What a block loses at a rate: sum over i of `C_i` clamp(octaves - i, 0, 1), paper A Eq. 19 with the corrected sign.
///
/// `band_sensitivity` is C_n(f, b) of Eq. 7 by band, finest first: contrast times sensitivity, >= 0, without a unit but
/// with the scale of the sensitivity function. The answer is >= 0, 0 at 1x1, and does not fall towards coarser rates. A
/// negative band counts as its magnitude; one that is NaN or infinite makes every rate but 1x1 cost infinitely much.
pub fn loss(band_sensitivity: [f32; BANDS], rate: ShadingRate) -> f32 {
    let half_octaves = half_octaves(rate);
    if half_octaves == 0 { 0.0 } else { losses(band_sensitivity)[usize::from(half_octaves) - 1] }
}

/// How many half octaves of spatial frequency may go within the budget `alpha` (Eq. 17), 0..=4.
///
/// Compare with twice [`ShadingRate::octaves`]; [`coarsest`] does so. This is the part of it that is worth running
/// in a loop of its own: it has no branch. A loss equal to the budget is within it, so a block without any contrast
/// may lose all, even at `alpha` = 0. Negative, NaN and infinite `alpha` give 0.
pub fn half_octaves_within(band_sensitivity: [f32; BANDS], alpha: f32) -> u8 {
    // An infinite budget is a fault upstream, not a wish. The losses do not fall, so their number is the index.
    let budget = if alpha.is_finite() { alpha } else { f32::NAN };
    losses(band_sensitivity).into_iter().map(|loss| u8::from(loss <= budget)).sum()
}

/// The coarsest of `rates` whose [`loss`] is at most `alpha`: paper A's Algorithm 2 and Eq. 20 with the corrected sign.
///
/// `rates` may have any order; of several that remove as many octaves (2x4 and 4x2) the first wins. 1x1 is always
/// permitted, also when it is not listed, and is the answer where `alpha` is negative, NaN or infinite, where a
/// band is NaN or infinite, and for no rates.
pub fn coarsest(band_sensitivity: [f32; BANDS], alpha: f32, rates: &[ShadingRate]) -> ShadingRate {
    let within = half_octaves_within(band_sensitivity, alpha);
    rates
        .iter()
        .map(|&rate| (half_octaves(rate), rate))
        .filter(|&(half_octaves, _)| half_octaves <= within)
        .fold((0, ShadingRate::R1X1), |best, next| if next.0 > best.0 { next } else { best })
        .1
}

/// The loss of 1, 2, 3 and 4 half octaves: never falling, infinite where a band is no number.
fn losses(band_sensitivity: [f32; BANDS]) -> [f32; MAX_HALF_OCTAVES as usize] {
    let [first, second, ..] = band_sensitivity.map(f32::abs);
    // Finite x 0 is 0, anything else NaN. The bands that no rate removes count too: contrast that is no number in
    // one band is not to be trusted in the others.
    let doubt = band_sensitivity.iter().map(|band| band * 0.0).sum::<f32>();
    let losses = [0.5 * first, first, first + 0.5 * second, first + second];
    if doubt == 0.0 { losses } else { [f32::INFINITY; MAX_HALF_OCTAVES as usize] }
}

fn half_octaves(rate: ShadingRate) -> u8 {
    (rate.octaves() * 2.0) as u8
}

#[cfg(test)]
mod tests;
