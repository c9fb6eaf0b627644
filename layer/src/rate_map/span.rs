//! Ranges of rows or columns.

use super::{EyeMap, PartRect, RateImage, area};
use std::ops::Range;

/// Some rows or columns that follow each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    first: u32,
    end: u32,
}

impl Span {
    /// Part of `from..to` that is within `0..count`.
    pub(super) fn within(from: i64, to: i64, count: u32) -> Self {
        let limit = |at: i64| at.clamp(0, i64::from(count)) as u32;
        Self { first: limit(from), end: limit(to) }
    }

    pub(super) fn is_empty(self) -> bool {
        self.first >= self.end
    }

    /// As numbers of tiles; empty ones begin and end at 0.
    pub(super) fn tiles(self) -> Range<u32> {
        if self.is_empty() { 0..0 } else { self.first..self.end }
    }

    pub(super) fn range(self) -> Range<usize> {
        self.first as usize..self.end as usize
    }
}

/// The columns (`axis` 0) or rows (1) of the plan that a column or row of the rate image meets, where the plan is scaled
/// to `place`. Exact, in whole numbers. A plan without tiles counts as one tile at 1x1.
pub(super) fn met(
    map: &EyeMap,
    place: &PartRect,
    image: &RateImage,
    axis: usize,
    index: u32,
    flipped: bool,
) -> Span {
    let (first, end) = place.axes[axis];
    let (area, area_end) = area(image, axis);
    let texel = i64::from(image.texel[axis]);
    let from = (i64::from(index) * texel).max(area).max(first);
    let to = ((i64::from(index) + 1) * texel).min(area_end).min(end);
    if from >= to {
        return Span::default();
    }
    let (extent, tile, tiles) =
        (i64::from(map.extent()[axis]), i64::from(map.texel()[axis]), map.tiles()[axis]);
    if tiles == 0 {
        return Span { first: 0, end: 1 };
    }
    let (from, to) = if flipped { (end - to, end - from) } else { (from - first, to - first) };
    // Vulkan's images, and parts within 64 render areas, have sides below 2^31: all products fit.
    let whole = (end - first).saturating_mul(tile);
    let begin = from.saturating_mul(extent) / whole;
    let past = to.saturating_mul(extent).saturating_add(whole - 1) / whole;
    let last = i64::from(tiles) - 1;
    let begin = begin.min(last);
    Span::within(begin, past.max(begin + 1), tiles)
}
