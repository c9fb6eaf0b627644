//! The last stage: the contrast that coarsely shaded tiles would have at 1x1.

use crate::image::Plane;
use crate::perception::extrapolate::{extrapolate, survivor};
use crate::perception::{ContrastMap, TileContrast};
use crate::rate::ShadingRate;
use crate::reuse::STALE;

/// Greatest factor by which the finest surviving octave of an unchanged tile changes from frame to frame.
const SAME: f32 = 2.0;

/// The same where the rate has changed: blocks fold finer detail into coarser bands.
const SAME_ACROSS_RATES: f32 = 4.0;

/// A smaller change at the same rate counts as noise.
const STEADY: f32 = 1.25;

/// The part of any other change at the same rate that a frame takes over: blocks of 4x4 leave 16 samples of a tile, the greatest contrast
/// of which noise changes by half from frame to frame.
const FOLLOW: f32 = 0.1;

/// The part of the estimates that lost octaves take over in such a frame: a head that turns by 20 degrees a second moves a picture by a tile of
/// 16 pixels, at 10 a degree, in seven frames.
const FORGET: f32 = 0.25;

/// Contrast that is added before two are compared, so that noise on a plain wall is not a change.
const FLOOR: f32 = 0.01;

/// Analyses of one image at the same rates after which the restored contrast no longer changes: a contrast that doubled is followed to
/// within [`STEADY`] in ten, and stays from there on.
pub const SETTLED: u32 = 16;

/// Contrast of a tile.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Shown {
    /// Contrast in the finest octave that survived, as far as the memory follows it.
    pub contrast: f32,
    /// [`ShadingRate::texel`] that it was shaded at.
    pub rate: u32,
}

/// Restores contrast that `map` lacks because tiles were shaded at `rates` ([`ShadingRate::texel`]; tiles with [`STALE`] were not shaded,
/// and keep their known contrast), from `previous`, the known contrast of the last frame, and `shown`, the contrast measured then. All four
/// are of the same tiles; a tile missing in one counts as 1x1 and unknown. `shown` takes the size of `map`.
///
/// A map that judged coarse tiles by their measured contrast would find nothing in them and keep them coarse for ever.
/// One that only guessed would refine where the guess is too high, measure, coarsen, and guess again: hence the memory.
pub fn restore(rates: &Plane<u8>, previous: &ContrastMap, shown: &mut Plane<Shown>, map: &mut ContrastMap) {
    let size = [map.tiles.width(), map.tiles.height()];
    if [shown.width(), shown.height()] != size {
        *shown = Plane::filled(size[0], size[1], Shown::default());
    }
    let rates = rates.texels().iter().copied().chain(std::iter::repeat(0));
    let previous = previous.tiles.texels().iter().copied().chain(std::iter::repeat(TileContrast::default()));
    let tiles = map.tiles.texels_mut().iter_mut().zip(shown.texels_mut());
    for (((tile, shown), rate), previous) in tiles.zip(rates).zip(previous) {
        if rate & STALE != 0 {
            *tile = previous;
            continue;
        }
        let shaded_at = ShadingRate::from_texel(rate & !STALE).unwrap_or(ShadingRate::R1X1);
        (*tile, *shown) = restored(*tile, previous, *shown, shaded_at);
    }
}

/// One tile with its contrast restored.
///
/// As long as the finest surviving octave changes little, so does the picture: the lost octaves stay as they were. Changes of that octave at
/// the same rate beyond noise scale them, and count as another picture at this place, as while the head turns: frame by frame the lost octaves
/// approach their estimates ([`extrapolate`]). After a large change they are estimates at once. So is the finest
/// surviving octave: detail that blocks fold into it would refine the tile, and be gone at the finer rate.
pub fn restored(
    measured: TileContrast,
    previous: TileContrast,
    shown: Shown,
    shaded_at: ShadingRate,
) -> (TileContrast, Shown) {
    let survivor = survivor(shaded_at);
    let contrast = measured.bands[survivor];
    let now = Shown { contrast, rate: shaded_at.texel().into() };
    let at_same_rate = shown.rate == now.rate;
    let before = if at_same_rate { shown.contrast } else { previous.bands[survivor] };
    let change = (contrast + FLOOR) / (before + FLOOR);
    let most = if at_same_rate { SAME } else { SAME_ACROSS_RATES };
    if !(change <= most && change * most >= 1.0) {
        return (extrapolate(measured, shaded_at), now);
    }
    if !at_same_rate {
        return (with_known(measured, previous, survivor, 1.0), now);
    }
    let is_noise = change <= STEADY && change * STEADY >= 1.0;
    let scale = if is_noise { 1.0 } else { 1.0 + (change - 1.0) * FOLLOW };
    let contrast = if is_noise { before } else { ((before + FLOOR) * scale - FLOOR).max(0.0) };
    let mut known = with_known(measured, previous, survivor, scale);
    if !is_noise {
        let estimated = extrapolate(measured, shaded_at);
        for (band, estimate) in known.bands[..survivor].iter_mut().zip(estimated.bands) {
            *band += (estimate - *band) * FORGET;
        }
    }
    (known, Shown { contrast, ..now })
}

/// The tile, if it is coarse, with its bands up to `survivor` as they were known, times `scale`.
fn with_known(measured: TileContrast, previous: TileContrast, survivor: usize, scale: f32) -> TileContrast {
    let mut bands = measured.bands;
    let count = if survivor > 0 { survivor + 1 } else { 0 };
    for (band, known) in bands[..count].iter_mut().zip(previous.bands) {
        *band = known * scale;
    }
    TileContrast { bands, ..measured }
}
