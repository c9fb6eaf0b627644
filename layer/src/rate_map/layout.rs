//! Layout of the tiles of plans under the texels of a layer. It takes many divisions, and changes only with the sizes of pictures and
//! passes, so it is kept from frame to frame.

use super::rates::FULL;
use super::span::{self, Span};
use super::{COARSEST, DeviceRates, EyeMap, PartRect, PartRects, RateImage, is_covered, maps};
use crate::pass_detection::Orientation;
use smallvec::SmallVec;
use std::ops::Range;
use std::ptr;

/// So many layouts are kept: of two passes that draw both eyes, with two sizes each.
const MOST_LAYOUTS: usize = 8;

/// The layouts that were needed last, the newest first.
#[derive(Clone, Debug, Default)]
pub(super) struct Layouts(Vec<Layout>);

impl Layouts {
    /// That of a layer on which `places` show `eyes`; allocates only where it is not known.
    pub(super) fn of(&mut self, eyes: [&EyeMap; 2], places: &PartRects, image: &RateImage) -> &Layout {
        let shapes = eyes.map(|map| [map.extent(), map.texel(), map.tiles()]);
        let is_same =
            |layout: &Layout| layout.image == *image && layout.shapes == shapes && layout.places == *places;
        match self.0.iter().position(is_same) {
            Some(index) => self.0[..=index].rotate_right(1),
            None => {
                self.0.truncate(MOST_LAYOUTS - 1);
                self.0.insert(0, Layout::new(eyes, shapes, places, image));
            }
        }
        &self.0[0]
    }
}

/// Layout of the tiles of plans under the texels of a layer: no texel is coarser than the finest tile under it.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    image: RateImage,
    places: PartRects,
    /// Of both eyes: size of the picture and of a tile, pixels, and columns and rows of tiles.
    shapes: [[[u32; 2]; 3]; 2],
    limits: SmallVec<[Limit; 4]>,
    rows: Vec<Row>,
    /// Of each row that has its own, the rows of the plan that each limit meets.
    met: Vec<Span>,
    /// Columns of texels with a pixel of the render area that no part covers, or outside of it.
    uncovered: Vec<u32>,
}

/// A plan under a part. One without tiles limits all texels of its part to 1x1.
#[derive(Clone, Debug)]
struct Limit {
    /// 0: left, 1: right.
    eye: usize,
    columns: Columns,
}

/// Columns of the plan that columns of the rate image meet.
#[derive(Clone, Debug)]
enum Columns {
    /// One each, in turn: first and end column, first of the plan.
    Straight(usize, usize, usize),
    /// Number of texels per tile, from the first column on.
    Spread(usize),
    /// At most one each: its index, or [`NONE`].
    Single(Vec<u8>),
    Several(Vec<Span>),
}

/// No column of the plan.
const NONE: u8 = u8::MAX;

/// A row of texels.
#[derive(Clone, Debug)]
enum Row {
    /// It is that above.
    Repeated,
    /// The place of its first span in [`Layout::met`], and its part of [`Layout::uncovered`].
    Own(usize, Range<usize>),
}

/// The key of a row of texels: rows that agree in it are alike.
#[derive(PartialEq, Eq)]
struct RowKey {
    /// For each limit, the rows of the plan that it meets.
    met: SmallVec<[Span; 8]>,
    /// For each part, whether it has all pixels of the row within the render area, or none.
    covers: SmallVec<[bool; 8]>,
}

