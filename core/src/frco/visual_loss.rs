//! Visual loss of a foveated image compared to the image at full rate (paper A, Eq. 8-11).

use super::loss;
use crate::perception::BANDS;
use crate::rate::ShadingRate;

/// A block of a picture, as one shading rate covers it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// C_n(f, b) of Eq. 7 by band, finest first: contrast times sensitivity, >= 0.
    pub band_sensitivity: [f32; BANDS],
    /// Rate that the block is shaded at.
    pub rate: ShadingRate,
    /// Pixels of the block that lie in the picture: its weight in Eq. 10.
    pub pixels: u32,
}

/// `C_v` of a foveated picture, Eq. 8-10: the sensitivity that its rates keep, summed over bands and averaged over all
/// pixels. >= 0, in the scale of the sensitivity function.
///
/// With every rate 1x1 this is `C_v(gt)`. Blocks with a band that is NaN or infinite are left out, with their weight; no
/// blocks give 0.
pub fn perceived_quality(blocks: impl IntoIterator<Item = Block>) -> f32 {
    average(blocks, |block| full(block) - f64::from(loss(block.band_sensitivity, block.rate)))
}

/// gamma_vis of Eq. 11: [`perceived_quality`] at full rate minus that at the blocks' rates, computed as the mean loss
/// of the blocks, which keeps its digits where the two are close. >= 0; bad blocks as there.
pub fn visual_loss(blocks: impl IntoIterator<Item = Block>) -> f32 {
    average(blocks, |block| f64::from(loss(block.band_sensitivity, block.rate)))
}

/// Eq. 8 for a block at full rate.
fn full(block: &Block) -> f64 {
    block.band_sensitivity.iter().map(|&band| f64::from(band.abs())).sum()
}

/// Mean over pixels, in double precision: a picture has millions of them.
fn average(blocks: impl IntoIterator<Item = Block>, value: impl Fn(&Block) -> f64) -> f32 {
    let (mut sum, mut pixels) = (0.0, 0.0);
    for block in blocks {
        if block.band_sensitivity.iter().all(|band| band.is_finite()) {
            let weight = f64::from(block.pixels);
            sum += weight * value(&block);
            pixels += weight;
        }
    }
    // Values beyond f32 are clamped.
    if pixels > 0.0 { (sum / pixels).min(f64::from(f32::MAX)) as f32 } else { 0.0 }
}
