//! Tiles, sorted by the kind of draw that they need.

use super::history::Earlier;
use super::places::{Found, TilePlaces};
use super::rects::{Edge, TileRects};
use super::{MAX_AGES, Reuse, bits};

/// The tiles of a picture in lists. Memory is only asked for beyond the longest lists so far.
#[derive(Clone, Debug, Default)]
pub struct TileLists {
    /// Tiles that are shown as they are in the newest picture: they were rendered, or no earlier picture has all of them.
    pub fresh: TileRects,
    /// For each age, from 1 on: stale tiles that are taken entirely from rendered parts of the picture of that age. Each stale
    /// tile is in one of these, or in [`Self::fresh`]. Empty if the head has moved, by [`Reuse::has_moved_since`]: the picture
    /// lacks content that was occluded then.
    pub full: [TileRects; MAX_AGES],
    /// Stale tiles of which a part is taken from the picture of that age, if that has it: to be drawn over the others, the
    /// oldest first.
    pub partial: [TileRects; MAX_AGES],
    /// Edges of fresh tiles beside stale ones that are blended with the picture of that age, by place in [`Edge::ALL`].
    pub seam: [[TileRects; Edge::ALL.len()]; MAX_AGES],
    places: TilePlaces,
    row: Row,
    touched: TouchedLists,
}

/// Lists that need work, so that empty ones cost nothing.
#[derive(Clone, Copy, Debug, Default)]
struct TouchedLists {
    /// Not empty.
    filled: ListSet,
    /// With tiles in the row that is being sorted, or in the one before.
    open: ListSet,
}

impl TouchedLists {
    fn insert(&mut self, list: List) {
        self.filled.insert(list);
        self.open.insert(list);
    }
}

/// One of the lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum List {
    Fresh,
    /// By place of the earlier picture.
    Full(usize),
    Partial(usize),
    /// By place of the earlier picture and of the edge in [`Edge::ALL`].
    Seam(usize, usize),
}

impl List {
    /// Number of lists of one age.
    const OF_AGE: usize = 2 + Edge::ALL.len();

    fn index(self) -> usize {
        match self {
            Self::Fresh => 0,
            Self::Full(age) => 1 + age * Self::OF_AGE,
            Self::Partial(age) => 2 + age * Self::OF_AGE,
            Self::Seam(age, edge) => 3 + age * Self::OF_AGE + edge,
        }
    }

    fn of_index(index: usize) -> Self {
        let Some(index) = index.checked_sub(1) else { return Self::Fresh };
        let age = index / Self::OF_AGE;
        match index % Self::OF_AGE {
            0 => Self::Full(age),
            1 => Self::Partial(age),
            edge => Self::Seam(age, edge - 2),
        }
    }
}

const _: () = assert!(MAX_AGES * List::OF_AGE < u128::BITS as usize);

/// Some lists, a bit for each index.
#[derive(Clone, Copy, Debug, Default)]
struct ListSet(u128);

impl ListSet {
    fn insert(&mut self, list: List) {
        self.0 |= 1 << list.index();
    }

    fn iter(self) -> impl Iterator<Item = List> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let index = left.trailing_zeros();
            // A set that is empty has as many zeros as bits.
            left = left.checked_shr(index).map_or(0, |_| left & left.wrapping_sub(1));
            (index < u128::BITS).then(|| List::of_index(index as usize))
        })
    }
}

/// Sets of tiles of a row, as bits.
#[derive(Clone, Debug, Default)]
struct Row {
    stale: Vec<u64>,
    above: Vec<u64>,
    below: Vec<u64>,
    /// Fresh tiles with a seam that has no earlier image yet, by place in [`Edge::ALL`].
    seams: [Vec<u64>; Edge::ALL.len()],
    /// One bit for each of these, set if it has any tile.
    open_seams: u32,
    /// Stale tiles that no picture so far has all of.
    left: Vec<u64>,
    /// Coverage of those by each earlier image.
    found: [Found; MAX_AGES],
    /// Tiles with an edge in an earlier picture, by place in [`Edge::ALL`].
    found_edges: [Vec<u64>; Edge::ALL.len()],
    /// Tiles for [`TileLists::fresh`].
    fresh: Vec<u64>,
    /// Tiles of which parts are taken.
    parts: Vec<u64>,
    /// Tiles for the list that is being filled.
    listed: Vec<u64>,
}

