//! The limits of a layer's texels: no texel is coarser than the finest tile under it.

use super::span::{self, Span};
use super::{COARSEST, DeviceRates, EyeMap, Place, Places, RateImage, RowKey, maps};
use crate::scene::Orientation;
use smallvec::SmallVec;

/// The plans under the parts of a layer. A plan without tiles limits all texels of its part to 1x1.
pub(super) struct Limits<'a>(SmallVec<[Limit<'a>; 8]>);

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
    pub(super) fn new(
        eyes: [&'a EyeMap; 2],
        places: &'a Places,
        image: &RateImage,
        spans: &mut Vec<Span>,
    ) -> Self {
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
    pub(super) fn row_key(&self, places: &Places, image: &RateImage, row: u32) -> Option<RowKey> {
        let covers = places.iter().map(|place| place.covers_row(image, row)).collect::<Option<_>>()?;
        let met = self.0.iter().map(|limit| limit.rows(image, row)).collect();
        Some(RowKey { met, covers })
    }

    /// As [`Self::apply`], in rates of the device, for a single limit with tiles at least as large as texels: tiles become rates
    /// before they are spread over texels. Returns false, and does nothing, for other limits.
    pub(super) fn apply_only(
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
    pub(super) fn apply(
        &self,
        image: &RateImage,
        row: u32,
        spans: &[Span],
        finest_of: &mut Vec<u8>,
        texels: &mut [u8],
    ) {
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
