//! Lays the plan's rates over the pictures of a pass: the content of its rate image.
//!
//! Each texel of the rate image gets the finest of all tiles of the plan that it meets. What that is can be worked out
//! for rows and columns apart, because all rectangles are upright. Rates are combined in unary, where the finer of two
//! is a bitwise AND: log2 of a side of 0, 1, 2 is 0b00, 0b01, 0b11. So is the bit [`STALE`], which a texel has where all
//! that it meets are stale.

mod eye_map;
mod rates;
mod span;
mod table;

pub use eye_map::EyeMap;
pub use rates::{DeviceRates, refine_fresh};
pub use table::lay_table;

use super::{Eyes, Orientation, Part};
use parafovea_core::reuse::STALE;
use rates::FULL;
use smallvec::SmallVec;
use span::Span;

/// The rate image of a pass, and where the pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateImage {
    /// Render area of the pass: x, y, width, height in pixels.
    pub area: [u32; 4],
    /// Size of a texel, pixels; the first one begins at pixel 0, 0 of the framebuffer.
    pub texel: [u32; 2],
    /// Columns and rows of texels.
    pub tiles: [u32; 2],
    /// Array layers: 1 serves all layers of the pass, and holds what is finest of them.
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
    /// For each limit of a layer and each column of the rate image, the columns of the plan that it meets.
    columns: Vec<Span>,
    /// The finest of some rows of the plan.
    row: Vec<u8>,
}

/// What decides a row of texels: rows that agree in it are alike.
#[derive(Clone, PartialEq, Eq, Default)]
struct RowKey {
    /// For each limit, the rows of the plan that it meets.
    met: SmallVec<[Span; 8]>,
    /// For each part, whether it has all pixels of the row within the render area, or none.
    covers: SmallVec<[bool; 8]>,
}

/// Writes the texels of `image` to `out`, row by row, layer by layer: [`parafovea_core::rate::ShadingRate::texel`], with
/// [`STALE`].
///
/// Texels with a pixel of the render area that no part covers, and those outside of the area, are 1x1. `out` has
/// [`RateImage::len`] bytes; what is more is 1x1, and of what is less the rest is left out.
pub fn lay(
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
        let places = parts.iter().filter(on_layer).map(|part| Place::new(part, image)).collect();
        lay_layer(eyes, &places, image, rates, scratch, texels);
    }
}

/// The parts of a layer.
type Places = SmallVec<[Place; 8]>;

fn lay_layer(
    eyes: [&EyeMap; 2],
    places: &Places,
    image: &RateImage,
    rates: &DeviceRates,
    scratch: &mut Scratch,
    texels: &mut [u8],
) {
    if let Some(rates) = identity(eyes, places, image, rates) {
        texels.copy_from_slice(rates);
        return;
    }
    let Scratch { columns, row: finest } = scratch;
    let limits = Limits::new(eyes, places, image, columns);
    let width = image.tiles[0] as usize;
    let mut last: Option<RowKey> = None;
    for row in 0..image.tiles[1] {
        let begin = row as usize * width;
        let key = limits.row_key(places, image, row);
        if key.is_some() && key == last {
            texels.copy_within(begin - width..begin, begin);
            continue;
        }
        last = key;
        let texels = &mut texels[begin..begin + width];
        if !limits.apply_only(image, row, columns, rates, finest, texels) {
            texels.fill(COARSEST);
            limits.apply(image, row, columns, finest, texels);
            for texel in texels.iter_mut() {
                *texel = rates.of_unary(*texel);
            }
        }
        uncover(places, image, row, texels);
    }
}

/// Stale, and unary of 4x4: no limit.
const COARSEST: u8 = STALE | 0b1111;

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
    places: &Places,
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
#[derive(Clone, Copy, Debug)]
struct Place {
    eyes: Eyes,
    orientation: Orientation,
    axes: [(i64, i64); 2],
}

/// Beyond so many render areas from its corner nothing is told apart.
const FAR: f32 = 64.0;

impl Place {
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

