//! Reference of the test that is put in front of fragment shaders: whether a fragment lies in a skipped block, by the words
//! of a template.

use super::{DepthFormat, TemplateDepths};

/// The values of a template for shaders alone ([`DepthFormat::Blocks`]).
pub const RETURNS: TemplateDepths = TemplateDepths { shaded: 0.0, skipped: 1.0 };

/// The place of a pixel's word in a template, and the word of shaded blocks: words of a storage buffer, in this order.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct EarlyReturnParams {
    /// Words of a row of the template.
    pub row_words: u32,
    /// Words of an array layer.
    pub layer_words: u32,
    /// Number of bits by which a column of pixels is shifted to give the column of its word.
    pub column_shift: u32,
    /// The same of rows.
    pub row_shift: u32,
    /// A word of shaded blocks.
    pub shaded: u32,
}

impl EarlyReturnParams {
    /// Parameters of a template for pictures of `extent` pixels. Nothing where words hold pixels of two blocks, or of two
    /// rows.
    pub fn new(extent: [u32; 2], format: DepthFormat, depths: TemplateDepths) -> Option<Self> {
        let words = format.words(extent)?;
        // All pixels of a block have one value, so that two in a word are compared as one.
        let (column_shift, row_shift) = match words.block {
            1 => (2, 2),
            2 => (1, 0),
            _ => (0, 0),
        };
        Some(Self {
            row_words: words.row,
            layer_words: words.layer,
            column_shift,
            row_shift,
            shaded: format.word(depths.shaded),
        })
    }

    /// Whether the fragment of a pixel in a layer returns early, by the shader's operations in their order.
    pub fn returns(&self, words: &[u32], layer: u32, [x, y]: [u32; 2]) -> bool {
        let row = (y >> self.row_shift) * self.row_words;
        let index = layer * self.layer_words + (row + (x >> self.column_shift));
        words[index as usize] != self.shaded
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mask::{Mask, MaskView, TileRates, write_template};
    use crate::rate::ShadingRate;

    #[test]
    fn fragments_of_skipped_blocks_return() {
        let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
        for (format, depths, extent) in [
            (DepthFormat::Blocks, RETURNS, [61, 42]),
            (DepthFormat::Blocks, RETURNS, [64, 64]),
            (DepthFormat::Unorm16, depths, [62, 42]),
            (DepthFormat::Unorm24, depths, [61, 43]),
            (DepthFormat::Float32, depths, [37, 31]),
        ] {
            let rates = [ShadingRate::R2X2.texel(); 64];
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 8, rates: &rates };
            let mut mask = Mask::new(extent, 2);
            mask.resolve(&[MaskView { layer: 1, offset: [0; 2], extent, tiles }]);
            assert!(mask.shaded() < 0.8);
            let layer_words = format.words(extent).unwrap().layer as usize;
            let mut words = vec![0u32; 2 * layer_words];
            for (layer, out) in (0..).zip(words.chunks_exact_mut(layer_words)) {
                write_template(&mask, layer, format, depths, bytemuck::cast_slice_mut(out));
            }
            let params = EarlyReturnParams::new(extent, format, depths).unwrap();
            for index in 0..2 * extent[0] * extent[1] {
                let (layer, index) = (index / (extent[0] * extent[1]), index % (extent[0] * extent[1]));
                let pixel = [index % extent[0], index / extent[0]];
                let skips = mask.skips(layer, pixel);
                assert_eq!(params.returns(&words, layer, pixel), skips, "{format:?} {pixel:?}");
            }
        }
        assert_eq!(EarlyReturnParams::new([61, 42], DepthFormat::Unorm16, depths), None);
    }
}
