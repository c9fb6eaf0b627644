//! Tiles, sorted by what drawing them takes.

use super::places::{Has, TilePlaces};
use super::rects::{Edge, TileRects};
use super::{MAX_AGES, Reuse};

/// The tiles of a picture in lists. Memory is only asked for beyond the longest lists so far.
#[derive(Clone, Debug, Default)]
pub struct TileLists {
    /// Tiles that are shown as they are in the newest picture: they were rendered, or no earlier picture has all of them.
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
    places: TilePlaces,
    neighbours: Neighbours,
    /// Ages whose lists have been filled since [`Self::clear`].
    ages: usize,
}

impl TileLists {
    /// Sorts the tiles of the newest picture. Those beside stale ones are blended up to `border` pixels away from them.
    ///
    /// A stale tile is taken from the newest picture that has all of it: of a part that a newer one has only where it would
    /// else be older than `oldest`, since one picture for all of a tile is much cheaper.
    pub fn update(&mut self, reuse: &Reuse, border: f32, oldest: usize) {
        self.clear();
        self.places.begin(reuse);
        let [columns, rows] = reuse.now().stale.tiles();
        for row in 0..rows {
            self.neighbours.set_row(reuse, row);
            let mut column = 0;
            while column < columns {
                let (kind, count) = self.neighbours.run(column);
                match kind {
                    Kind::Fresh => self.fresh.push_run([column, row], count),
                    Kind::BesideStale => {
                        self.fresh.push_run([column, row], count);
                        if border > 0.0 {
                            (column..column + count)
                                .for_each(|column| self.add_borders(reuse, [column, row], border));
                        }
                    }
                    Kind::Stale => (column..column + count)
                        .for_each(|column| self.add_stale(reuse, [column, row], oldest)),
                }
                column += count;
            }
            self.each(TileRects::end_row);
        }
    }

    /// Nothing is in any list.
    pub fn clear(&mut self) {
        self.each(TileRects::clear);
        self.ages = 0;
    }

    fn each(&mut self, act: impl FnMut(&mut TileRects)) {
        let ages = self.ages;
        let of_ages = self.whole[..ages].iter_mut().chain(&mut self.mixed[..ages]);
        let of_ages = of_ages.chain(self.border[..ages].as_flattened_mut());
        std::iter::once(&mut self.fresh).chain(of_ages).for_each(act);
    }

    /// How many words all lists have.
    pub fn words(&self) -> usize {
        let of_ages = self.whole.iter().chain(&self.mixed).chain(self.border.as_flattened());
        std::iter::once(&self.fresh).chain(of_ages).map(|list| list.words().len()).sum()
    }

    fn add_stale(&mut self, reuse: &Reuse, tile: [u32; 2], oldest: usize) {
        let mut has = [Has::Nothing; MAX_AGES];
        let mut all = None;
        for (index, earlier) in reuse.earlier().enumerate() {
            has[index] = self.places.tile_in(reuse, index, earlier, tile);
            if has[index] == Has::All {
                all = Some(index);
                break;
            }
        }
        match all.filter(|index| !reuse.has_moved_since(index + 1)) {
            Some(index) => {
                self.ages = self.ages.max(index + 1);
                self.whole[index].push(tile, None);
            }
            None => self.fresh.push(tile, None),
        }
        let takes_parts = all.is_none_or(|index| index >= oldest || reuse.has_moved_since(index + 1));
        if !takes_parts {
            return;
        }
        for (index, has) in has.into_iter().enumerate() {
            if has == Has::Part || (has == Has::All && reuse.has_moved_since(index + 1)) {
                self.ages = self.ages.max(index + 1);
                self.mixed[index].push(tile, None);
            }
        }
    }

    /// Adds the edges of a fresh tile that are borders, as [`Reuse::is_border`] says.
    fn add_borders(&mut self, reuse: &Reuse, tile: [u32; 2], border: f32) {
        let edges = self.neighbours.edges(tile[0]);
        let mut has_tile = [None; MAX_AGES];
        for (kind, edge) in Edge::ALL.into_iter().enumerate().filter(|(kind, _)| edges >> kind & 1 == 1) {
            for (index, earlier) in reuse.earlier().enumerate() {
                let has =
                    *has_tile[index].get_or_insert_with(|| self.places.tile_in(reuse, index, earlier, tile));
                let has_edge = || earlier.has_rect(&reuse.edge(tile, edge, border)) == Has::All;
                // A picture that has all of the tile has all of its edge, and one that has nothing of it nothing.
                if has == Has::All || (has == Has::Part && has_edge()) {
                    self.ages = self.ages.max(index + 1);
                    self.border[index][kind].push(tile, Some(edge));
                    break;
                }
            }
        }
    }
}

/// A tile, by itself and the eight around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Fresh,
    BesideStale,
    Stale,
}

/// Which tiles of three rows are stale, a byte each, with one more on either side.
#[derive(Clone, Debug, Default)]
struct Neighbours {
    rows: [Vec<u8>; 3],
    /// Whether any tile of a column is stale in one of the three rows.
    columns: Vec<u8>,
    /// Of each tile of the middle row: bit 0, whether it or a neighbour is stale; bit 1, whether it is.
    kinds: Vec<u8>,
}

impl Neighbours {
    /// Goes on to a row of the newest picture; rows are taken in their order, from the first on.
    fn set_row(&mut self, reuse: &Reuse, row: u32) {
        let stale = reuse.now().stale;
        if row == 0 {
            let [above, here, below] = &mut self.rows;
            above.clear();
            above.resize(stale.tiles()[0] as usize + 2, 0);
            stale.unpack_row(0, here);
            stale.unpack_row(1, below);
        } else {
            self.rows.rotate_left(1);
            stale.unpack_row(row + 1, &mut self.rows[2]);
        }
        let [above, here, below] = &self.rows;
        self.columns.clear();
        self.columns
            .extend(above.iter().zip(here).zip(below).map(|((above, here), below)| above | here | below));
        let (columns, here) = (&self.columns[..], &here[1..]);
        let of_three = columns.iter().zip(&columns[1..]).zip(&columns[2..]);
        self.kinds.clear();
        self.kinds
            .extend(of_three.zip(here).map(|(((left, own), right), here)| left | own | right | here << 1));
    }

    /// The kind of a column's tile, and the length of the run of that kind from there on.
    fn run(&self, column: u32) -> (Kind, u32) {
        let kinds = &self.kinds[column as usize..];
        let first = kinds.first().copied().unwrap_or_default();
        let count = kinds.iter().take_while(|kind| **kind == first).count() as u32;
        let kind = match first {
            0 => Kind::Fresh,
            1 => Kind::BesideStale,
            _ => Kind::Stale,
        };
        (kind, count.max(1))
    }

    /// The edges and corners of a fresh tile that are borders, a bit for each of [`Edge::ALL`].
    fn edges(&self, column: u32) -> u8 {
        let place = column as usize;
        let [above, here, below] = self.rows.each_ref().map(|row| &row[place..place + 3]);
        let (up, down, left, right) = (above[1], below[1], here[0], here[2]);
        let corner = |corner: u8, beside: u8, along: u8| corner & !(beside | along);
        let corners = [
            corner(above[0], up, left),
            corner(above[2], up, right),
            corner(below[0], down, left),
            corner(below[2], down, right),
        ];
        let sides = [up, down, left, right].into_iter().chain(corners);
        (0..).zip(sides).fold(0, |edges, (kind, is_border)| edges | is_border << kind)
    }
}
