//! Contrast that a coarsely shaded tile no longer shows.

use super::{BANDS, TileContrast};
use crate::rate::ShadingRate;

/// Responses of the bands to a picture with the same contrast in each octave, finest first: root of the integral of their squared
/// response over a spectrum of 1/f amplitude. The finest band is a high-pass, which reaches into the corners of the spectrum.
const EQUAL_OCTAVES: [f32; BANDS] = [1.70, 1.10, 1.02, 1.0];

/// Contrast of the tile at the rate 1x1, given the contrast `measured` while it was shaded at `shaded_at`.
///
/// Octaves finer than the block carry no signal, only the edges between blocks. They get the contrast expected from the
/// finest octave that survives in both directions: the amplitude of natural pictures falls as 1/f (Field 1987), so that
/// each octave has the same contrast, to which the bands answer as [`EQUAL_OCTAVES`]. An octave that is lost in one
/// direction only keeps its measured contrast if that is higher. Blocks are at most 4x4: two octaves always survive.
///
/// Detail that exists in lost octaves only (a fine regular pattern) cannot be known: shade at 1x1 now and then.
pub fn extrapolate(measured: TileContrast, shaded_at: ShadingRate) -> TileContrast {
    let survivor = survivor(shaded_at);
    let lost_entirely = shaded_at.width().min(shaded_at.height()).ilog2() as usize;
    let octave = measured.bands[survivor] / EQUAL_OCTAVES[survivor];
    let mut bands = measured.bands;
    for (i, band) in bands[..survivor].iter_mut().enumerate() {
        let expected = octave * EQUAL_OCTAVES[i];
        *band = if i < lost_entirely { expected } else { band.max(expected) };
    }
    TileContrast { bands, ..measured }
}

/// The finest octave that a rate leaves in both directions, as an index of the bands: 0..=2.
pub fn survivor(shaded_at: ShadingRate) -> usize {
    shaded_at.width().max(shaded_at.height()).ilog2() as usize
}

#[cfg(test)]
mod tests;
