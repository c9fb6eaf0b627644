//! Reference of the kernel `nearest`: copies of the nearest texels into skipped blocks of a picture.
//!
//! For depth, motion and indices, which cannot be interpolated: a value between two surfaces belongs to neither. After a pass, each texel of a skipped block
//! becomes that of the nearest source pixel, the same one in all pictures of a pass. Ahead of a pass that loads depth, skipped blocks are
//! covered with the nearest depth. The rest stays.

use crate::layout::uniform;
use crate::mask::{BLOCK, DepthFormat, SkipList, SkippedBlock};
use glam::UVec2;

uniform! {
    /// Parameters of one picture, the shader's struct of the same name.
    pub struct NearestParams {
        /// Words of a row, in which a block of four texels begins with a word.
        pub row_words: u32,
        /// Words of an array layer.
        pub layer_words: u32,
        /// Bytes of a texel: 1, 2, 4, 8 or 16.
        pub texel_size: u32,
        /// A word of the nearest depth.
        pub near: u32,
    }
}

impl NearestParams {
    /// Parameters of depth of `extent` pixels, whose nearest value is `near`. None for pictures that are too large, and where rows would
    /// have padding: as in its template, offsets in copies of depth are multiples of four bytes.
    pub fn of_depth(extent: [u32; 2], format: DepthFormat, near: f32) -> Option<Self> {
        let params = Self::of_texels(extent, format.texel_size() as u32)?;
        (params.row_texels() == extent[0]).then_some(Self { near: format.word(near), ..params })
    }

    /// Parameters of pictures of `extent` pixels with texels of `texel_size` bytes: 1, 2, 4, 8 or 16. None for pictures that are too large.
    pub fn of_texels([width, height]: [u32; 2], texel_size: u32) -> Option<Self> {
        let row_words = width.checked_mul(texel_size)?.div_ceil(4);
        let layer_words = row_words.checked_mul(height)?;
        Some(Self { row_words, layer_words, texel_size, near: 0 })
    }

    /// Texels from one row to the next.
    pub fn row_texels(&self) -> u32 {
        self.row_words * 4 / self.texel_size
    }

    /// The first byte of a texel.
    fn start(&self, layer: u32, pixel: UVec2) -> usize {
        let words = layer * self.layer_words + pixel.y * self.row_words;
        words as usize * 4 + (pixel.x * self.texel_size) as usize
    }
}

/// Writes the nearest depth to all skipped blocks that have sources.
pub fn cover(words: &mut [u32], params: &NearestParams, list: &SkipList) {
    let size = params.texel_size as usize;
    let bytes: &mut [u8] = bytemuck::cast_slice_mut(words);
    for (block, pixel) in pixels(list) {
        let near = params.near.to_ne_bytes().into_iter().cycle();
        let texel = &mut bytes[params.start(block.layer, pixel)..][..size];
        texel.iter_mut().zip(near).for_each(|(byte, near)| *byte = near);
    }
}