    /// The texels of which all pixels within the render area lie in the part.
    fn inner(&self, axis: usize, image: &RateImage) -> Span {
        let (first, end) = self.axes[axis];
        let texel = i64::from(image.texel[axis]);
        let (area, area_end) = area(image, axis);
        let from = if first <= area { area.div_euclid(texel) } else { -(-first).div_euclid(texel) };
        let to = if end >= area_end { -(-area_end).div_euclid(texel) } else { end.div_euclid(texel) };
        Span::within(from, to, image.tiles[axis])
    }
}

/// First pixel and end of the render area on an axis.
fn area(image: &RateImage, axis: usize) -> (i64, i64) {
    let first = i64::from(image.area[axis]);
    (first, first + i64::from(image.area[axis + 2]))
}

/// The plans under the parts of a layer. A plan without tiles limits all texels of its part to 1x1.
struct Limits<'a>(SmallVec<[Limit<'a>; 8]>);

/// A plan under a part.
struct Limit<'a> {
    map: &'a EyeMap,
    place: &'a Place,
    is_flipped: bool,
    columns: Columns,
}

/// How columns of the rate image meet columns of the plan.
#[derive(Clone, Copy)]
enum Columns {
    /// One each, in turn: first and end column, first of the plan.
    Straight(usize, usize, usize),
    /// At most one each.
    Single,
    Several,
}

impl<'a> Limits<'a> {
    /// `spans` becomes the columns that each limit meets.
    fn new(eyes: [&'a EyeMap; 2], places: &'a Places, image: &RateImage, spans: &mut Vec<Span>) -> Self {
        spans.clear();
        let mut limits = SmallVec::new();
        for place in places {
            for map in maps(eyes, place.eyes) {
                let begin = spans.len();
                let met = |column| span::met(map, place, image, 0, column, false);
                spans.extend((0..image.tiles[0]).map(met));
                let own = &spans[begin..];
                let columns = match straight(own) {
                    Some((from, to, first)) => Columns::Straight(from, to, first),
                    None if own.iter().all(|span| span.range().len() <= 1) => Columns::Single,
                    None => Columns::Several,
                };
                let limit = |is_flipped| Limit { map, place, is_flipped, columns };
                if place.orientation != Orientation::UpsideDown {
                    limits.push(limit(false));
                }
                if place.orientation != Orientation::Upright {
                    if place.orientation == Orientation::Unknown {
                        spans.extend_from_within(begin..);
                    }
                    limits.push(limit(true));
                }
            }
        }
        Self(limits)
    }

    /// The key of a row; `None` for a row that a part covers partly, as keys do not tell such rows apart.
    fn row_key(&self, places: &Places, image: &RateImage, row: u32) -> Option<RowKey> {
        let covers = places.iter().map(|place| place.covers_row(image, row)).collect::<Option<_>>()?;
        let met = self.0.iter().map(|limit| limit.rows(image, row)).collect();
        Some(RowKey { met, covers })
    }

    /// As [`Self::apply`], in rates of the device, for a single limit with tiles at least as large as texels: tiles become rates
    /// before they are spread over texels. Returns false, and does nothing, for other limits.
    fn apply_only(
        &self,
        image: &RateImage,
        row: u32,
        spans: &[Span],
        rates: &DeviceRates,
        finest_of: &mut Vec<u8>,
        texels: &mut [u8],
    ) -> bool {
        let [limit @ Limit { columns: Columns::Single, .. }] = &self.0[..] else { return false };
        let rows = limit.rows(image, row);
        if rows.is_empty() {
            return false;
        }
        finest_row(limit.map, rows, finest_of);
        finest_of.iter_mut().for_each(|tile| *tile = rates.of_unary(*tile));
        let beside = rates.of_unary(COARSEST);
        for (texel, span) in texels.iter_mut().zip(spans) {
            *texel = if span.is_empty() { beside } else { finest_of[span.range().start] };
        }
        true
    }

    /// Limits the texels of a row to the finest tile under each.
    fn apply(&self, image: &RateImage, row: u32, spans: &[Span], finest_of: &mut Vec<u8>, texels: &mut [u8]) {
        let width = image.tiles[0] as usize;
        for (limit, spans) in self.0.iter().zip(spans.chunks_exact(width)) {
            let rows = limit.rows(image, row);
            if rows.is_empty() {
                continue;
            }
            finest_row(limit.map, rows, finest_of);
            match limit.columns {
                Columns::Straight(from, to, first) => {
                    for (texel, rate) in texels[from..to].iter_mut().zip(&finest_of[first..]) {
                        *texel &= rate;
                    }
                }
                Columns::Single => {
                    for (texel, span) in texels.iter_mut().zip(spans) {
                        *texel &= if span.is_empty() { COARSEST } else { finest_of[span.range().start] };
                    }
                }
                Columns::Several => {
                    for (texel, span) in texels.iter_mut().zip(spans).filter(|(_, span)| !span.is_empty()) {
                        *texel &= finest(&finest_of[span.range()]);
                    }
                }
            }
        }
    }
}

impl Limit<'_> {
    fn rows(&self, image: &RateImage, row: u32) -> Span {
        span::met(self.map, self.place, image, 1, row, self.is_flipped)
    }
}

