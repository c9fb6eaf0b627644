//! Resolves the plan's rates over the pictures of a pass: the content of its rate image.
//!
//! Each texel of the rate image gets the finest rate of all tiles of the plan that it overlaps. Rows and columns can be resolved
//! separately, because all rectangles are axis-aligned. Rates are combined in unary, where the finer of two is a bitwise AND: log2 of a
//! side of 0, 1, 2 is 0b00, 0b01, 0b11. So is the bit [`STALE`], which a texel has if all tiles that it overlaps are stale.

mod eye_map;
mod layout;
mod rates;
mod span;
mod table;

pub use eye_map::EyeMap;
pub use rates::{DeviceRates, refine_fresh};
pub use table::rate_map_table;

use crate::pass_detection::{Eyes, Orientation, Part};
use layout::Layouts;
use parafovea_core::reuse::STALE;
use smallvec::SmallVec;

/// The rate image of a pass, and where the pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateImage {
    /// Render area of the pass: x, y, width, height in pixels.
    pub area: [u32; 4],
    /// Size of a texel, pixels; the first one begins at pixel 0, 0 of the framebuffer.
    pub texel: [u32; 2],
    /// Columns and rows of texels.
    pub tiles: [u32; 2],
    /// Array layers: 1 serves all layers of the pass, and holds the finest rate of them.
    pub layers: u32,
}

impl RateImage {
    /// Number of texels of all layers, one byte each.
    pub fn len(&self) -> usize {
        self.layer_len() * self.layers as usize
    }

    /// Whether it has no texels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn layer_len(&self) -> usize {
        self.tiles[0] as usize * self.tiles[1] as usize
    }
}

/// Space to work in, kept so that a frame allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    layouts: Layouts,
    /// The finest of some rows of the plan.
    row: Vec<u8>,
}

/// Writes the texels of `image` to `out`, row by row, layer by layer: [`parafovea_core::rate::ShadingRate::texel`], with
/// [`STALE`].
///
/// Texels with a pixel of the render area that no part covers, and those outside of the area, are 1x1. `out` has [`RateImage::len`] bytes;
/// further bytes become 1x1; if it is shorter, the rest is left out.
pub fn resolve(
    eyes: [&EyeMap; 2],
    parts: &[Part],
    image: &RateImage,
    rates: &DeviceRates,
    scratch: &mut Scratch,
    out: &mut [u8],
) {
    let len = image.layer_len();
    let covered = out.len().min(image.len());
    out[covered..].fill(0);
    if image.texel.contains(&0) || len == 0 || !covered.is_multiple_of(len) {
        out.fill(0);
        return;
    }
    for (layer, texels) in (0u32..).zip(out[..covered].chunks_exact_mut(len)) {
        let on_layer = |part: &&Part| image.layers == 1 || part.layer == layer;
        let places = parts.iter().filter(on_layer).map(|part| PartRect::new(part, image)).collect();
        resolve_layer(eyes, &places, image, rates, scratch, texels);
    }
}

/// The parts of a layer.
type PartRects = SmallVec<[PartRect; 8]>;

fn resolve_layer(
    eyes: [&EyeMap; 2],
    places: &PartRects,
    image: &RateImage,
    rates: &DeviceRates,
    scratch: &mut Scratch,
    texels: &mut [u8],
) {
    if let Some(rates) = identity(eyes, places, image, rates) {
        texels.copy_from_slice(rates);
        return;
    }
    let Scratch { layouts, row: finest } = scratch;
    layouts.of(eyes, places, image).fill(eyes, rates, finest, texels);
}

/// Stale, and unary of 4x4: no limit.
const COARSEST: u8 = STALE | 0b1111;

/// The plans of some eyes.
fn maps(eyes: [&EyeMap; 2], of: Eyes) -> impl Iterator<Item = &EyeMap> {
    let [left, right] = eyes;
    let (first, second) = match of {
        Eyes::Left => (left, None),
        Eyes::Right => (right, None),
        Eyes::Finer => (left, Some(right)),
    };
    std::iter::once(first).chain(second)
}

