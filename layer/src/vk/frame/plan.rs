//! The newest plan.

use crate::link::{EyeMapRecord, PlanRecord};

/// More tiles than this in a row or column make no sense: the smallest tiles have 4 pixels.
const MAX_TILES: u32 = 16_384;

/// The newest plan; before the first, number 0 without tiles.
#[derive(Debug, Default)]
pub struct Plan {
    /// Counts up with every plan.
    pub serial: u64,
    /// Of the left and of the right eye.
    pub eyes: [EyeMap; 2],
}

/// Rates of one eye's picture.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct EyeMap {
    /// Size of the picture, pixels.
    pub extent: [u32; 2],
    /// Size of a tile, pixels.
    pub texel: [u32; 2],
    /// Columns and rows of tiles.
    pub tiles: [u32; 2],
    /// A texel of a rate image for each tile, row by row, top row first.
    pub rates: Vec<u8>,
}

impl Plan {
    /// Takes a newer plan that makes sense; says whether it did.
    pub fn take(&mut self, record: &PlanRecord, rates: [&[u8]; 2]) -> bool {
        let makes_sense =
            record.eyes.iter().zip(rates).all(|(eye, rates)| covers(eye) && rates.len() == count(eye.tiles));
        if record.serial <= self.serial || !makes_sense {
            return false;
        }
        self.serial = record.serial;
        for ((map, eye), rates) in self.eyes.iter_mut().zip(&record.eyes).zip(rates) {
            map.extent = eye.extent;
            map.texel = eye.texel;
            map.tiles = eye.tiles;
            map.rates.clear();
            map.rates.extend_from_slice(rates);
        }
        true
    }
}

fn count(tiles: [u32; 2]) -> usize {
    tiles[0] as usize * tiles[1] as usize
}

/// Whether the tiles are those that it takes to cover the picture.
fn covers(eye: &EyeMapRecord) -> bool {
    (0..2).all(|axis| {
        let (extent, texel, tiles) = (eye.extent[axis], eye.texel[axis], eye.tiles[axis]);
        extent > 0 && texel > 0 && tiles <= MAX_TILES && extent.div_ceil(texel) == tiles
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(serial: u64, extent: [u32; 2], tiles: [u32; 2]) -> PlanRecord {
        let eye = EyeMapRecord { extent, texel: [16, 8], tiles, rates: std::ptr::null() };
        PlanRecord { serial, eyes: [eye; 2] }
    }

    #[test]
    fn newer_plans_replace_older_ones_and_no_others_do() {
        let mut plan = Plan::default();
        assert!(plan.take(&record(3, [33, 16], [3, 2]), [&[5; 6], &[0; 6]]));
        assert_eq!((plan.serial, &plan.eyes[0].rates[..]), (3, &[5; 6][..]));
        for refused in [
            plan.take(&record(3, [33, 16], [3, 2]), [&[1; 6], &[1; 6]]),
            plan.take(&record(2, [33, 16], [3, 2]), [&[1; 6], &[1; 6]]),
            plan.take(&record(4, [33, 16], [3, 2]), [&[1; 6], &[1; 5]]),
            plan.take(&record(4, [33, 17], [3, 2]), [&[1; 6], &[1; 6]]),
            plan.take(&record(4, [0, 16], [0, 2]), [&[], &[]]),
        ] {
            assert!(!refused);
        }
        assert_eq!((plan.serial, &plan.eyes[1].rates[..]), (3, &[0; 6][..]));
        let before = plan.eyes[0].rates.as_ptr();
        assert!(plan.take(&record(4, [16, 8], [1, 1]), [&[9], &[9]]));
        assert_eq!(
            (&plan.eyes[0].rates[..], plan.eyes[0].rates.as_ptr()),
            (&[9][..], before),
            "no allocation"
        );
    }
}
