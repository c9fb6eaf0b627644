//! Tiles of an image that are compared with earlier images, to find changing content.

use super::places::{Found, TilePlaces};
use super::{MAX_AGES, Reuse, bits};

/// Tiles that were rendered, by the earlier picture that they are compared with. Memory is only asked for beyond the longest
/// lists so far.
#[derive(Clone, Debug, Default)]
pub struct ComparedTiles {
    by_age: [Vec<u32>; MAX_AGES],
    places: TilePlaces,
    /// Tiles of a row that have no earlier picture yet.
    left: Vec<u64>,
    found: Found,
}

impl ComparedTiles {
    /// Takes the fresh tiles of the newest image that `is_wanted` accepts, each with the oldest image of at most `oldest` images ago in
    /// which all of it was rendered: its content without the update. So changing content, rendered in each frame, is judged like content that
    /// is rendered seldom.
    pub fn update(&mut self, reuse: &Reuse, oldest: usize, is_wanted: impl Fn([u32; 2]) -> bool) {
        self.clear();
        self.places.begin(reuse, 0.0);
        let stale = reuse.now().stale;
        let ages = reuse.ages().min(oldest);
        for row in 0..stale.tiles()[1] {
            self.left.clear();
            self.left.extend_from_slice(stale.fresh_row(row as i32));
            for index in (0..ages).rev() {
                let Some(earlier) = reuse.at_age(index + 1) else { continue };
                if self.left.iter().all(|left| *left == 0) {
                    break;
                }
                self.places.find(reuse, (index, earlier), row, &self.left, &mut self.found);
                let wanted = bits::columns(&self.found.all).filter(|column| is_wanted([*column, row]));
                self.by_age[index].extend(wanted.map(|column| column | row << 16));
                for (left, all) in self.left.iter_mut().zip(&self.found.all) {
                    *left &= !all;
                }
            }
        }
    }

    /// Nothing is compared.
    pub fn clear(&mut self) {
        self.by_age.iter_mut().for_each(Vec::clear);
    }

    /// Tiles that are compared with the image of an age, 1..=[`MAX_AGES`]: column, and row in the upper 16 bits.
    pub fn with_age(&self, age: usize) -> &[u32] {
        age.checked_sub(1).and_then(|index| self.by_age.get(index)).map_or(&[], Vec::as_slice)
    }

    /// The greatest age with any tiles; 0 without tiles.
    pub fn oldest(&self) -> usize {
        self.by_age.iter().rposition(|tiles| !tiles.is_empty()).map_or(0, |index| index + 1)
    }

    /// Number of compared tiles.
    pub fn count(&self) -> usize {
        self.by_age.iter().map(Vec::len).sum()
    }
}
