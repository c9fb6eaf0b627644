//! Reference of the kernel `samples`: the skipped pixels of pictures and depth of several samples, drawn to all samples of a pixel.
//!
//! Colour is that of a picture of one sample, to which the samples were resolved and in which skipped blocks were filled. Depth is that of a
//! source pixel in the nearest ring of blocks that has a shaded one: depth is not interpolated, see [`super::nearest`].

use crate::layout::uniform;
use crate::mask::{BLOCK, DepthFormat, EarlyReturnParams, REACH, TemplateDepths};
use glam::{IVec2, UVec2};

uniform! {
    /// Parameters of one template, the shader's struct of the same name: as [`EarlyReturnParams`], and the pictures' size.
    pub struct SampleParams {
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
        /// Width of the pictures, pixels.
        pub width: u32,
        /// Their height.
        pub height: u32,
        /// Not read.
        pub padding: u32,
    }
}

impl SampleParams {
    /// Parameters of a template for pictures of this size. None where words hold pixels of two blocks, or of two rows.
    pub fn new(extent: [u32; 2], format: DepthFormat, depths: TemplateDepths) -> Option<Self> {
        let EarlyReturnParams { row_words, layer_words, column_shift, row_shift, shaded } =
            EarlyReturnParams::new(extent, format, depths)?;
        let [width, height] = extent;
        Some(Self { row_words, layer_words, column_shift, row_shift, shaded, width, height, padding: 0 })
    }

    /// Whether a pixel is shaded, by a template whose words are `words`.
    fn is_shaded(&self, words: &[u32], layer: u32, [x, y]: [u32; 2]) -> bool {
        let row = (y >> self.row_shift) * self.row_words;
        words[(layer * self.layer_words + row + (x >> self.column_shift)) as usize] == self.shaded
    }
}

/// The block in the square ring so many blocks around one, counted from the ring's upper left corner on.
fn around(distance: i32, index: i32) -> IVec2 {
    let along = index % (2 * distance) - distance;
    match index / (2 * distance) {
        0 => IVec2::new(along, -distance),
        1 => IVec2::new(distance, along),
        2 => IVec2::new(-along, distance),
        _ => IVec2::new(-distance, -along),
    }
}

/// The shaded pixel whose depth a skipped one gets, in a layer of a template whose words are `words`: of the
/// nearest ring of blocks with a shaded one, the nearest pixel; of equally near ones the first. None if nothing within [`REACH`] blocks is
/// shaded.
pub fn depth_source(params: &SampleParams, words: &[u32], layer: u32, pixel: [u32; 2]) -> Option<[u32; 2]> {
    let pixel = UVec2::from(pixel).as_ivec2();
    let extent = UVec2::new(params.width, params.height).as_ivec2();
    let origin = pixel / BLOCK as i32 * BLOCK as i32;
    (1..=REACH as i32)
        .find_map(|distance| {
            let nearest = (0..8 * distance).filter_map(|index| {
                let first = origin + around(distance, index) * BLOCK as i32;
                let source = pixel.clamp(first, first + (BLOCK as i32 - 1));
                let inside = source.cmpge(IVec2::ZERO).all() && source.cmplt(extent).all();
                let is_shaded = inside && params.is_shaded(words, layer, source.as_uvec2().to_array());
                is_shaded.then_some(source)
            });
            nearest.min_by_key(|source| (*source - pixel).length_squared())
        })
        .map(|source| source.as_uvec2().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mask::{Mask, MaskView, TileRates, write_template};
    use crate::rate::ShadingRate;
    use std::collections::BTreeSet;

    #[test]
    fn rings_have_each_block_once() {
        for distance in 1..=REACH as i32 {
            let ring: BTreeSet<_> =
                (0..8 * distance).map(|index| around(distance, index).to_array()).collect();
            assert_eq!(ring.len(), 8 * distance as usize);
            assert!(ring.iter().all(|[x, y]| x.abs().max(y.abs()) == distance), "{ring:?}");
        }
    }

    #[test]
    fn every_skipped_pixel_has_a_shaded_source_nearby() {
        let extent = [68, 50];
        for (format, rate) in [
            (DepthFormat::Float32, ShadingRate::R2X2),
            (DepthFormat::Unorm16, ShadingRate::R4X4),
            (DepthFormat::Blocks, ShadingRate::R4X4),
        ] {
            let depths = TemplateDepths { shaded: 0.0, skipped: 1.0 };
            let rates = [rate.texel(); 81];
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 9, rates: &rates };
            let mut mask = Mask::new(extent, 1);
            mask.resolve(&[MaskView { layer: 0, offset: [0; 2], extent, tiles }]);
            let params = SampleParams::new(extent, format, depths).unwrap();
            let mut words = vec![0u32; params.layer_words as usize];
            write_template(&mask, 0, format, depths, bytemuck::cast_slice_mut(&mut words));
            for index in 0..extent[0] * extent[1] {
                let pixel = [index % extent[0], index / extent[0]];
                assert_eq!(params.is_shaded(&words, 0, pixel), !mask.skips(0, pixel));
                if mask.skips(0, pixel) {
                    let source = depth_source(&params, &words, 0, pixel).unwrap();
                    assert!(!mask.skips(0, source), "{rate:?} {pixel:?} {source:?}");
                    assert!(source[0].abs_diff(pixel[0]).max(source[1].abs_diff(pixel[1])) <= 5 * BLOCK);
                }
            }
        }
    }
}
