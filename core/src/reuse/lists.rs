//! Tiles, sorted by what drawing them takes.

use super::history::Earlier;
use super::rects::{Edge, TileRects};
use super::{MAX_AGES, Reuse};
use crate::geometry::PixelRect;
use glam::{Mat3, Vec2};

/// Pixels around a tile that its re-used pixels may be interpolated from, with room for rounding.
const MARGIN: f32 = 1.0;

/// The tiles of a picture in lists. Memory is only asked for beyond the longest lists so far.
#[derive(Clone, Debug, Default)]
pub struct TileLists {
    /// Those that are shown as they are in the newest picture: they were rendered, or no earlier picture has all of them.
    pub fresh: TileRects,
    /// For each age, from 1 on: stale tiles all of which is taken from the picture of that age, and from nothing of it that was
    /// not rendered there. Each stale tile is in one of these, or in [`Self::fresh`]. None where the head has moved, by
    /// [`Reuse::has_moved_since`]: of what was hidden there is nothing to take.
    pub whole: [TileRects; MAX_AGES],
    /// Stale tiles of which a part is taken from the picture of that age, if that has it: to be drawn over the others, the
    /// oldest first.
    pub mixed: [TileRects; MAX_AGES],
    /// Edges of fresh tiles beside stale ones that are blended with the picture of that age, by place in [`Edge::ALL`].
    pub border: [[TileRects; Edge::ALL.len()]; MAX_AGES],
    /// The corners of all tiles in each earlier picture, row by row; NaN where it does not show them.
    corners: [Vec<Vec2>; MAX_AGES],
    /// The same of what is as near as can be, where the head has moved; else none.
    near_corners: [Vec<Vec2>; MAX_AGES],
}

/// How much of a tile a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Has {
    Nothing,
    Part,
    All,
}

impl TileLists {
    /// Sorts the tiles of the newest picture. Those beside stale ones are blended up to `border` pixels away from them.
    ///
    /// A stale tile is taken from the newest picture that has all of it: of a part that a newer one has only where it would
    /// else be older than `oldest`, since one picture for all of a tile is much cheaper.
    pub fn update(&mut self, reuse: &Reuse, border: f32, oldest: usize) {
        self.clear();
        let now = reuse.now();
        let [columns, rows] = now.stale.tiles();
        let of_ages = self.corners.iter_mut().zip(&mut self.near_corners);
        for ((corners, near_corners), earlier) in of_ages.zip(reuse.earlier()) {
            fill_corners(corners, reuse, &earlier.matrix);
            match earlier.near_matrix() {
                Some(matrix) => fill_corners(near_corners, reuse, &matrix),
                None => near_corners.clear(),
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let tile = [column, row];
                if now.stale.is_stale(tile) {
                    self.add_stale(reuse, tile, oldest);
                } else {
                    self.fresh.push(tile, None);
                    if border > 0.0 {
                        self.add_borders(reuse, tile, border);
                    }
                }
            }
            self.each(TileRects::end_row);
        }
    }

    /// Nothing is in any list.
    pub fn clear(&mut self) {
        self.each(TileRects::clear);
    }

    fn each(&mut self, act: impl FnMut(&mut TileRects)) {
        let of_ages = self.whole.iter_mut().chain(&mut self.mixed).chain(self.border.as_flattened_mut());
        std::iter::once(&mut self.fresh).chain(of_ages).for_each(act);
    }

    /// How many words all lists have.
    pub fn words(&self) -> usize {
        let of_ages = self.whole.iter().chain(&self.mixed).chain(self.border.as_flattened());
        std::iter::once(&self.fresh).chain(of_ages).map(|list| list.words().len()).sum()
    }

    fn add_stale(&mut self, reuse: &Reuse, tile: [u32; 2], oldest: usize) {
        let mut has = [Has::Nothing; MAX_AGES];
        let corners = self.corners.iter().zip(&self.near_corners);
        for ((has, earlier), corners) in has.iter_mut().zip(reuse.earlier()).zip(corners) {
            *has = tile_in(earlier, corners, reuse, tile);
            if *has == Has::All {
                break;
            }
        }
        let all = has.iter().position(|has| *has == Has::All);
        match all.filter(|index| !reuse.has_moved_since(index + 1)) {
            Some(index) => self.whole[index].push(tile, None),
            None => self.fresh.push(tile, None),
        }
        let takes_parts = all.is_none_or(|index| index >= oldest || reuse.has_moved_since(index + 1));
        for (index, (mixed, has)) in self.mixed.iter_mut().zip(has).enumerate() {
            let is_part = has == Has::Part || (has == Has::All && reuse.has_moved_since(index + 1));
            if takes_parts && is_part {
                mixed.push(tile, None);
            }
        }
    }

