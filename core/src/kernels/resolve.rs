//! Reference of the kernel `resolve`: from the rates of the tiles of both eyes to the texels of one rate image.
//!
//! Each texel gets the finest of all tiles that it meets. Which those are depends on where a pass draws, not on the rates: that
//! is a [`RateMapTable`], made once for a pass. Rates are combined in unary, where the finer of two is a bitwise AND: log2 of a side of
//! 0, 1, 2 is 0b00, 0b01, 0b11. So is the bit [`STALE`], which a texel has where all that it meets are stale.

use crate::image::Plane;
use crate::layout::uniform;
use crate::rate::ShadingRate;
use crate::reuse::STALE;
use std::ops::Range;

/// Unary of 4x4, stale: no limit.
const COARSEST: u8 = STALE | 0b1111;

uniform! {
    /// Parameters of one rate image, the shader's uniform of the same name.
    pub struct ResolveParams {
        /// Columns and rows of texels.
        pub texels: [u32; 2],
        /// Array layers.
        pub layers: u32,
        /// Pictures in the table.
        pub pictures: u32,
        /// Words from one row of tiles to the next, of the left and of the right eye.
        pub row_words: [u32; 2],
        /// 1 where stale tiles are left out; 0: they are shaded as coarsely as can be.
        pub leaves_out: u32,
        /// Reserved, up to a multiple of 16 bytes; 0.
        pub reserved: u32,
        /// The device's rate for each unary rate, a texel a byte ([`ShadingRate::texel`]).
        pub available: [u32; 4],
    }
}

/// Tiles that each texel of a rate image meets: the content of a storage buffer.
///
/// For each picture a word with its layer, times two, plus its eye (0: left, 1: right); then for each column of texels the
/// columns of tiles that it meets, the first one in the lower half of a word and the end in the upper half; then the same for rows.
/// After the pictures a bit for each texel of all layers, row by row, 32 in a word from the lowest bit on: whether all of it is covered by pictures.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RateMapTable {
    words: Vec<u32>,
    pictures: u32,
    texels: [u32; 2],
    layers: u32,
}

impl RateMapTable {
    /// For an image of so many columns and rows of texels, and layers; nothing is covered yet, and all texels are 1x1.
    pub fn new(texels: [u32; 2], layers: u32) -> Self {
        Self { words: Vec::new(), pictures: 0, texels, layers }
    }

    /// Adds an eye buffer in a layer: the columns and rows of its tiles that each column and row of texels meets, below 65536.
    /// Missing columns and rows of texels meet none.
    pub fn add(
        &mut self,
        layer: u32,
        eye: u32,
        columns: impl Iterator<Item = Range<u32>>,
        rows: impl Iterator<Item = Range<u32>>,
    ) {
        let nothing = || std::iter::repeat(0..0);
        let word = |met: Range<u32>| met.start & 0xffff | met.end << 16;
        self.words.push(layer << 1 | eye & 1);
        self.words.extend(columns.chain(nothing()).take(self.texels[0] as usize).map(word));
        self.words.extend(rows.chain(nothing()).take(self.texels[1] as usize).map(word));
        self.pictures += 1;
    }

    /// Adds for each texel, row by row, layer by layer, whether it is covered entirely. Call it after all pictures.
    pub fn cover(&mut self, covered: &[bool]) {
        let word = |bits: &[bool]| bits.iter().rev().fold(0, |word, bit| word << 1 | u32::from(*bit));
        self.words.extend(covered.chunks(u32::BITS as usize).map(word));
    }

    /// All words.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// The parameters for this table: eyes with so many columns of tiles, and the device's rate for each unary rate.
    pub fn params(&self, tile_columns: [u32; 2], available: [u8; 16], leaves_out: bool) -> ResolveParams {
        ResolveParams {
            texels: self.texels,
            layers: self.layers,
            pictures: self.pictures,
            row_words: tile_columns.map(|columns| columns.div_ceil(4)),
            leaves_out: leaves_out.into(),
            reserved: 0,
            available: std::array::from_fn(|word| {
                u32::from_le_bytes([0, 1, 2, 3].map(|byte| available[4 * word + byte]))
            }),
        }
    }
}

/// Unary of a rate, with [`STALE`]; 1x1 for texels without a rate.
fn unary(texel: u8) -> u8 {
    let rate = ShadingRate::from_texel(texel & !STALE).unwrap_or(ShadingRate::R1X1);
    let side = |pixels: u32| (pixels - 1) as u8;
    side(rate.width()) << 2 | side(rate.height()) | texel & STALE
}

/// The texels of a rate image, row by row, layer by layer, by the rates of both eyes' tiles ([`ShadingRate::texel`], with
/// [`STALE`] or without).
pub fn resolve(params: &ResolveParams, table: &RateMapTable, eyes: [&Plane<u8>; 2]) -> Vec<u8> {
    let [columns, rows] = params.texels.map(|count| count as usize);
    let picture_words = 1 + columns + rows;
    let (pictures, covered) = table.words.split_at(params.pictures as usize * picture_words);
    let met = |word: u32| word & 0xffff..word >> 16;
    let texel = |index: usize| {
        let (layer, row, column) = (index / columns / rows, index / columns % rows, index % columns);
        if covered[index / 32] >> (index % 32) & 1 == 0 {
            return 0;
        }
        let mut finest = COARSEST;
        for picture in pictures.chunks_exact(picture_words) {
            if (picture[0] >> 1) as usize != layer {
                continue;
            }
            let rates = eyes[(picture[0] & 1) as usize];
            for y in met(picture[1 + columns + row]) {
                for x in met(picture[1 + column]) {
                    finest &= unary(rates.at(x, y));
                }
            }
        }
        let offered =
            |unary: u8| params.available[usize::from(unary / 4)].to_le_bytes()[usize::from(unary % 4)];
        match (finest & STALE != 0, params.leaves_out != 0) {
            (true, false) => offered(0b1111),
            _ => offered(finest & 0b1111) | finest & STALE,
        }
    };
    (0..columns * rows * params.layers as usize).map(texel).collect()
}
