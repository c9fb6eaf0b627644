//! Reference of the kernel `samples`: the skipped pixels of pictures and depth of several samples, drawn to all samples of a pixel.
//!
//! Colour is that of a picture of one sample, to which the samples were resolved and in which skipped blocks were filled. Depth is that of a
//! source pixel in the nearest ring of blocks that has a shaded one: depth is not interpolated, see [`super::depth`].

use super::template::TemplateParams;
use crate::mask::{BLOCK, REACH};
use glam::{IVec2, UVec2};

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

/// The shaded pixel whose depth a skipped one gets, in a layer of a template whose words are `words`, of pictures of `extent` pixels: of the
/// nearest ring of blocks with a shaded one, the nearest pixel; of equally near ones the first. None if nothing within [`REACH`] blocks is
/// shaded.
pub fn depth_source(
    params: &TemplateParams,
    words: &[u32],
    layer: u32,
    extent: [u32; 2],
    pixel: [u32; 2],
) -> Option<[u32; 2]> {
    let pixel = UVec2::from(pixel).as_ivec2();
    let extent = UVec2::from(extent).as_ivec2();
    let origin = pixel / BLOCK as i32 * BLOCK as i32;
    (1..=REACH as i32)
        .find_map(|distance| {
            let nearest = (0..8 * distance).filter_map(|index| {
                let first = origin + around(distance, index) * BLOCK as i32;
                let source = pixel.clamp(first, first + (BLOCK as i32 - 1));
                let inside = source.cmpge(IVec2::ZERO).all() && source.cmplt(extent).all();
                let is_shaded = inside && !params.is_drawn(words, layer, source.as_uvec2().to_array());
                is_shaded.then_some(source)
            });
            nearest.min_by_key(|source| (*source - pixel).length_squared())
        })
        .map(|source| source.as_uvec2().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mask::{DepthFormat, Mask, MaskView, TemplateDepths, TileRates, write_template};
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
        let (extent, format) = ([68, 50], DepthFormat::Float32);
        let depths = TemplateDepths { shaded: 0.0, skipped: 1.0 };
        for rate in [ShadingRate::R2X2, ShadingRate::R4X4] {
            let rates = [rate.texel(); 81];
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 9, rates: &rates };
            let mut mask = Mask::new(extent, 1);
            mask.lay(&[MaskView { layer: 0, offset: [0; 2], extent, tiles }]);
            let mut bytes = vec![0; (extent[0] * extent[1]) as usize * format.texel_size()];
            write_template(&mask, 0, format, depths, &mut bytes);
            let words: Vec<u32> = bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect();
            let params = TemplateParams::new(extent[0], words.len() as u32, format, depths);
            for index in 0..extent[0] * extent[1] {
                let pixel = [index % extent[0], index / extent[0]];
                if mask.skips(0, pixel) {
                    let source = depth_source(&params, &words, 0, extent, pixel).unwrap();
                    assert!(!mask.skips(0, source), "{rate:?} {pixel:?} {source:?}");
                    assert!(source[0].abs_diff(pixel[0]).max(source[1].abs_diff(pixel[1])) <= 5 * BLOCK);
                }
            }
        }
    }
}
