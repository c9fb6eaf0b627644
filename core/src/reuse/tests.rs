use super::{STALE, StaleTiles};

mod compared;
mod history;
mod places;
mod stale_tiles;

/// A picture of that size in tiles of `texel` pixels, of which some are stale.
fn set(extent: [u32; 2], texel: [u32; 2], is_stale: impl Fn(u32, u32) -> bool) -> StaleTiles {
    let [columns, rows] = [extent[0].div_ceil(texel[0]), extent[1].div_ceil(texel[1])];
    let tiles = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let map: Vec<u8> =
        tiles.map(|(column, row)| if is_stale(column, row) { STALE | 0b1010 } else { 0b1010 }).collect();
    let mut stale = StaleTiles::default();
    stale.set(extent, texel, &map);
    stale
}