    fn add_borders(&mut self, reuse: &Reuse, tile: [u32; 2], border: f32) {
        for (kind, edge) in Edge::ALL.into_iter().enumerate() {
            if reuse.is_border(tile, edge) {
                let rect = reuse.edge(tile, edge, border);
                let whole =
                    reuse.earlier().position(|earlier| has(earlier, corners_in(earlier, &rect)) == Has::All);
                if let Some(index) = whole {
                    self.border[index][kind].push(tile, Some(edge));
                }
            }
        }
    }
}

/// Takes the corners of all tiles to where a matrix leads.
fn fill_corners(corners: &mut Vec<Vec2>, reuse: &Reuse, matrix: &Mat3) {
    let now = reuse.now();
    let size = 1.0 / now.tiles_per_pixel();
    let [columns, rows] = now.stale.tiles();
    corners.clear();
    for row in 0..=rows {
        let y = (row as f32 * size.y).min(now.size().y);
        let start = matrix.y_axis * y + matrix.z_axis;
        corners.extend((0..=columns).map(|column| {
            let found = matrix.x_axis * (column as f32 * size.x).min(now.size().x) + start;
            if found.z > 0.0 { found.truncate() / found.z } else { Vec2::NAN }
        }));
    }
}

/// What an earlier picture has of a tile, by the corners of all tiles there, far and near.
fn tile_in(
    earlier: &Earlier,
    (far, near): (&Vec<Vec2>, &Vec<Vec2>),
    reuse: &Reuse,
    [column, row]: [u32; 2],
) -> Has {
    let line = reuse.now().stale.tiles()[0] as usize + 1;
    let first = row as usize * line + column as usize;
    let of_tile = [first, first + 1, first + line, first + line + 1];
    if near.is_empty() {
        return has(earlier, of_tile.map(|index| far[index]).into_iter());
    }
    has(earlier, of_tile.into_iter().flat_map(|index| [far[index], near[index]]))
}

/// What an earlier picture has of a rectangle with these corners there, NaN where it does not show them.
pub(super) fn has(earlier: &Earlier, corners: impl Iterator<Item = Vec2>) -> Has {
    let picture = &earlier.picture;
    let is_still = earlier.is_still();
    let margin = if is_still { 0.0 } else { MARGIN };
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for corner in corners {
        if corner.is_nan() {
            // Partly beside what the picture can show.
            return Has::Part;
        }
        (low, high) = (low.min(corner), high.max(corner));
    }
    (low, high) = (low - margin, high + margin);
    if high.cmple(Vec2::ZERO).any() || low.cmpge(picture.size()).any() {
        return Has::Nothing;
    }
    let is_inside = low.cmpge(Vec2::ZERO).all() && high.cmple(picture.size()).all();
    let first = picture.tile_at(low);
    // What ends where a tile begins does not reach into it.
    let last = picture.tile_at(high - if is_still { 0.5 } else { 0.0 });
    let (mut fresh, mut stale) = (false, false);
    for row in first[1]..=last[1] {
        for column in first[0]..=last[0] {
            let is_stale = picture.stale.is_stale([column, row]);
            fresh |= !is_stale;
            stale |= is_stale;
        }
    }
    match (fresh, stale) {
        (false, _) => Has::Nothing,
        (true, false) if is_inside => Has::All,
        (true, _) => Has::Part,
    }
}

/// The corners of a rectangle in an earlier picture, far and, where the head has moved, near; NaN where that does not show them.
pub(super) fn corners_in(earlier: &Earlier, rect: &PixelRect) -> impl Iterator<Item = Vec2> + use<> {
    let PixelRect { min, max } = *rect;
    let corners = [min, Vec2::new(max.x, min.y), Vec2::new(min.x, max.y), max];
    let matrices = std::iter::once(earlier.matrix).chain(earlier.near_matrix());
    matrices.flat_map(move |matrix| {
        corners.map(|corner| {
            let found = matrix * corner.extend(1.0);
            if found.z > 0.0 { found.truncate() / found.z } else { Vec2::NAN }
        })
    })
}
