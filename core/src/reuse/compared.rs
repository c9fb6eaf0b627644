//! Which tiles of a picture are compared with earlier pictures, to see whether what they show has changed.

use super::places::{Has, TilePlaces};
use super::{MAX_AGES, Reuse};

/// Tiles that were rendered, by the earlier picture that they are compared with. Memory is only asked for beyond the longest
/// lists so far.
#[derive(Clone, Debug, Default)]
pub struct ComparedTiles {
    by_age: [Vec<u32>; MAX_AGES],
    places: TilePlaces,
}

impl ComparedTiles {
    /// Takes the fresh tiles of the newest picture that `is_wanted` says, each with the oldest picture of at most `oldest`
    /// pictures ago in which all of it was rendered: what would have been shown in its place, had it not been rendered since.
    /// So what is rendered in each frame because it changes is judged as what is not.
    pub fn update(&mut self, reuse: &Reuse, oldest: usize, is_wanted: impl Fn([u32; 2]) -> bool) {
        self.clear();
        self.places.begin(reuse);
        let now = reuse.now();
        let [columns, rows] = now.stale.tiles();
        let ages = reuse.ages().min(oldest);
        for row in 0..rows {
            for column in 0..columns {
                let tile = [column, row];
                if now.stale.is_stale(tile) || !is_wanted(tile) {
                    continue;
                }
                let is_all = |age: &usize| {
                    let earlier = reuse.at_age(*age);
                    earlier.is_some_and(|earlier| {
                        self.places.tile_in(reuse, *age - 1, earlier, tile) == Has::All
                    })
                };
                if let Some(age) = (1..=ages).rev().find(is_all) {
                    self.by_age[age - 1].push(column | row << 16);
                }
            }
        }
    }

    /// Nothing is compared.
    pub fn clear(&mut self) {
        self.by_age.iter_mut().for_each(Vec::clear);
    }

    /// What is compared with the picture of an age, 1..=[`MAX_AGES`]: column, and row in the upper 16 bits.
    pub fn with_age(&self, age: usize) -> &[u32] {
        age.checked_sub(1).and_then(|index| self.by_age.get(index)).map_or(&[], Vec::as_slice)
    }

    /// How many tiles are compared.
    pub fn count(&self) -> usize {
        self.by_age.iter().map(Vec::len).sum()
    }
}