/// The plan's own texels, where they need no change.
fn identity<'a>(
    eyes: [&'a EyeMap; 2],
    places: &PartRects,
    image: &RateImage,
    rates: &DeviceRates,
) -> Option<&'a [u8]> {
    let [place] = places.as_slice() else { return None };
    let [left, right] = eyes;
    let map = match place.eyes {
        Eyes::Left => left,
        Eyes::Right => right,
        Eyes::Finer => return None,
    };
    let [width, height] = map.extent();
    let same = place.orientation == Orientation::Upright
        && place.axes == [(0, i64::from(width)), (0, i64::from(height))]
        && image.area == [0, 0, width, height]
        && image.texel == map.texel()
        && image.tiles == map.tiles()
        && rates.has_all(map.used());
    same.then(|| map.texels())
}

/// A part in pixels: first and end on each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PartRect {
    eyes: Eyes,
    orientation: Orientation,
    axes: [(i64, i64); 2],
}

/// Limit of positions, in render areas from the corner: further ones are clamped.
const FAR: f32 = 64.0;

impl PartRect {
    fn new(part: &Part, image: &RateImage) -> Self {
        let [x, y, width, height] = image.area;
        let axis = |offset: u32, size: u32, first: f32, extent: f32| {
            let at = |fraction: f32| {
                let pixels = f64::from(fraction.clamp(-FAR, FAR)) * f64::from(size);
                i64::from(offset) + pixels.round() as i64
            };
            (at(first), at(first + extent))
        };
        let [left, top, wide, high] = part.rect;
        let axes = [axis(x, width, left, wide), axis(y, height, top, high)];
        Self { eyes: part.eyes, orientation: part.orientation, axes }
    }

    /// Whether the part has all pixels of a row within the render area, or none; `None` where it has some, or the row lies outside of the
    /// area.
    fn covers_row(&self, image: &RateImage, row: u32) -> Option<bool> {
        let texel = i64::from(image.texel[1]);
        let (area, area_end) = area(image, 1);
        let from = (i64::from(row) * texel).max(area);
        let to = ((i64::from(row) + 1) * texel).min(area_end);
        let (first, end) = self.axes[1];
        match () {
            () if from >= to => None,
            () if first <= from && to <= end => Some(true),
            () if end <= from || to <= first => Some(false),
            () => None,
        }
    }
}

/// First pixel and end of the render area on an axis.
fn area(image: &RateImage, axis: usize) -> (i64, i64) {
    let first = i64::from(image.area[axis]);
    (first, first + i64::from(image.area[axis + 2]))
}

/// Whether some pixel of a texel is in the render area, and each of those is in a part.
fn is_covered(places: &[PartRect], image: &RateImage, tile: [u32; 2]) -> bool {
    let pixels = [0, 1].map(|axis| {
        let first = i64::from(tile[axis]) * i64::from(image.texel[axis]);
        let (area, area_end) = area(image, axis);
        (first.max(area), (first + i64::from(image.texel[axis])).min(area_end))
    });
    pixels.iter().all(|(first, end)| first < end) && are_covered(places, pixels)
}

/// Whether each of some pixels is in a part. Pixels outside of the first part, at most four rectangles, must be in the others.
fn are_covered(places: &[PartRect], [x, y]: [(i64, i64); 2]) -> bool {
    if x.0 >= x.1 || y.0 >= y.1 {
        return true;
    }
    let Some((place, others)) = places.split_first() else { return false };
    let [place_x, place_y] = place.axes;
    let (from, to) = (place_x.0.clamp(x.0, x.1), place_x.1.clamp(x.0, x.1));
    let (top, bottom) = (place_y.0.clamp(y.0, y.1), place_y.1.clamp(y.0, y.1));
    if from >= to || top >= bottom {
        return are_covered(others, [x, y]);
    }
    [[(x.0, from), y], [(to, x.1), y], [(from, to), (y.0, top)], [(from, to), (bottom, y.1)]]
        .into_iter()
        .all(|rest| are_covered(others, rest))
}

#[cfg(test)]
mod tests;