impl Layout {
    fn new(eyes: [&EyeMap; 2], shapes: [[[u32; 2]; 3]; 2], places: &PartRects, image: &RateImage) -> Self {
        let mut layout = Self {
            image: *image,
            places: places.clone(),
            shapes,
            limits: SmallVec::new(),
            rows: Vec::new(),
            met: Vec::new(),
            uncovered: Vec::new(),
        };
        let mut sources: SmallVec<[(&EyeMap, &PartRect, bool); 8]> = SmallVec::new();
        for place in places {
            for map in maps(eyes, place.eyes) {
                let flips: &[bool] = match place.orientation {
                    Orientation::Upright => &[false],
                    Orientation::UpsideDown => &[true],
                    Orientation::Unknown => &[false, true],
                };
                for is_flipped in flips {
                    sources.push((map, place, *is_flipped));
                    let met = |column| span::met(map, place, image, 0, column, false);
                    let columns = Columns::new((0..image.tiles[0]).map(met).collect());
                    layout.limits.push(Limit { eye: usize::from(!ptr::eq(map, eyes[0])), columns });
                }
            }
        }
        let mut last: Option<RowKey> = None;
        for row in 0..image.tiles[1] {
            let met: SmallVec<[Span; 8]> = sources
                .iter()
                .map(|(map, place, is_flipped)| span::met(map, place, image, 1, row, *is_flipped))
                .collect();
            // None for a row that a part covers partly, as keys do not distinguish such rows.
            let covers = places.iter().map(|place| place.covers_row(image, row)).collect::<Option<_>>();
            let key = covers.map(|covers| RowKey { met: met.clone(), covers });
            if key.is_some() && key == last {
                layout.rows.push(Row::Repeated);
                continue;
            }
            last = key;
            let begin = layout.uncovered.len();
            let columns = 0..image.tiles[0];
            layout.uncovered.extend(columns.filter(|column| !is_covered(places, image, [*column, row])));
            layout.rows.push(Row::Own(layout.met.len(), begin..layout.uncovered.len()));
            layout.met.extend(met);
        }
        layout
    }

    /// Writes the texels of the layer, row by row: [`parafovea_core::rate::ShadingRate::texel`], with
    /// [`parafovea_core::reuse::STALE`].
    pub(super) fn fill(
        &self,
        eyes: [&EyeMap; 2],
        rates: &DeviceRates,
        finest_of: &mut Vec<u8>,
        texels: &mut [u8],
    ) {
        let width = self.image.tiles[0] as usize;
        for (index, row) in self.rows.iter().enumerate() {
            let begin = index * width;
            let Row::Own(met, uncovered) = row else {
                texels.copy_within(begin - width..begin, begin);
                continue;
            };
            let texels = &mut texels[begin..begin + width];
            let met = &self.met[*met..*met + self.limits.len()];
            if !self.spread_row(eyes, met, rates, texels)
                && !self.fill_from_one(eyes, met, rates, finest_of, texels)
            {
                texels.fill(COARSEST);
                self.limit(eyes, met, finest_of, texels);
                texels.iter_mut().for_each(|texel| *texel = rates.of_unary(*texel));
            }
            // 1x1 is FULL, in unary and as a rate.
            self.uncovered[uncovered.clone()].iter().for_each(|column| texels[*column as usize] = FULL);
        }
    }

    /// Writes a row of texels from one row of a single plan, each tile to several texels, on devices with all rates of the plan. Returns
    /// false, and does nothing, for other rows.
    fn spread_row(&self, eyes: [&EyeMap; 2], met: &[Span], rates: &DeviceRates, texels: &mut [u8]) -> bool {
        let ([Limit { eye, columns: Columns::Spread(times) }], [rows]) = (&self.limits[..], met) else {
            return false;
        };
        let (map, rows) = (eyes[*eye], rows.range());
        if rows.len() != 1 || !rates.has_all(map.used()) {
            return false;
        }
        let Some(tiles) = map.row(rows.start) else { return false };
        spread_over(texels, *times, tiles);
        true
    }

    /// Writes a row of texels that has a single limit, with tiles at least as large as texels: tiles become rates before they are spread
    /// over texels. Returns false, and does nothing, for other rows.
    fn fill_from_one(
        &self,
        eyes: [&EyeMap; 2],
        met: &[Span],
        rates: &DeviceRates,
        finest_of: &mut Vec<u8>,
        texels: &mut [u8],
    ) -> bool {
        let ([Limit { eye, columns }], [rows]) = (&self.limits[..], met) else { return false };
        let (Columns::Single(_) | Columns::Spread(_)) = columns else { return false };
        if rows.is_empty() {
            return false;
        }
        finest_row(eyes[*eye], *rows, finest_of);
        let mut of_column = [rates.of_unary(COARSEST); NONE as usize + 1];
        for (rate, tile) in of_column[..usize::from(NONE)].iter_mut().zip(&*finest_of) {
            *rate = rates.of_unary(*tile);
        }
        match columns {
            Columns::Single(columns) => {
                for (texel, column) in texels.iter_mut().zip(columns) {
                    *texel = of_column[usize::from(*column)];
                }
            }
            // The plan may have more columns than the texels meet.
            Columns::Spread(times) => {
                spread_over(texels, *times, &of_column[..finest_of.len().min(usize::from(NONE))])
            }
            Columns::Straight(..) | Columns::Several(_) => {}
        }
        true
    }