/// Writes to each texel of skipped blocks that have sources the nearest one of those; of equally near ones the first.
pub fn fill(words: &mut [u32], params: &NearestParams, list: &SkipList) {
    let size = params.texel_size as usize;
    let bytes: &mut [u8] = bytemuck::cast_slice_mut(words);
    for (block, pixel) in pixels(list) {
        let pixel = pixel.as_ivec2();
        let nearest = block.sources.iter().flatten().map(|source| {
            let first = (block.block.as_ivec2() + source.offset()) * BLOCK as i32;
            pixel.clamp(first, first + (BLOCK as i32 - 1))
        });
        if let Some(from) = nearest.min_by_key(|from| (*from - pixel).length_squared()) {
            let from = params.start(block.layer, from.as_uvec2());
            bytes.copy_within(from..from + size, params.start(block.layer, pixel.as_uvec2()));
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

    /// Neither side is a multiple of four.
    const EXTENT: [u32; 2] = [63, 47];

    fn mask() -> Mask {
        let rates = [ShadingRate::R4X4.texel(); 64];
        let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 8, rates: &rates };
        let mut mask = Mask::new(EXTENT, 2);
        mask.resolve(&[MaskView { layer: 1, offset: [0; 2], extent: EXTENT, tiles }]);
        mask
    }

    /// Of each pixel of a layer a number in its first bytes.
    fn numbers(params: &NearestParams, words: &[u32]) -> Vec<u32> {
        let bytes: &[u8] = bytemuck::cast_slice(words);
        let size = params.texel_size.min(2) as usize;
        let number = |layer, x, y| {
            let texel = &bytes[params.start(layer, UVec2::new(x, y))..][..size];
            texel.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
        };
        (0..2)
            .flat_map(|layer| (0..EXTENT[1]).map(move |y| (layer, y)))
            .flat_map(|(layer, y)| (0..EXTENT[0]).map(move |x| number(layer, x, y)))
            .collect()
    }

    /// Words in which neighbouring texels differ.
    fn words(params: &NearestParams) -> Vec<u32> {
        let mut words = vec![0u32; 2 * params.layer_words as usize];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        for (layer, y) in (0..2).flat_map(|layer| (0..EXTENT[1]).map(move |y| (layer, y))) {
            for x in 0..EXTENT[0] {
                let number = (1 + layer * 0x1000 + y * 64 + x) as u16;
                let texel = &mut bytes[params.start(layer, UVec2::new(x, y))..];
                let texel = &mut texel[..params.texel_size as usize];
                texel.iter_mut().zip(number.to_le_bytes()).for_each(|(to, from)| *to = from);
            }
        }
        words
    }

    #[test]
    fn skipped_blocks_are_covered_and_filled_and_others_stay() {
        let mask = mask();
        let depths = [DepthFormat::Unorm16, DepthFormat::Unorm24, DepthFormat::Float32];
        let depths = depths.map(|format| NearestParams::of_depth([64, EXTENT[1]], format, 0.0));
        let texels = [1, 2, 4, 8, 16].map(|size| NearestParams::of_texels(EXTENT, size));
        for params in depths.into_iter().chain(texels).map(Option::unwrap) {
            let before = words(&params);
            let (mut covered, mut filled) = (before.clone(), before.clone());
            cover(&mut covered, &params, mask.list());
            fill(&mut filled, &params, mask.list());
            let [before, covered, filled] = [before, covered, filled].map(|words| numbers(&params, &words));
            for index in 0..before.len() {
                let pixel = index as u32 % (EXTENT[0] * EXTENT[1]);
                let (layer, x, y) = (index / (63 * 47), pixel % EXTENT[0], pixel / EXTENT[0]);
                if !mask.skips(layer as u32, [x, y]) {
                    assert_eq!([covered[index], filled[index]], [before[index]; 2], "{params:?} {x} {y}");
                    continue;
                }
                assert_eq!(covered[index], 0, "{params:?} {x} {y}");
                if params.texel_size > 1 {
                    let from = (filled[index] - 1) & 0xfff;
                    let [column, row] = [from % 64, from / 64];
                    let away = IVec2::new(column as i32 - x as i32, row as i32 - y as i32);
                    assert!(!mask.skips(1, [column, row]) && away != IVec2::ZERO, "{params:?} {x} {y}");
                }
            }
        }
    }

    #[test]
    fn rows_begin_with_a_word() {
        let row = |size| {
            let params = NearestParams::of_texels([63, 8], size).unwrap();
            [params.row_words, params.row_texels(), params.layer_words]
        };
        assert_eq!([1, 2, 4].map(row), [[16, 64, 128], [32, 64, 256], [63, 63, 504]]);
        assert_eq!([8, 16].map(row), [[126, 63, 1008], [252, 63, 2016]]);
        assert_eq!(NearestParams::of_texels([1 << 16; 2], 16), None);
    }

    #[test]
    fn rows_of_depth_that_would_have_padding_are_refused() {
        assert_eq!(NearestParams::of_depth([63, 8], DepthFormat::Unorm16, 1.0), None);
        assert!(NearestParams::of_depth([63, 8], DepthFormat::Float32, 1.0).is_some());
    }
}
