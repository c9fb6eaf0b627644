//! The skipped blocks as the GPU reads them.

use super::sources::{SOURCES, Source, decode};
use glam::UVec2;

/// Words ahead of the blocks: the three of `VkDispatchIndirectCommand`, and the number of blocks.
pub const HEADER_WORDS: usize = 4;

/// Blocks that one workgroup of the kernel fills, each by one thread. The shaders have the same constant.
pub const BLOCKS_PER_GROUP: u32 = 64;

/// Most workgroups in a row: below the limit of every device (Vulkan specification, "Required Limits",
/// maxComputeWorkGroupCount 65535).
const GROUPS_PER_ROW: u32 = 1 << 11;

/// One skipped block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkippedBlock {
    /// Column and row, blocks from the picture's corner, each below 4096.
    pub block: UVec2,
    /// Array layer, below 256.
    pub layer: u32,
    /// The shaded blocks that it is filled from; none where it is shaded after all, and left.
    pub sources: [Option<Source>; SOURCES],
}

impl SkippedBlock {
    fn from_words([place, sources]: [u32; 2]) -> Self {
        Self {
            block: UVec2::new(place & 0xfff, place >> 12 & 0xfff),
            layer: place >> 24,
            sources: decode(sources),
        }
    }
}

/// A list of skipped blocks: the content of a storage buffer that is the argument of an indirect dispatch too.
///
/// [`HEADER_WORDS`], then two words for each block: column, row and layer in 12, 12 and 8 bits from the lowest on, and
/// the four sources, a byte each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SkipList {
    words: Vec<u32>,
}

impl Default for SkipList {
    fn default() -> Self {
        Self::with_capacity(0)
    }
}

impl SkipList {
    /// An empty list with memory for a number of blocks.
    pub fn with_capacity(blocks: usize) -> Self {
        let mut words = Vec::with_capacity(Self::capacity_words(blocks));
        words.extend([0, 1, 1, 0]);
        Self { words }
    }

    /// Words that a list of so many blocks takes.
    pub const fn capacity_words(blocks: usize) -> usize {
        HEADER_WORDS + 2 * blocks
    }

    /// All words, in the order of the buffer. An empty list dispatches nothing.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        (self.words.len() - HEADER_WORDS) / 2
    }

    /// Whether nothing is skipped.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The blocks, in order.
    pub fn blocks(&self) -> impl Iterator<Item = SkippedBlock> {
        self.words[HEADER_WORDS..].chunks_exact(2).map(|pair| SkippedBlock::from_words([pair[0], pair[1]]))
    }

    pub(super) fn clear(&mut self) {
        self.words.truncate(HEADER_WORDS);
        self.seal();
    }

    /// Appends a block with its sources, as [`super::sources::encode`] gives them.
    pub(super) fn push(&mut self, block: UVec2, layer: u32, sources: u32) {
        self.words.extend([block.x | block.y << 12 | layer << 24, sources]);
    }

    /// Writes the header.
    pub(super) fn seal(&mut self) {
        let count = self.len() as u32;
        let groups = count.div_ceil(BLOCKS_PER_GROUP);
        let columns = groups.min(GROUPS_PER_ROW);
        let rows = groups.div_ceil(GROUPS_PER_ROW).max(1);
        self.words[..HEADER_WORDS].copy_from_slice(&[columns, rows, 1, count]);
    }
}
