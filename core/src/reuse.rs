//! Parts of an image that are re-used from earlier images instead of rendered, and their positions there.
//!
//! [`StaleTiles`] are the tiles of an image that were not rendered. Each is taken from an earlier image in which its content was
//! rendered ([`Reuse`]), so that re-used pixels are never sampled again. [`TileLists`] sorts tiles by their source.

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

/// The bit of a tile's byte in the map of an eye's rates that marks the tile as stale in this frame: not rendered, but
/// re-used from an earlier one. The rest of the byte is [`crate::rate::ShadingRate::texel`], which is at most 0b1010.
///
/// Maps are combined by bitwise AND, so a combination of several tiles is stale only if all of them are.
pub const STALE: u8 = 0x80;

#[cfg(test)]
mod tests;
