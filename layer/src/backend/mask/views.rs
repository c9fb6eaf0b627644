//! From the rates of a pass to its mask.

use crate::pass_detection::Part;
use crate::rate_map::RateImage;
use parafovea_core::mask::{Mask, MaskView, TileRates};
use smallvec::SmallVec;

/// Lays the rates that [`crate::rate_map::resolve`] wrote for `image` over the pictures of a pass, which `parts` describe. Views end where
/// a part does: nothing is interpolated from one into another.
pub fn resolve_mask(mask: &mut Mask, parts: &[Part], image: &RateImage, rates: &[u8]) {
    let views: Views = views(parts, image, rates).collect();
    mask.resolve(&views);
}

/// The views of a pass.
type Views<'a> = SmallVec<[MaskView<'a>; 8]>;

/// The views of `parts`, without views that overlap an earlier one; their rates do not matter.
pub fn mask_views(parts: &[Part], image: &RateImage) -> Views<'static> {
    let mut kept = Views::new();
    for view in views(parts, image, &[]) {
        if !kept.iter().any(|earlier| earlier.overlaps(&view)) {
            kept.push(view);
        }
    }
    kept
}

/// The views of `parts`, with the rates of their layers if `rates` has them.
fn views<'a>(parts: &[Part], image: &RateImage, rates: &'a [u8]) -> impl Iterator<Item = MaskView<'a>> {
    let [x, y, width, height] = image.area;
    let len = image.tiles[0] as usize * image.tiles[1] as usize;
    parts.iter().map(move |part| {
        let layer = if image.layers == 1 { 0 } else { part.layer };
        let texels = rates.get(layer as usize * len..).and_then(|rates| rates.get(..len)).unwrap_or(&[]);
        // Pixels that a part has in part belong to it, as they do in the rates.
        let axis = |offset: u32, size: u32, first: f32, extent: f32| {
            let at = |fraction: f32| {
                let pixels = f64::from(fraction.clamp(0.0, 1.0)) * f64::from(size);
                offset.saturating_add(pixels.round() as u32)
            };
            (at(first), at(first + extent) - at(first))
        };
        let [left, top, wide, high] = part.rect;
        let ((x, width), (y, height)) = (axis(x, width, left, wide), axis(y, height, top, high));
        let tiles = TileRates { texel: image.texel, first: [0; 2], columns: image.tiles[0], rates: texels };
        MaskView { layer: part.layer, offset: [x, y], extent: [width, height], tiles }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::{Eyes, Orientation};
    use parafovea_core::rate::ShadingRate;

    fn part(eyes: Eyes, layer: u32, rect: [f32; 4]) -> Part {
        Part { eyes, layer, rect, orientation: Orientation::Upright }
    }

    #[test]
    fn views_end_where_parts_do() {
        let image = RateImage { area: [0, 0, 256, 128], texel: [16; 2], tiles: [16, 8], layers: 1 };
        let rates = vec![ShadingRate::R4X4.texel(); image.len()];
        let parts = [part(Eyes::Left, 0, [0.0, 0.0, 0.5, 1.0]), part(Eyes::Right, 0, [0.5, 0.0, 0.5, 1.0])];
        let mut mask = Mask::new([256, 128], 1);
        resolve_mask(&mut mask, &parts, &image, &rates);
        assert!(mask.shaded() < 0.1, "{}", mask.shaded());
        for block in mask.list().blocks() {
            let left = block.block.x < 32;
            let of = |offset: i32| (block.block.x.strict_add_signed(offset) < 32) == left;
            assert!(block.sources.iter().flatten().all(|source| of(source.offset().x)));
        }
    }

    #[test]
    fn layers_and_render_areas_are_kept_to() {
        let image = RateImage { area: [32, 16, 64, 48], texel: [16; 2], tiles: [8, 8], layers: 2 };
        let mut rates = vec![0; image.len()];
        rates[64..].fill(ShadingRate::R2X2.texel());
        let parts = [0, 1].map(|layer| part(Eyes::Finer, layer, [0.0, 0.0, 1.0, 1.0]));
        let mut mask = Mask::new([128, 128], 2);
        resolve_mask(&mut mask, &parts, &image, &rates);
        assert!(!mask.list().is_empty());
        for block in mask.list().blocks() {
            let [x, y] = [block.block.x * 4, block.block.y * 4];
            assert!(block.layer == 1 && (32..96).contains(&x) && (16..64).contains(&y), "{x}, {y}");
        }
        // Fewer rates than there should be: shaded.
        resolve_mask(&mut mask, &parts, &image, &rates[..100]);
        assert!(mask.list().is_empty());
    }
}
