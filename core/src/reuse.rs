//! Which parts of a picture are not rendered anew but re-used from earlier pictures, and where they lie there.
//!
//! [`StaleTiles`] says which tiles of a picture were not rendered. One is taken from an earlier picture in which what it shows
//! was rendered ([`Reuse`]), so that nothing is ever sampled from what was itself re-used. [`TileLists`] sorts tiles by where
//! they are taken from.

pub(crate) mod bits;
mod compared;
mod history;
mod lists;
mod places;
mod reach;
mod rects;
mod stale_tiles;

pub use compared::ComparedTiles;
pub(crate) use history::Parallax;
pub use history::{Footprint, MovedSource, Picture, Reuse, Source, Viewpoint};
pub use lists::TileLists;
pub use rects::{Edge, TileRect, TileRects};
pub use stale_tiles::StaleTiles;

/// Most earlier pictures that are looked into: a period of [`crate::schedule::MAX_FACTOR`] frames less the newest one.
pub const MAX_AGES: usize = 8;

/// The bit of a tile's byte in the map of an eye's rates that says that the tile is stale in this frame: not rendered, to be
/// re-used from an earlier one. The rest of the byte is [`crate::rate::ShadingRate::texel`], which is at most 0b1010.
///
/// Maps are combined by bitwise AND, so what is made of several tiles is stale only where all of them are.
pub const STALE: u8 = 0x80;

#[cfg(test)]
mod tests;
