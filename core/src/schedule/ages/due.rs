//! From cells that are due to tiles that are: one look-up for each tile.

use crate::reuse::bits::pack;
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

const _: () = assert!(SIDE < u64::BITS as usize);
