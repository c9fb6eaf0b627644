//! Reference of the kernel `depth`: skipped blocks of a depth buffer that outlives its pass, in a copy of it.
//!
//! Ahead of a pass that loads depth, skipped blocks are covered with the nearest depth, and the rest stays. After a pass whose depth
//! is read later, each texel of a skipped block becomes that of the nearest source pixel: depth is not interpolated, as a value
//! between two surfaces lies on neither.

use crate::layout::uniform;
use crate::mask::{BLOCK, DepthFormat, SkipList, SkippedBlock};
use glam::UVec2;

uniform! {
    /// Parameters of one depth buffer, the shader's struct of the same name.
    pub struct DepthParams {
        /// Texels of a row.
        pub width: u32,
        /// Words of an array layer.
        pub layer_words: u32,
        /// Texels in a word: 1 or 2.
        pub texels_in_word: u32,
        /// A word of the nearest depth.
        pub near: u32,
    }
}

impl DepthParams {
    /// Parameters of depth of `extent` pixels, whose nearest value is `near`. None if blocks do not begin with a word in every
    /// row.
    pub fn new([width, height]: [u32; 2], format: DepthFormat, near: f32) -> Option<Self> {
        let texels_in_word = 4 / format.texel_size() as u32;
        let layer_words = width.checked_mul(height)? / texels_in_word;
        let near = format.word(near);
        width.is_multiple_of(texels_in_word).then_some(Self { width, layer_words, texels_in_word, near })
    }

    fn texel(&self, words: &[u32], layer: u32, pixel: UVec2) -> u32 {
        let (word, shift) = self.place(layer, pixel);
        words[word] >> shift & self.texel_mask()
    }

    fn set(&self, words: &mut [u32], layer: u32, pixel: UVec2, texel: u32) {
        let (word, shift) = self.place(layer, pixel);
        words[word] = words[word] & !(self.texel_mask() << shift) | texel << shift;
    }

    fn place(&self, layer: u32, pixel: UVec2) -> (usize, u32) {
        let texel = pixel.y * self.width + pixel.x;
        let word = layer * self.layer_words + texel / self.texels_in_word;
        (word as usize, 16 * (texel % self.texels_in_word))
    }

    fn texel_mask(&self) -> u32 {
        if self.texels_in_word == 2 { 0xffff } else { u32::MAX }
    }
}

/// Writes the nearest depth to all skipped blocks that have sources.
pub fn cover(words: &mut [u32], params: &DepthParams, list: &SkipList) {
    for (block, pixel) in pixels(list) {
        params.set(words, block.layer, pixel, params.near & params.texel_mask());
    }
}

/// Writes to each texel of skipped blocks that have sources the nearest one of those; of equally near ones the first.
pub fn fill(words: &mut [u32], params: &DepthParams, list: &SkipList) {
    for (block, pixel) in pixels(list) {
        let pixel = pixel.as_ivec2();
        let nearest = block.sources.iter().flatten().map(|source| {
            let first = (block.block.as_ivec2() + source.offset()) * BLOCK as i32;
            pixel.clamp(first, first + (BLOCK as i32 - 1))
        });
        if let Some(from) = nearest.min_by_key(|from| (*from - pixel).length_squared()) {
            let texel = params.texel(words, block.layer, from.as_uvec2());
            params.set(words, block.layer, pixel.as_uvec2(), texel);
        }
    }
}

/// The pixels of skipped blocks that have sources.
fn pixels(list: &SkipList) -> impl Iterator<Item = (SkippedBlock, UVec2)> {
    let blocks = list.blocks().filter(|block| block.sources.iter().any(Option::is_some));
    blocks.flat_map(|block| {
        (0..BLOCK * BLOCK)
            .map(move |index| (block, block.block * BLOCK + UVec2::new(index % BLOCK, index / BLOCK)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mask::{Mask, MaskView, TileRates};
    use crate::rate::ShadingRate;
    use glam::IVec2;

    const EXTENT: [u32; 2] = [64, 48];

    fn mask() -> Mask {
        let rates = [ShadingRate::R4X4.texel(); 64];
        let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 8, rates: &rates };
        let mut mask = Mask::new(EXTENT, 2);
        mask.resolve(&[MaskView { layer: 1, offset: [0; 2], extent: EXTENT, tiles }]);
        mask
    }

    /// Every texel its own.
    fn texels(params: &DepthParams) -> Vec<u32> {
        let mut words = vec![0; 2 * params.layer_words as usize];
        for layer in 0..2 {
            for y in 0..EXTENT[1] {
                for x in 0..EXTENT[0] {
                    params.set(&mut words, layer, UVec2::new(x, y), 1 + layer * 0x1000 + y * 64 + x);
                }
            }
        }
        words
    }

    #[test]
    fn skipped_blocks_are_covered_and_filled_and_others_stay() {
        let mask = mask();
        for format in [DepthFormat::Unorm16, DepthFormat::Unorm24, DepthFormat::Float32] {
            let params = DepthParams::new(EXTENT, format, 0.0).unwrap();
            let before = texels(&params);
            let (mut covered, mut filled) = (before.clone(), before.clone());
            cover(&mut covered, &params, mask.list());
            fill(&mut filled, &params, mask.list());
            for index in 0..2 * 64 * 48 {
                let (layer, x, y) = (index / (64 * 48), index % 64, index / 64 % 48);
                let at = |words: &[u32]| params.texel(words, layer, UVec2::new(x, y));
                let was = at(&before);
                if !mask.skips(layer, [x, y]) {
                    assert_eq!((at(&covered), at(&filled)), (was, was), "{format:?} {layer} {x} {y}");
                    continue;
                }
                assert_eq!(at(&covered), 0, "{format:?} {x} {y}");
                let from = (at(&filled) - 1) & 0xfff;
                let away = IVec2::new((from % 64) as i32 - x as i32, (from / 64) as i32 - y as i32);
                assert!(!mask.skips(1, [from % 64, from / 64]) && away != IVec2::ZERO, "{format:?} {x} {y}");
            }
        }
    }

    #[test]
    fn rows_that_do_not_begin_with_a_word_are_refused() {
        assert_eq!(DepthParams::new([63, 8], DepthFormat::Unorm16, 1.0), None);
        assert!(DepthParams::new([63, 8], DepthFormat::Float32, 1.0).is_some());
    }
}
