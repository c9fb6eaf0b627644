//! From cells that are due to tiles that are: one look-up for each tile.

use crate::schedule::cells::SIDE;
use crate::schedule::tiles::{Block, First};

/// Lines of cells of all faces.
const LINES: usize = 6 * SIDE;

/// Bits of a line.
const LINE: u64 = (1 << SIDE) - 1;

/// The cells that are due for an eye as bits, a word a line: for each line through all faces, those of the line alone, and those that are
/// due in it or a line or two below it. What lies below a face's last line counts as not due.
#[derive(Clone, Debug)]
pub(super) struct DueLines(Vec<[u64; Block::HEIGHTS + 1]>);

impl DueLines {
    /// All cells are due. The only call that allocates.
    pub(super) fn all() -> Self {
        Self(vec![[LINE; Block::HEIGHTS + 1]; LINES])
    }

    /// Takes the cells that are due for an eye, 0 or 1, which is a bit of each of `due`.
    pub(super) fn set(&mut self, due: &[u8], eye: usize) {
        let faces = due.chunks_exact(SIDE * SIDE).zip(self.0.chunks_exact_mut(SIDE));
        for (due, lines) in faces {
            let [mut below, mut second] = [0; 2];
            for (line, due) in lines.iter_mut().zip(due.chunks_exact(SIDE)).rev() {
                let here = pack(due, eye);
                *line = [here, here | below, here | below | second, 0];
                (below, second) = (here, below);
            }
        }
    }

    /// Whether any cell of a block is due.
    #[inline]
    pub(super) fn any(&self, first: First, block: Block) -> bool {
        let line = self.0.get(first.line()).map_or(0, |line| line[block.higher()]);
        line >> first.column() & ((2 << block.wider()) - 1) != 0
    }
}

/// A bit of each byte of a line.
fn pack(line: &[u8], bit: usize) -> u64 {
    // One of each byte, and the product has them side by side in its last byte.
    const ONES: u64 = 0x0101_0101_0101_0101;
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let (eights, _) = line.as_chunks::<8>();
    let of_eight = |eight: &[u8; 8]| (u64::from_le_bytes(*eight) >> bit & ONES).wrapping_mul(GATHER) >> 56;
    eights.iter().rev().fold(0, |word, eight| word << 8 | of_eight(eight))
}

const _: () = assert!(SIDE.is_multiple_of(8) && SIDE < u64::BITS as usize);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_line_is_packed_bit_by_bit(line in prop::collection::vec(0u8..4, SIDE), eye in 0usize..2) {
            let packed = pack(&line, eye);
            prop_assert!(packed <= LINE);
            for (column, due) in line.iter().enumerate() {
                prop_assert_eq!(packed >> column & 1, u64::from(due >> eye & 1), "column {}", column);
            }
        }
    }
}
