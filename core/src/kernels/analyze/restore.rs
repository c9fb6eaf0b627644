//! The last stage: what tiles that were shaded coarsely would show at 1x1.

use crate::image::Plane;
use crate::perception::extrapolate::{extrapolate, survivor};
use crate::perception::{ContrastMap, TileContrast};
use crate::rate::ShadingRate;
use crate::reuse::STALE;

/// By how much the finest octave that survives may have changed since the frame before for the tile to count as the same.
const SAME: f32 = 2.0;

/// Puts back what the tiles of `map` do not show because they were shaded at `rates` ([`ShadingRate::texel`], with [`STALE`] or without), where
/// `previous` is what was known a frame ago. All three are of the same tiles; what is missing in one counts as 1x1,
/// and as not known.
///
/// A map that judged coarse tiles by what they show would find nothing in them and keep them coarse for ever. One that
/// only guessed would refine where the guess is too high, measure, coarsen, and guess again: hence the memory.
pub fn restore(rates: &Plane<u8>, previous: &ContrastMap, map: &mut ContrastMap) {
    let rates = rates.texels().iter().copied().chain(std::iter::repeat(0));
    let previous = previous.tiles.texels().iter().copied().chain(std::iter::repeat(TileContrast::default()));
    for ((tile, rate), previous) in map.tiles.texels_mut().iter_mut().zip(rates).zip(previous) {
        *tile =
            restored(*tile, previous, ShadingRate::from_texel(rate & !STALE).unwrap_or(ShadingRate::R1X1));
    }
}

/// One tile.
///
/// Where the finest octave that survives is as it was, but for a factor of 2 at most, so is the shape of the spectrum: the
/// lost octaves are what they were, times what that octave has become. Otherwise they are guessed ([`extrapolate`]).
pub fn restored(measured: TileContrast, previous: TileContrast, shaded_at: ShadingRate) -> TileContrast {
    let survivor = survivor(shaded_at);
    let (now, before) = (measured.bands[survivor], previous.bands[survivor]);
    let is_same = now <= SAME * before && before <= SAME * now;
    if !is_same {
        return extrapolate(measured, shaded_at);
    }
    let change = if before > 0.0 { now / before } else { 1.0 };
    let lost_entirely = shaded_at.width().min(shaded_at.height()).ilog2() as usize;
    let mut bands = measured.bands;
    for (i, band) in bands[..survivor].iter_mut().enumerate() {
        let known = previous.bands[i] * change;
        *band = if i < lost_entirely { known } else { band.max(known) };
    }
    TileContrast { bands, ..measured }
}
