//! Tiles, sorted by what drawing them takes.

use super::history::{AROUND, Earlier};
use super::{MAX_AGES, Reuse};
use glam::{Mat3, Vec2};

/// Pixels around a tile that its re-used pixels may be interpolated from, with room for rounding.
const MARGIN: f32 = 1.0;

/// The tiles of a picture, counted row by row, in lists. Memory is only asked for beyond the longest lists so far.
#[derive(Clone, Debug, Default)]
pub struct TileLists {
    /// Those that are shown as they are in the newest picture: they were rendered, or no earlier picture has all of them. To
    /// be drawn before the others.
    pub fresh: Vec<u32>,
    /// For each age, from 1 on: stale tiles all of which is taken from the picture of that age, and from nothing of it that was
    /// not rendered there.
    pub whole: [Vec<u32>; MAX_AGES],
    /// Other stale tiles of which a part may be taken from the picture of that age.
    pub mixed: [Vec<u32>; MAX_AGES],
    /// Parts of fresh tiles beside stale ones that can be blended with the picture of that age: the tile, and in bits 30 and 31
    /// which [`Strip`] of it.
    pub border: [Vec<u32>; MAX_AGES],
    /// The corners of all tiles in each earlier picture, row by row; NaN where it does not show them.
    corners: [Vec<Vec2>; MAX_AGES],
}

/// A part of a tile along its edge, as wide as the border: rows from end to end, and columns between those.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Strip {
    /// The upper row.
    Upper = 0,
    /// The lower row.
    Lower = 1,
    /// The left column.
    Left = 2,
    /// The right column.
    Right = 3,
}

impl Strip {
    const ALL: [Self; 4] = [Self::Upper, Self::Lower, Self::Left, Self::Right];

    /// The entry of a tile of that index.
    pub const fn of(self, tile: u32) -> u32 {
        tile | (self as u32) << 30
    }

    /// Which of the tiles around, in the order of [`AROUND`], are near its pixels.
    const fn neighbours(self) -> &'static [usize] {
        match self {
            Self::Upper => &[0, 1, 2, 3, 4],
            Self::Lower => &[3, 4, 5, 6, 7],
            Self::Left => &[3],
            Self::Right => &[4],
        }
    }
}

/// How much of a tile a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Has {
    Nothing,
    Part,
    All,
}

impl TileLists {
    /// Sorts the tiles of the newest picture. Those beside stale ones are blended up to `border` pixels away from them.
    pub fn update(&mut self, reuse: &Reuse, border: f32) {
        self.clear();
        let now = reuse.now();
        let [columns, rows] = now.stale.tiles();
        for (corners, earlier) in self.corners.iter_mut().zip(reuse.earlier()) {
            fill_corners(corners, reuse, &earlier.matrix);
        }
        for row in 0..rows {
            for column in 0..columns {
                let tile = [column, row];
                if now.stale.is_stale(tile) {
                    self.add_stale(reuse, tile);
                } else {
                    self.fresh.push(row * columns + column);
                    if border > 0.0 {
                        self.add_border(reuse, tile, border);
                    }
                }
            }
        }
    }

    /// Nothing is in any list.
    pub fn clear(&mut self) {
        self.fresh.clear();
        for list in self.whole.iter_mut().chain(&mut self.mixed).chain(&mut self.border) {
            list.clear();
        }
    }

    /// How many entries all lists have.
    pub fn len(&self) -> usize {
        let of_ages = self.whole.iter().chain(&self.mixed).chain(&self.border);
        self.fresh.len() + of_ages.map(Vec::len).sum::<usize>()
    }

    /// Whether all lists are empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn add_stale(&mut self, reuse: &Reuse, tile: [u32; 2]) {
        let index = index(reuse, tile);
        let mut is_found = false;
        for (age, earlier) in reuse.earlier().enumerate() {
            match has(earlier, &self.corners[age], reuse, tile) {
                Has::All if !is_found => return self.whole[age].push(index),
                Has::All => return self.mixed[age].push(index),
                Has::Part => {
                    self.mixed[age].push(index);
                    is_found = true;
                }
                Has::Nothing => {}
            }
        }
        self.fresh.push(index);
    }

    fn add_border(&mut self, reuse: &Reuse, tile: [u32; 2], border: f32) {
        let index = index(reuse, tile);
        let stale = stale_neighbours(reuse, tile);
        if stale == [false; 8] {
            return;
        }
        // In small tiles a strip is less than the border away from what is on the other side.
        let is_small = (1.0 / reuse.now().tiles_per_pixel()).min_element() < 2.0 * border;
        let is_near = |strip: &Strip| is_small || strip.neighbours().iter().any(|&beside| stale[beside]);
        for (age, earlier) in reuse.earlier().enumerate() {
            let has = has(earlier, &self.corners[age], reuse, tile);
            if has != Has::Nothing {
                self.border[age]
                    .extend(Strip::ALL.iter().filter(|strip| is_near(strip)).map(|strip| strip.of(index)));
            }
            if has == Has::All {
                return;
            }
        }
    }
}

fn index(reuse: &Reuse, [column, row]: [u32; 2]) -> u32 {
    row * reuse.now().stale.tiles()[0] + column
}

fn stale_neighbours(reuse: &Reuse, [column, row]: [u32; 2]) -> [bool; 8] {
    AROUND.map(|(right, down)| {
        reuse.now().stale.is_stale([column.wrapping_add_signed(right), row.wrapping_add_signed(down)])
    })
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

/// What an earlier picture has of a tile.
fn has(earlier: &Earlier, corners: &[Vec2], reuse: &Reuse, [column, row]: [u32; 2]) -> Has {
    let line = reuse.now().stale.tiles()[0] as usize + 1;
    let first = row as usize * line + column as usize;
    let four = [corners[first], corners[first + 1], corners[first + line], corners[first + line + 1]];
    let picture = &earlier.picture;
    if four.iter().any(|corner| corner.is_nan()) {
        // Partly beside what the picture can show.
        return Has::Part;
    }
    let is_still = earlier.matrix == Mat3::IDENTITY;
    let margin = if is_still { 0.0 } else { MARGIN };
    let low = four.into_iter().fold(Vec2::INFINITY, Vec2::min) - margin;
    let high = four.into_iter().fold(Vec2::NEG_INFINITY, Vec2::max) + margin;
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