/// The finest of some unary rates; mostly there are one or two.
fn finest(rates: &[u8]) -> u8 {
    match rates {
        [one] => *one,
        [one, other] => one & other,
        _ => rates.iter().fold(COARSEST, |finest, rate| finest & rate),
    }
}

/// Where each column meets one column of the plan, and they follow each other: first and end column, first of the plan.
fn straight(columns: &[Span]) -> Option<(usize, usize, usize)> {
    let from = columns.iter().position(|span| !span.is_empty())?;
    let to = columns.iter().rposition(|span| !span.is_empty())? + 1;
    let first = columns[from].range().start;
    let in_turn =
        (first..).zip(&columns[from..to]).all(|(column, span)| span.range() == (column..column + 1));
    in_turn.then_some((from, to, first))
}

fn finest_row(map: &EyeMap, rows: Span, out: &mut Vec<u8>) {
    out.clear();
    let mut rows = rows.range().map(|row| map.unary_row(row));
    out.extend_from_slice(rows.next().unwrap_or_default());
    for row in rows {
        for (finest, rate) in out.iter_mut().zip(row) {
            *finest &= rate;
        }
    }
}

/// Makes texels of a row 1x1 that have a pixel of the render area in no part or lie outside of it. 1x1 is [`FULL`], in unary and as a rate.
fn uncover(places: &Places, image: &RateImage, row: u32, texels: &mut [u8]) {
    let inner = |place: &Place| [place.inner(0, image), place.inner(1, image)];
    let inner: SmallVec<[[Span; 2]; 8]> = places.iter().map(inner).collect();
    let mut column = 0;
    while column < texels.len() {
        // Whole runs of texels within one part are by far the most.
        let run = inner.iter().find_map(|[columns, rows]| {
            (rows.contains(row) && columns.range().contains(&column)).then_some(columns.range().end)
        });
        if run.is_none() && !is_covered(places, image, [column as u32, row]) {
            texels[column] = FULL;
        }
        column = run.unwrap_or(column + 1);
    }
}

/// Whether some pixel of a texel is in the render area, and each of those is in a part.
fn is_covered(places: &[Place], image: &RateImage, tile: [u32; 2]) -> bool {
    let pixels = [0, 1].map(|axis| {
        let first = i64::from(tile[axis]) * i64::from(image.texel[axis]);
        let (area, area_end) = area(image, axis);
        (first.max(area), (first + i64::from(image.texel[axis])).min(area_end))
    });
    pixels.iter().all(|(first, end)| first < end) && are_covered(places, pixels)
}

/// Whether all of some pixels are in a part: those that the first part leaves, at most four rectangles, in the others.
fn are_covered(places: &[Place], [x, y]: [(i64, i64); 2]) -> bool {
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
