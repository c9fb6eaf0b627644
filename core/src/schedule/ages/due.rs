//! From cells that are due to tiles that are: one look-up for each tile.

use crate::schedule::cells::SIDE;
use crate::schedule::tiles::Block;

/// For each cell, whether any cell is due of each [`Block`] that begins there: bits 0..4 for the left eye by
/// [`Block::kind`], bits 4..8 for the right one. What lies beyond the face counts as not due.
///
/// `due` has bit 0 for the left eye, bit 1 for the right one.
pub(super) fn reach(due: &[u8], reach: &mut [u8]) {
    const FACE: usize = SIDE * SIDE;
    for (due, reach) in due.chunks_exact(FACE).zip(reach.chunks_exact_mut(FACE)) {
        for (row, reach) in reach.chunks_exact_mut(SIDE).enumerate() {
            // One more cell on the right, and below the last row nothing.
            let mut here = [0; SIDE + 1];
            let mut below = [0; SIDE + 1];
            for (spread, row) in [(&mut here, row), (&mut below, row + 1)] {
                for (bits, due) in spread.iter_mut().zip(due.chunks_exact(SIDE).nth(row).unwrap_or(&[])) {
                    *bits = due & 1 | (due & 2) << 3;
                }
            }
            for i in 0..SIDE {
                let (wide, high) = (here[i] | here[i + 1], here[i] | below[i]);
                reach[i] = here[i] | wide << 1 | high << 2 | (wide | high | below[i + 1]) << 3;
            }
        }
    }
}

/// Whether any cell of a block is due for an eye, 0 or 1, given [`reach`] of its first cell.
#[inline]
pub(super) fn reaches(reach: u8, block: Block, eye: usize) -> bool {
    let eye_bits = reach >> (4 * (eye & 1));
    eye_bits & 1 << block.kind() & 0b1111 != 0
}
