//! Sets of tiles.

use super::set;
use crate::rate::VULKAN_RATES;
use crate::reuse::{STALE, StaleTiles, bits};
use glam::Vec2;
use proptest::prelude::*;

#[test]
fn no_rate_has_the_bit() {
    assert!(VULKAN_RATES.iter().all(|rate| rate.texel() & STALE == 0));
}

#[test]
fn tiles_are_those_with_the_bit() {
    let stale = set([100, 70], [16, 8], |column, row| (column + 3 * row) % 5 == 0);
    assert_eq!(stale.tiles(), [7, 9]);
    assert_eq!(stale.words().len(), 2);
    for (column, row) in (0..20).flat_map(|row| (0..20).map(move |column| (column, row))) {
        let expected = column < 7 && row < 9 && (column + 3 * row) % 5 == 0;
        assert_eq!(stale.is_stale([column, row]), expected, "{column}, {row}");
    }
    assert!(!stale.is_empty());
    assert!(set([100, 70], [16, 8], |_, _| false).is_empty());
}

#[test]
fn contradictions_are_fresh() {
    let mut stale = set([32, 32], [16, 16], |_, _| true);
    for (extent, texel, len) in
        [([32, 32], [16, 16], 3), ([32, 32], [0, 16], 4), ([0, 32], [16, 16], 0), ([u32::MAX; 2], [1, 1], 1)]
    {
        stale.set(extent, texel, &vec![STALE; len]);
        assert_eq!((stale.is_empty(), stale.tiles()), (true, [0, 0]));
        stale.set([32, 32], [16, 16], &[STALE; 4]);
        assert!(stale.is_stale([1, 1]));
    }
    stale.clear();
    assert_eq!(stale, StaleTiles::default());
}

#[test]
fn a_picture_without_tiles_is_fresh() {
    let none = StaleTiles::default();
    assert_eq!(none.kinds([0, 0], [0, 0]), (true, false));
}

#[test]
fn points_are_found_in_their_tiles() {
    let stale = set([100, 70], [16, 8], |_, _| true);
    let tile = |x: f32, y: f32| stale.tile_at(Vec2::new(x / 100.0, y / 70.0));
    assert_eq!(tile(0.5, 0.5), [0, 0]);
    assert_eq!(tile(15.5, 7.5), [0, 0]);
    assert_eq!(tile(16.5, 8.5), [1, 1]);
    assert_eq!(tile(99.5, 69.5), [6, 8]);
    assert_eq!(tile(-3.0, 1e9), [0, 8]);
    assert_eq!(tile(f32::NAN, f32::INFINITY), [0, 8]);
    assert_eq!(StaleTiles::default().tile_at(Vec2::ONE), [0, 0]);
}

proptest! {
    #[test]
    fn rows_answer_as_tiles_do(
        tiles in [1u32..150, 1u32..80], corners in prop::array::uniform2(prop::array::uniform2(0.0f32..1.0)),
        share in 0u32..8, seed in 0u32..1000,
    ) {
        let hash = |column: u32, row: u32| (column * 31 + row * 17 + seed).wrapping_mul(0x9e37_79b1) >> 29;
        let mut stale = set(tiles.map(|side| side * 8), [8, 8], |column, row| hash(column, row) < share);
        let at = |part: [f32; 2]| [0, 1].map(|axis: usize| (part[axis] * tiles[axis] as f32) as u32);
        let [a, b] = corners.map(at);
        let first = [a[0].min(b[0]), a[1].min(b[1])];
        let last = [a[0].max(b[0]), a[1].max(b[1])];
        let mut inside = (first[1]..=last[1])
            .flat_map(|row| (first[0]..=last[0]).map(move |column| [column, row]))
            .map(|tile| stale.is_stale(tile));
        let expected = (inside.clone().any(|is_stale| !is_stale), inside.any(|is_stale| is_stale));
        prop_assert_eq!(stale.kinds(first, last), expected);
        let row: Vec<u32> = bits::columns(stale.fresh_row(first[1] as i32)).collect();
        let own: Vec<u32> = (0..tiles[0]).filter(|column| !stale.is_stale([*column, first[1]])).collect();
        prop_assert_eq!(row, own);
        prop_assert!([-1, tiles[1] as i32].map(|row| stale.fresh_row(row).is_empty()) == [true; 2], "beyond the picture");
        stale.unite(&set([8, 8], [8, 8], |_, _| true));
        prop_assert_eq!(stale.kinds(first, last), (false, true), "old rows are gone");
    }

    #[test]
    fn a_union_holds_each_point_that_is_stale_in_either(
        extents in prop::array::uniform2(prop::array::uniform2(1u32..90)),
        texels in prop::array::uniform2(prop::array::uniform2(1u32..20)),
        seed in 0u32..1000,
        same in any::<bool>(),
    ) {
        let other = if same { 0 } else { 1 };
        let pattern = |of: u32| move |column: u32, row: u32| (column * 7 + row * 13 + seed * of).is_multiple_of(5);
        let a = set(extents[0], texels[0], pattern(1));
        let b = set(extents[other], texels[other], pattern(3));
        let mut both = a.clone();
        both.unite(&b);
        for (x, y) in (0..60).flat_map(|y| (0..60).map(move |x| (x, y))) {
            let at = (Vec2::new(x as f32, y as f32) + 0.5) / 60.0;
            let is_stale = |set: &StaleTiles| set.is_stale(set.tile_at(at));
            prop_assert!(is_stale(&both) || !is_stale(&a) && !is_stale(&b), "at {at}");
            if same {
                prop_assert_eq!(is_stale(&both), is_stale(&a) || is_stale(&b));
            }
        }
        let mut nothing = StaleTiles::default();
        nothing.unite(&b);
        prop_assert_eq!(&nothing, &b);
        let before = both.clone();
        both.unite(&StaleTiles::default());
        prop_assert_eq!(both, before);
    }
}

#[test]
fn words_make_the_same_set_again() {
    let tiles = set([100, 70], [16, 8], |column, row| (column * row) % 3 == 1);
    let mut copy = StaleTiles::default();
    copy.set_words(tiles.extent(), tiles.texel(), tiles.words());
    assert_eq!(copy, tiles);
    for (extent, words) in [([100, 70], &tiles.words()[1..]), ([0, 70], &[][..]), ([16, 16], tiles.words())] {
        copy.set_words(extent, [16, 8], words);
        assert_eq!(copy, StaleTiles::default(), "{extent:?}: everything is fresh");
    }
}
