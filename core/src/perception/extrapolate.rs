//! Contrast that a coarsely shaded tile no longer shows.

use super::{BANDS, TileContrast};
use crate::rate::ShadingRate;

/// What the tile would show at the rate 1x1, given what was `measured` while it was shaded at `shaded_at`.
///
/// Octaves finer than the block carry no signal, only the edges between blocks: they get the contrast of the finest
/// octave that survives in both directions, since the amplitude of natural pictures falls with frequency (1/f) and
/// then each octave has equal contrast (Field 1987). An octave that is lost in one direction only keeps what was
/// measured if that is more. Blocks are at most 4x4, so two of the four octaves always survive.
///
/// Detail that exists in lost octaves only (a fine regular pattern) cannot be known: look at 1x1 now and then.
pub fn extrapolate(measured: TileContrast, shaded_at: ShadingRate) -> TileContrast {
    let (width, height) = (shaded_at.width().ilog2() as usize, shaded_at.height().ilog2() as usize);
    let survivor = width.max(height).min(BANDS - 1);
    let lost_entirely = width.min(height);
    let contrast = measured.bands[survivor];
    let mut bands = measured.bands;
    for (i, band) in bands[..survivor].iter_mut().enumerate() {
        *band = if i < lost_entirely { contrast } else { band.max(contrast) };
    }
    TileContrast { bands, ..measured }
}

#[cfg(test)]
mod tests;
