//! The kernel `mask`: from the rates of tiles to the blocks that a pass skips, where rates are decided on the GPU.
//!
//! Its reference is [`Mask`](crate::mask::Mask) with [`write_template`](crate::mask::write_template); the order of the list is left
//! open, and a block whose only sources would be such as have none themselves is shaded where the reference may fill it.

use crate::layout::uniform;
use crate::mask::{BLOCK, DepthFormat, MaskView, REACH, TemplateDepths};

uniform! {
    /// Parameters of one target, the shader's uniform of the same name.
    pub struct MaskParams {
        /// Size of the picture, pixels.
        pub extent: [u32; 2],
        /// Columns and rows of blocks that lie wholly in it.
        pub blocks: [u32; 2],
        /// Blocks along a side of a tile.
        pub tile: [u32; 2],
        /// Columns of tiles.
        pub tile_columns: u32,
        /// Tiles of an array layer of rates.
        pub layer_tiles: u32,
        /// Array layers.
        pub layers: u32,
        /// Number of views.
        pub views: u32,
        /// Words of the template in one array layer.
        pub layer_words: u32,
        /// Words of the template for four pixels of a row: 1, 2 or 4.
        pub block_words: u32,
        /// Word of the template in shaded blocks.
        pub shaded: u32,
        /// Word of the template in skipped blocks.
        pub skipped: u32,
        /// Words of a row of blocks, a bit each, with [`REACH`] more on both sides.
        pub bit_row_words: u32,
        /// Rows of such bits in one array layer, with [`REACH`] more on both sides.
        pub bit_rows: u32,
        /// Words of a row of the template.
        pub row_words: u32,
        /// Rows of the template in one block: 1 or 4.
        pub block_rows: u32,
    }
}

/// Words of a view in the shader's table: layer, layer of its rates, first block, end of the blocks.
pub const VIEW_WORDS: usize = 6;

impl MaskParams {
    /// Parameters for pictures of `extent` pixels and `layers` array layers, whose depth is laid out as `format`, with `views` views
    /// on them, by tiles of `texel` pixels, `tiles` columns and rows. Nothing where the kernel cannot serve those: tiles are not whole
    /// blocks, or pixels of a row do not begin with a word.
    pub fn new(
        extent: [u32; 2],
        layers: u32,
        (format, depths): (DepthFormat, TemplateDepths),
        (texel, tiles): ([u32; 2], [u32; 2]),
        views: u32,
    ) -> Option<Self> {
        let are_whole = texel.iter().all(|side| *side > 0 && side.is_multiple_of(BLOCK));
        let words = format.words(extent)?;
        if !are_whole {
            return None;
        }
        Some(Self {
            extent,
            blocks: extent.map(|side| side / BLOCK),
            tile: texel.map(|side| side / BLOCK),
            tile_columns: tiles[0],
            layer_tiles: tiles[0].checked_mul(tiles[1])?,
            layers,
            views,
            layer_words: words.layer,
            block_words: words.block,
            shaded: format.word(depths.shaded),
            skipped: format.word(depths.skipped),
            // Bits are read two words at a time.
            bit_row_words: (extent[0] / BLOCK + 2 * REACH).div_ceil(32) + 1,
            bit_rows: extent[1] / BLOCK + 2 * REACH,
            row_words: words.row,
            block_rows: words.block_rows,
        })
    }

    /// Words of the bits of all layers.
    pub fn bit_words(&self) -> u32 {
        self.bit_row_words * self.bit_rows * self.layers
    }
}

/// The words of a view, whose rates are in layer `rate_layer`, on a picture of `extent` pixels.
pub fn view_words(view: &MaskView, rate_layer: u32, extent: [u32; 2]) -> [u32; VIEW_WORDS] {
    let (first, end) = view.blocks(extent);
    [view.layer, rate_layer, first.x, first.y, end.x, end.y]
}
