//! Reference of the kernel `template`: the pixels of a depth template that are drawn to an image of several samples, to which
//! buffers cannot be copied.
//!
//! The image is cleared to the depth of shaded blocks, and the pixels of skipped blocks are drawn over it at the nearest depth,
//! in all samples.

use crate::layout::uniform;
use crate::mask::{DepthFormat, TemplateDepths};

uniform! {
    /// Parameters of one template, the shader's struct of the same name.
    pub struct TemplateParams {
        /// Texels of a row.
        pub width: u32,
        /// Words of an array layer.
        pub layer_words: u32,
        /// Texels in a word: 1 or 2.
        pub texels_in_word: u32,
        /// A texel of a shaded block, in the lowest bits.
        pub shaded: u32,
    }
}

impl TemplateParams {
    /// Parameters of a template of `width` pixels a row and `layer_words` words an array layer.
    pub fn new(width: u32, layer_words: u32, format: DepthFormat, depths: TemplateDepths) -> Self {
        let texels_in_word = 4 / format.texel_size() as u32;
        let shaded = format.word(depths.shaded) & texel_mask(texels_in_word);
        Self { width, layer_words, texels_in_word, shaded }
    }

    /// Whether a pixel is drawn, of a template whose words are `words`: its texel is not that of shaded blocks.
    pub fn is_drawn(&self, words: &[u32], layer: u32, [x, y]: [u32; 2]) -> bool {
        let texel = y * self.width + x;
        let word = words[(layer * self.layer_words + texel / self.texels_in_word) as usize];
        let bits = 32 / self.texels_in_word;
        word >> (bits * (texel % self.texels_in_word)) & texel_mask(self.texels_in_word) != self.shaded
    }
}

/// The bits of a texel in a word.
fn texel_mask(texels_in_word: u32) -> u32 {
    if texels_in_word == 2 { 0xffff } else { u32::MAX }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mask::{Mask, MaskView, TileRates, write_template};
    use crate::rate::ShadingRate;

    #[test]
    fn pixels_of_skipped_blocks_are_drawn() {
        let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
        for (format, extent) in [
            (DepthFormat::Unorm16, [61, 42]),
            (DepthFormat::Unorm24, [64, 64]),
            (DepthFormat::Float32, [37, 3]),
        ] {
            let rates = [ShadingRate::R2X2.texel(); 64];
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 8, rates: &rates };
            let mut mask = Mask::new(extent, 2);
            mask.resolve(&[MaskView { layer: 1, offset: [0; 2], extent, tiles }]);
            let size = extent[0] as usize * extent[1] as usize * format.texel_size();
            let mut bytes = vec![0; 2 * size.next_multiple_of(4)];
            for (layer, out) in (0..).zip(bytes.chunks_exact_mut(size.next_multiple_of(4))) {
                write_template(&mask, layer, format, depths, out);
            }
            let words: Vec<u32> = bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect();
            let params = TemplateParams::new(extent[0], words.len() as u32 / 2, format, depths);
            for index in 0..2 * extent[0] * extent[1] {
                let (layer, index) = (index / (extent[0] * extent[1]), index % (extent[0] * extent[1]));
                let pixel = [index % extent[0], index / extent[0]];
                assert_eq!(
                    params.is_drawn(&words, layer, pixel),
                    mask.skips(layer, pixel),
                    "{format:?} {pixel:?}"
                );
            }
        }
    }
}
