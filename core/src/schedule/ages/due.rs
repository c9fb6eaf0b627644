//! From cells that are due to tiles that are: one look-up for each tile.

use crate::reuse::bits::pack;
use crate::schedule::cells::SIDE;
use crate::schedule::tiles::{ColumnSpan, LineSpan};

/// Bits of a line.
const LINE: u64 = (1 << SIDE) - 1;

/// Words for each line: of spans of 1, 2 and 3 lines from it on, and one without meaning.
const SPANS: usize = LineSpan::COUNT / (6 * SIDE);

/// A power of two, so that an index is cut to it by its bits.
const WORDS: usize = LineSpan::COUNT.next_power_of_two();

/// Due cells of an eye as bits, a word for each [`LineSpan`]: the columns with a due cell in any of its lines. Lines below a face's
/// last one count as not due.
#[derive(Clone, Debug)]
pub(super) struct DueLines(Box<[u64; WORDS]>);

impl DueLines {
    /// All cells are due. The only call that allocates.
    pub(super) fn all() -> Self {
        Self(Box::new([LINE; WORDS]))
    }

    /// Takes the cells that are due for an eye, 0 or 1, which is a bit of each of `due`.
    pub(super) fn set(&mut self, due: &[u8], eye: usize) {
        let faces = due.chunks_exact(SIDE * SIDE).zip(self.0.chunks_exact_mut(SIDE * SPANS));
        for (due, lines) in faces {
            let [mut below, mut second] = [0; 2];
            for (line, due) in lines.chunks_exact_mut(SPANS).zip(due.chunks_exact(SIDE)).rev() {
                let here = pack(due, eye);
                line.copy_from_slice(&[here, here | below, here | below | second, 0]);
                (below, second) = (here, below);
            }
        }
    }

    /// Whether any cell of a block is due.
    #[inline]
    pub(super) fn any(&self, lines: LineSpan, columns: ColumnSpan) -> bool {
        let due = self.0[lines.index() % WORDS];
        due >> columns.first() & ((2 << columns.wider()) - 1) != 0
    }
}

const _: () = assert!(SIDE < u64::BITS as usize);