impl TileLists {
    /// Sorts the tiles of the newest picture. Those beside stale ones are blended up to `border` pixels away from them.
    ///
    /// A stale tile is taken from the newest picture that has all of it: of a part that a newer one has only where it would
    /// else be older than `oldest`, since one picture for all of a tile is much cheaper. Nothing is blended with pictures that are older.
    pub fn update(&mut self, reuse: &Reuse, border: f32, oldest: usize) {
        self.clear();
        self.places.begin(reuse, border);
        for row in 0..reuse.now().stale.tiles()[1] {
            self.row.begin(reuse, row, border > 0.0);
            let mut looked_into = 0;
            for (index, earlier) in reuse.earlier().enumerate() {
                if index < oldest && self.row.open_seams != 0 {
                    self.add_seams(reuse, (index, earlier), row);
                }
                if self.row.left.iter().any(|tiles| *tiles != 0) {
                    looked_into = index + 1;
                    let Row { left, found, .. } = &mut self.row;
                    self.places.find(reuse, (index, earlier), row, left, &mut found[index]);
                    self.add_full(row, index, reuse.has_moved_since(index + 1), index >= oldest);
                } else if self.row.open_seams == 0 {
                    break;
                }
            }
            self.row.add_rest();
            self.touched.insert(List::Fresh);
            push_all(&mut self.fresh, &self.row.fresh, row, None);
            self.add_partial(reuse, row, looked_into);
            self.end_row();
        }
    }

    /// Nothing is in any list.
    pub fn clear(&mut self) {
        for list in std::mem::take(&mut self.touched).filled.iter() {
            self.list(list).clear();
        }
    }

    fn list(&mut self, list: List) -> &mut TileRects {
        match list {
            List::Fresh => &mut self.fresh,
            List::Full(age) => &mut self.full[age],
            List::Partial(age) => &mut self.partial[age],
            List::Seam(age, edge) => &mut self.seam[age][edge],
        }
    }

    fn end_row(&mut self) {
        for list in std::mem::take(&mut self.touched.open).iter() {
            if self.list(list).end_row() {
                self.touched.open.insert(list);
            }
        }
    }

    /// Number of words of all lists.
    pub fn words(&self) -> usize {
        let of_ages = self.full.iter().chain(&self.partial).chain(self.seam.as_flattened());
        std::iter::once(&self.fresh).chain(of_ages).map(|list| list.words().len()).sum()
    }

    /// Adds the stale tiles that the picture at place `index` is the first to have all of; parts of them are taken where it `is_old`.
    fn add_full(&mut self, row: u32, index: usize, has_moved: bool, is_old: bool) {
        let Row { left, found, fresh, parts, listed, .. } = &mut self.row;
        listed.clear();
        for (word, left) in left.iter_mut().enumerate() {
            let whole = *left & found[index].all[word];
            *left &= !whole;
            listed.push(if has_moved { 0 } else { whole });
            fresh[word] |= if has_moved { whole } else { 0 };
            parts[word] |= if has_moved || is_old { whole } else { 0 };
        }
        if listed.iter().any(|tiles| *tiles != 0) {
            self.touched.insert(List::Full(index));
            push_all(&mut self.full[index], listed, row, None);
        }
    }

    /// Adds the edges of fresh tiles that are seams by [`Reuse::is_seam`], and that the picture at place `index` is the first to have.
    fn add_seams(&mut self, reuse: &Reuse, picture: (usize, &Earlier), row: u32) {
        let Row { seams, open_seams, found_edges, .. } = &mut self.row;
        let (index, _) = picture;
        self.places.find_edges(reuse, picture, row, seams, found_edges);
        for (kind, (open, found)) in seams.iter_mut().zip(&*found_edges).enumerate() {
            let mut is_open = false;
            let mut is_found = false;
            for (open, found) in open.iter_mut().zip(found) {
                *open &= !found;
                is_open |= *open != 0;
                is_found |= *found != 0;
            }
            *open_seams &= !(u32::from(!is_open) << kind);
            if is_found {
                self.touched.insert(List::Seam(index, kind));
                push_all(&mut self.seam[index][kind], found, row, Some(Edge::ALL[kind]));
            }
        }
    }

