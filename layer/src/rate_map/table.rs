//! Tiles that each texel of a rate image meets, for rates that are resolved on the GPU.

use super::{EyeMap, PartRect, PartRects, RateImage, is_covered, maps, span};
use crate::pass_detection::{Orientation, Part};
use parafovea_core::kernels::resolve::RateMapTable;
use std::ptr;

/// Longest side in tiles that a table can name.
const MOST_TILES: u32 = u16::MAX as u32;

/// The entries that [`super::resolve`] looks up for each texel, with the tiles of `eyes`, whose rates do not matter. `None` if `image` has
/// no texels, or if an eye in `parts` has no tiles, or too many.
pub fn rate_map_table(eyes: [&EyeMap; 2], parts: &[Part], image: &RateImage) -> Option<RateMapTable> {
    if image.texel.contains(&0) || image.is_empty() {
        return None;
    }
    let mut table = RateMapTable::new(image.tiles, image.layers);
    let mut covered = Vec::with_capacity(image.len());
    for layer in 0..image.layers {
        let on_layer = |part: &&Part| image.layers == 1 || part.layer == layer;
        let places: PartRects =
            parts.iter().filter(on_layer).map(|part| PartRect::new(part, image)).collect();
        for place in &places {
            for map in maps(eyes, place.eyes) {
                if map.tiles().contains(&0) || map.tiles().iter().any(|count| *count > MOST_TILES) {
                    return None;
                }
                let eye = u32::from(!ptr::eq(map, eyes[0]));
                if place.orientation != Orientation::UpsideDown {
                    add(&mut table, layer, eye, map, place, image, false);
                }
                if place.orientation != Orientation::Upright {
                    add(&mut table, layer, eye, map, place, image, true);
                }
            }
        }
        for row in 0..image.tiles[1] {
            covered.extend((0..image.tiles[0]).map(|column| is_covered(&places, image, [column, row])));
        }
    }
    table.cover(&covered);
    Some(table)
}

fn add(
    table: &mut RateMapTable,
    layer: u32,
    eye: u32,
    map: &EyeMap,
    place: &PartRect,
    image: &RateImage,
    flipped: bool,
) {
    let met = |axis: usize, flipped: bool| {
        (0..image.tiles[axis]).map(move |index| span::met(map, place, image, axis, index, flipped).tiles())
    };
    table.add(layer, eye, met(0, false), met(1, flipped));
}