    /// Limits the texels of a row to the finest tile under each.
    fn limit(&self, eyes: [&EyeMap; 2], met: &[Span], finest_of: &mut Vec<u8>, texels: &mut [u8]) {
        for (Limit { eye, columns }, rows) in self.limits.iter().zip(met) {
            if rows.is_empty() {
                continue;
            }
            finest_row(eyes[*eye], *rows, finest_of);
            match columns {
                Columns::Straight(from, to, first) => {
                    for (texel, rate) in texels[*from..*to].iter_mut().zip(&finest_of[*first..]) {
                        *texel &= rate;
                    }
                }
                Columns::Spread(times) => {
                    for (texels, rate) in texels.chunks_mut(*times).zip(&*finest_of) {
                        texels.iter_mut().for_each(|texel| *texel &= rate);
                    }
                }
                Columns::Single(columns) => {
                    for (texel, column) in
                        texels.iter_mut().zip(columns).filter(|(_, column)| **column != NONE)
                    {
                        *texel &= finest_of[usize::from(*column)];
                    }
                }
                Columns::Several(spans) => {
                    for (texel, span) in texels.iter_mut().zip(spans).filter(|(_, span)| !span.is_empty()) {
                        *texel &= finest(&finest_of[span.range()]);
                    }
                }
            }
        }
    }
}

impl Columns {
    fn new(met: Vec<Span>) -> Self {
        if let Some((from, to, first)) = straight(&met) {
            return Self::Straight(from, to, first);
        }
        let single = |span: &Span| match span.range() {
            range if range.is_empty() => Some(NONE),
            range => u8::try_from(range.start).ok().filter(|first| *first != NONE && range.len() == 1),
        };
        match met.iter().map(single).collect::<Option<Vec<_>>>() {
            None => Self::Several(met),
            Some(columns) => texels_per_tile(&columns).map_or(Self::Single(columns), Self::Spread),
        }
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

/// First and end column, and first of the plan; `None` unless each column meets one column of the plan, and they follow each other.
fn straight(columns: &[Span]) -> Option<(usize, usize, usize)> {
    let from = columns.iter().position(|span| !span.is_empty())?;
    let to = columns.iter().rposition(|span| !span.is_empty())? + 1;
    let first = columns[from].range().start;
    let in_turn =
        (first..).zip(&columns[from..to]).all(|(column, span)| span.range() == (column..column + 1));
    in_turn.then_some((from, to, first))
}

/// Columns of texels per column of the plan (fewer for the last one); `None` for other arrangements.
fn texels_per_tile(columns: &[u8]) -> Option<usize> {
    let times = columns.iter().take_while(|column| **column == 0).count();
    let is_spread = |(index, column): (usize, &u8)| index / times == usize::from(*column);
    (times > 0 && columns.iter().enumerate().all(is_spread)).then_some(times)
}

/// Writes each tile's rate to so many texels; the last tile may have fewer.
fn spread_over(texels: &mut [u8], times: usize, tiles: &[u8]) {
    match times {
        2 => spread_over_each::<2>(texels, tiles),
        4 => spread_over_each::<4>(texels, tiles),
        times => texels.chunks_mut(times).zip(tiles).for_each(|(texels, tile)| texels.fill(*tile)),
    }
}

/// [`spread_over`] for common numbers, compiled to plain stores.
fn spread_over_each<const TIMES: usize>(texels: &mut [u8], tiles: &[u8]) {
    let whole = texels.len() / TIMES;
    let mut each = texels.chunks_exact_mut(TIMES);
    for (texels, tile) in each.by_ref().zip(tiles) {
        texels.copy_from_slice(&[*tile; TIMES]);
    }
    // The plan may have more columns than the texels show.
    if let Some(tile) = tiles.get(whole).or(tiles.last()) {
        each.into_remainder().fill(*tile);
    }
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