    /// Adds tiles of which parts are taken to the list of each picture that has any, up to the first one that has all.
    fn add_partial(&mut self, reuse: &Reuse, row: u32, looked_into: usize) {
        let Row { parts, found, listed, .. } = &mut self.row;
        for (index, Found { all, any }) in found[..looked_into].iter().enumerate() {
            if parts.iter().all(|tiles| *tiles == 0) {
                return;
            }
            let has_moved = reuse.has_moved_since(index + 1);
            listed.clear();
            for ((parts, all), any) in parts.iter_mut().zip(all).zip(any) {
                listed.push(*parts & any & if has_moved { u64::MAX } else { !all });
                *parts &= !all;
            }
            if listed.iter().any(|tiles| *tiles != 0) {
                self.touched.insert(List::Partial(index));
                push_all(&mut self.partial[index], listed, row, None);
            }
        }
    }
}

fn push_all(list: &mut TileRects, tiles: &[u64], row: u32, edge: Option<Edge>) {
    bits::runs(tiles).for_each(|(column, count)| list.push([column, row], count, edge));
}

impl Row {
    /// Goes on to the first row of the newest picture, or to the one below; nothing was looked for yet.
    fn begin(&mut self, reuse: &Reuse, row: u32, has_seams: bool) {
        let tiles = reuse.now().stale;
        let [columns, _] = tiles.tiles();
        let set = |into: &mut Vec<u64>, row: i32| {
            into.clear();
            let fresh = tiles.fresh_row(row);
            into.extend(
                fresh.iter().enumerate().map(|(word, fresh)| !fresh & bits::range(word, [0, columns])),
            );
            into.resize(bits::words(columns), 0);
        };
        if row == 0 {
            set(&mut self.stale, -1);
            set(&mut self.below, 0);
        }
        let row = row as i32;
        std::mem::swap(&mut self.above, &mut self.stale);
        std::mem::swap(&mut self.stale, &mut self.below);
        set(&mut self.below, row + 1);
        self.left.clone_from(&self.stale);
        self.fresh.clear();
        self.fresh.extend_from_slice(tiles.fresh_row(row));
        for bits in std::iter::once(&mut self.parts).chain(&mut self.seams) {
            bits.clear();
            bits.resize(self.stale.len(), 0);
        }
        self.open_seams = 0;
        if has_seams {
            self.set_seams();
        }
    }

    fn set_seams(&mut self) {
        for word in 0..self.stale.len() {
            let column = (word * bits::WORD) as i32;
            let [above, here, below] = [&self.above, &self.stale, &self.below]
                .map(|row| [-1, 0, 1].map(|across| bits::read(row, column + across)));
            let fresh = self.fresh[word];
            let (up, down, left, right) = (above[1], below[1], here[0], here[2]);
            let corner = |corner: u64, beside: u64, along: u64| corner & !(beside | along);
            let edges = [
                up,
                down,
                left,
                right,
                corner(above[0], up, left),
                corner(above[2], up, right),
                corner(below[0], down, left),
                corner(below[2], down, right),
            ];
            for (kind, (seams, edge)) in self.seams.iter_mut().zip(edges).enumerate() {
                seams[word] = edge & fresh;
                self.open_seams |= u32::from(edge & fresh != 0) << kind;
            }
        }
    }

    /// Shows stale tiles that no picture has all of as they are, under the parts that there are.
    fn add_rest(&mut self) {
        for ((left, fresh), parts) in self.left.iter().zip(&mut self.fresh).zip(&mut self.parts) {
            *fresh |= left;
            *parts |= left;
        }
    }
}
