//! Reference of the kernel `fill`: the skipped blocks of a picture, filled from the shaded ones around.
//!
//! Each pixel is a weighted mean of up to four others, each the nearest to it of one of the [`Source`]s of its block.
//! The weight falls with the square of the distance (Shepard 1968, "A two-dimensional interpolation function for
//! irregularly-spaced data"), so there is no step where a shaded block begins. Where two opposite sources are more alike
//! than the two others, they count for more: an edge is followed rather than blurred, as in the interpolation of colour
//! filter arrays (Hamilton and Adams 1997). `tests/baselines/fill.md` has the gain of either.
//!
//! Only shaded blocks are read and only skipped ones written, so the order does not matter and the picture is its own
//! target. A source that is not finite is left out.

mod format;

pub use format::FillFormat;

use crate::mask::{BLOCK, SOURCES, SkipList, SkippedBlock, Source};
use glam::{IVec2, UVec2, Vec3, Vec4, Vec4Swizzles};

/// Contrast below which opposite sources count as alike, as a share of the sources' mean sum of components.
const CONTRAST_FLOOR: f32 = 0.25;

/// Keeps black sources from a division by 0.
const LEAST_CONTRAST: f32 = 1e-6;

/// The pixel of a source block that is nearest to `pixel`, and the squared distance to it, at least 1.
fn nearest_pixel(pixel: IVec2, block: UVec2, source: Source) -> (UVec2, f32) {
    let first = (block.as_ivec2() + source.offset()) * BLOCK as i32;
    let nearest = pixel.clamp(first, first + (BLOCK as i32 - 1));
    (nearest.as_uvec2(), (nearest - pixel).length_squared() as f32)
}

/// Weighted mean of colours with the squares of their distances; transparent black where there is none.
pub fn blend(sources: [Option<(Vec4, f32)>; SOURCES]) -> Vec4 {
    let sources = sources.map(|source| source.filter(|(color, _)| color.is_finite()));
    let rgb = sources.map(|source| source.map(|(color, _)| color.xyz()));
    let count = sources.iter().flatten().count() as f32;
    let total: f32 = rgb.iter().flatten().map(|rgb| rgb.abs().element_sum()).sum();
    let floor = CONTRAST_FLOOR * total / count.max(1.0) + LEAST_CONTRAST;
    let contrast = |a: Option<Vec3>, b: Option<Vec3>| Some((a? - b?).abs().element_sum());
    // Where one of the pairs is incomplete, none is preferred.
    let pairs = contrast(rgb[0], rgb[2]).zip(contrast(rgb[1], rgb[3]));
    let (level, upright) = pairs.unwrap_or((0.0, 0.0));
    let preference = [upright + floor, level + floor];
    let weighted = sources.iter().zip([0, 1, 0, 1]).filter_map(|(source, pair): (_, usize)| {
        let (color, distance_squared) = (*source)?;
        Some((color, preference[pair] / distance_squared))
    });
    let (sum, weights) = weighted
        .fold((Vec4::ZERO, 0.0), |(sum, weights), (color, weight)| (sum + color * weight, weights + weight));
    if weights > 0.0 { sum / weights } else { Vec4::ZERO }
}

/// Fills the skipped blocks of one array layer, whose rows of pixels `pixels` holds without gaps. Blocks and sources
/// that are not wholly inside of `extent` are ignored, and blocks without sources are left.
pub fn fill_image(pixels: &mut [u8], extent: [u32; 2], format: FillFormat, list: &SkipList, layer: u32) {
    let size = format.texel_size();
    let rows = (pixels.len() / size).checked_div(extent[0] as usize).unwrap_or(0);
    let extent = UVec2::new(extent[0], extent[1].min(rows as u32));
    let start = |pixel: UVec2| (pixel.y as usize * extent.x as usize + pixel.x as usize) * size;
    let inside = |block: UVec2| ((block + 1) * BLOCK).cmple(extent).all();
    for SkippedBlock { block, sources, .. } in list.blocks().filter(|block| block.layer == layer) {
        if !inside(block) || sources.iter().all(Option::is_none) {
            continue;
        }
        let usable = |source: &Source| {
            let at = block.as_ivec2() + source.offset();
            at.cmpge(IVec2::ZERO).all() && inside(at.as_uvec2())
        };
        let sources = sources.map(|source| source.filter(usable));
        for index in 0..BLOCK * BLOCK {
            let pixel = block * BLOCK + UVec2::new(index % BLOCK, index / BLOCK);
            let colors = sources.map(|source| {
                let (nearest, distance_squared) = nearest_pixel(pixel.as_ivec2(), block, source?);
                Some((format.decode(&pixels[start(nearest)..][..size]), distance_squared))
            });
            format.encode(blend(colors), &mut pixels[start(pixel)..][..size]);
        }
    }
}

#[cfg(test)]
mod tests;
