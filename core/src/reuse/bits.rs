//! Rows of tiles as bits: of each tile one, 64 in a word from its lowest bit on.

/// Tiles in a word.
pub(super) const WORD: usize = u64::BITS as usize;

/// Number of words for a row of this many tiles.
pub(super) fn words(columns: u32) -> usize {
    (columns as usize).div_ceil(WORD)
}

/// The first `count` bits of a word, all where it has fewer.
pub(super) fn first(count: u32) -> u64 {
    if count >= u64::BITS { u64::MAX } else { (1 << count) - 1 }
}

/// The bits of word number `word` of a row that stand for columns from `begin` to before `end`.
pub(super) fn range(word: usize, [begin, end]: [u32; 2]) -> u64 {
    let column = (word * WORD) as u32;
    first(end.saturating_sub(column)) & !first(begin.saturating_sub(column))
}

/// 64 bits of a row from a column on, which may lie before its first one; 0 for columns that the row does not have.
#[inline]
pub(super) fn read(row: &[u64], column: i32) -> u64 {
    // A word before the first one has an index beyond the last one.
    let word = |index: i32| row.get(index as usize).copied().unwrap_or(0);
    let (index, skipped) = (column >> u64::BITS.trailing_zeros(), column as u32 % u64::BITS);
    // Shifted twice, as a shift by all bits is none.
    word(index) >> skipped | word(index.wrapping_add(1)) << 1 << (u64::BITS - 1 - skipped)
}

/// One bit of each of up to 64 bytes, that of the first one lowest.
pub(crate) fn pack(bytes: &[u8], bit: usize) -> u64 {
    // One of each byte, and the product has them side by side in its last byte.
    const ONES: u64 = 0x0101_0101_0101_0101;
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let (eights, rest) = bytes.as_chunks::<8>();
    let of_rest = rest.iter().rev().fold(0, |word, byte| word << 1 | u64::from(byte >> bit & 1));
    let of_eight = |eight: &[u8; 8]| (u64::from_le_bytes(*eight) >> bit & ONES).wrapping_mul(GATHER) >> 56;
    eights.iter().rev().fold(of_rest, |word, eight| word << 8 | of_eight(eight))
}

/// Column and length of each run of bits in a row, from the left; a run ends where its word does.
pub(super) fn runs(row: &[u64]) -> impl Iterator<Item = (u32, u32)> {
    row.iter().enumerate().flat_map(|(index, word)| {
        let (mut left, mut column) = (*word, (index * WORD) as u32);
        std::iter::from_fn(move || {
            if left == 0 {
                return None;
            }
            let skipped = left.trailing_zeros();
            left >>= skipped;
            let count = left.trailing_ones();
            // A shift by all bits is none.
            left = left.checked_shr(count).unwrap_or(0);
            let begin = column + skipped;
            column = begin + count;
            Some((begin, count))
        })
    })
}

/// The column of each bit in a row, from the left.
pub(super) fn columns(row: &[u64]) -> impl Iterator<Item = u32> {
    runs(row).flat_map(|(column, count)| column..column + count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bytes_are_packed_bit_by_bit(bytes in prop::collection::vec(any::<u8>(), 0..=64), bit in 0usize..8) {
            let packed = pack(&bytes, bit);
            for column in 0..64 {
                let expected = bytes.get(column).map_or(0, |byte| u64::from(byte >> bit & 1));
                prop_assert_eq!(packed >> column & 1, expected, "column {}", column);
            }
        }

        #[test]
        fn bits_of_a_row_are_those_of_its_columns(
            row in prop::collection::vec(any::<bool>(), 0..200), column in -300i32..300, ends in prop::array::uniform2(0u32..200),
        ) {
            let packed: Vec<u64> = row
                .chunks(WORD)
                .map(|tiles| tiles.iter().rev().fold(0, |word, tile| word << 1 | u64::from(*tile)))
                .collect();
            prop_assert_eq!(packed.len(), words(row.len() as u32));
            let is_set = |column: i32| usize::try_from(column).is_ok_and(|column| row.get(column) == Some(&true));
            let expected = (0..64).fold(0, |word, bit| word | u64::from(is_set(column + bit)) << bit);
            prop_assert_eq!(read(&packed, column), expected);
            let found: Vec<u32> = columns(&packed).collect();
            let expected: Vec<u32> = (0..row.len() as u32).filter(|column| is_set(*column as i32)).collect();
            prop_assert_eq!(found, expected);
            for (word, bit) in (0..4).flat_map(|word| (0..64).map(move |bit| (word, bit))) {
                let is_within = (ends[0]..ends[1]).contains(&((word * WORD) as u32 + bit));
                prop_assert_eq!(range(word, ends) >> bit & 1 == 1, is_within);
            }
        }
    }
}
