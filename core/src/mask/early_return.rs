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

    /// Whether all fragments of a quad of 2x2 pixels return, or none does, in pictures of `extent` pixels: the derivatives of the others are undefined
    /// otherwise. A quad at an odd edge has fragments beyond the picture, which blocks cover and the texels of a depth format do not.
    pub fn agree_in_quads(extent: [u32; 2], format: DepthFormat) -> bool {
        format == DepthFormat::Blocks || extent.iter().all(|side| side.is_multiple_of(2))
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

    /// With the fragments beyond an odd edge.
    #[test]
    fn fragments_of_a_quad_agree() {
        let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
        let formats = [
            (DepthFormat::Blocks, RETURNS),
            (DepthFormat::Unorm16, depths),
            (DepthFormat::Unorm24, depths),
            (DepthFormat::Float32, depths),
        ];
        let extents = [[62, 42], [61, 42], [62, 43], [37, 31]];
        let mut refused = Vec::new();
        for (format, depths, extent) in
            formats.into_iter().flat_map(|(format, depths)| extents.map(|extent| (format, depths, extent)))
        {
            let Some(params) = EarlyReturnParams::new(extent, format, depths) else { continue };
            if !EarlyReturnParams::agree_in_quads(extent, format) {
                refused.push((format, extent));
                continue;
            }
            let rates = [ShadingRate::R2X2.texel(); 64];
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 8, rates: &rates };
            let mut mask = Mask::new(extent, 1);
            mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent, tiles }]);
            let mut words = vec![0u32; format.words(extent).unwrap().layer as usize];
            write_template(&mask, 0, format, depths, bytemuck::cast_slice_mut(&mut words));
            for [x, y] in (0..extent[1]).flat_map(|y| (0..extent[0]).map(move |x| [x, y])) {
                let own = params.returns(&words, 0, [x, y]);
                let others = [[x ^ 1, y], [x, y ^ 1], [x ^ 1, y ^ 1]];
                assert!(
                    others.iter().all(|pixel| params.returns(&words, 0, *pixel) == own),
                    "{format:?} {extent:?}"
                );
            }
        }
        assert_eq!(refused.len(), 3 + 3 + 1, "{refused:?}");
    }

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
