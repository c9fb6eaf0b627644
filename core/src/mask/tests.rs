use super::*;
use crate::rate::VULKAN_RATES;
use proptest::prelude::*;

pub(super) fn rates(tiles: [u32; 2], rate: ShadingRate) -> Plane<u8> {
    Plane::filled(tiles[0], tiles[1], rate.texel())
}

pub(super) fn view(rates: &Plane<u8>, offset: [u32; 2], extent: [u32; 2], texel: u32) -> MaskView<'_> {
    let first = offset.map(|side| side / texel);
    let tiles = TileRates { texel: [texel; 2], first, columns: rates.width(), rates: rates.texels() };
    MaskView { layer: 0, offset, extent, tiles }
}

/// A mask of one view that is the whole picture.
fn whole(side: u32, texel: u32, rates: &Plane<u8>) -> Mask {
    let mut mask = Mask::new([side; 2], 1);
    mask.resolve(&[view(rates, [0; 2], [side; 2], texel)]);
    mask
}

#[test]
fn a_rate_shades_its_fraction_of_the_blocks() {
    for rate in VULKAN_RATES {
        let mask = whole(1024, 16, &rates([64; 2], rate));
        // The edges of the view add some.
        let added = mask.shaded() - rate.fraction();
        assert!((0.0..0.006).contains(&added), "{rate:?}: {added} more");
        assert_eq!(Pattern::of(rate).fraction(), rate.fraction());
        let inside = mask.skipped(0).unwrap();
        let inner = |x: u32, y: u32| (1..255).contains(&x) && (1..255).contains(&y);
        for (x, y) in (0..256).flat_map(|y| (0..256).map(move |x| (x, y))).filter(|&(x, y)| inner(x, y)) {
            let [columns, rows] = Pattern::PERIOD;
            let again = (x + columns, y + rows);
            assert!(
                !inner(again.0, again.1) || inside.at(x, y) == inside.at(again.0, again.1),
                "{rate:?} {x} {y}"
            );
        }
    }
}

#[test]
fn nothing_is_skipped_at_full_rate_and_outside_of_views() {
    let full = rates([4; 2], ShadingRate::R1X1);
    assert!(whole(64, 16, &full).list().is_empty());
    assert_eq!(whole(64, 16, &full).list().words(), [0, 1, 1, 0]);
    // Bytes that are not a rate and pixels without a tile are shaded too.
    let (nonsense, short) = (Plane::filled(4, 4, 0xff), rates([2; 2], ShadingRate::R4X4));
    assert!(whole(64, 16, &nonsense).list().is_empty());
    let mask = whole(64, 16, &short);
    assert!(!mask.list().is_empty());
    let beyond = |pixel: [u32; 2]| pixel[0] >= 32 || pixel[1] >= 32;
    let pixels = || (0..64).flat_map(|y| (0..64).map(move |x| [x, y]));
    assert!(pixels().filter(|pixel| beyond(*pixel)).all(|pixel| !mask.skips(0, pixel)));
    assert!(!mask.skips(0, [64, 0]) && !mask.skips(1, [8, 8]), "outside of the picture");
}

#[test]
fn two_views_in_one_layer_do_not_mix() {
    let coarse = rates([9; 2], ShadingRate::R4X4);
    let mut mask = Mask::new([256, 128], 1);
    // The seam cuts a block, which both leave alone.
    mask.resolve(&[view(&coarse, [0, 0], [126, 128], 16), view(&coarse, [126, 0], [130, 128], 16)]);
    let seam = 126 / BLOCK;
    assert!(mask.list().blocks().any(|block| block.block.x < seam));
    assert!(mask.list().blocks().any(|block| block.block.x > seam));
    for block in mask.list().blocks() {
        assert_ne!(block.block.x, seam);
        for source in block.sources.iter().flatten() {
            let x = block.block.x.strict_add_signed(source.offset().x);
            assert_eq!(x < seam, block.block.x < seam, "{block:?}");
            assert_ne!(x, seam);
        }
    }
    let alone = mask.clone();
    let overlapping = view(&coarse, [64, 0], [64, 64], 16);
    mask.resolve(&[
        view(&coarse, [0, 0], [126, 128], 16),
        view(&coarse, [126, 0], [130, 128], 16),
        overlapping,
    ]);
    assert_eq!(alone.list(), mask.list(), "a view that overlaps is ignored");
}

#[test]
fn layers_are_apart() {
    let (coarse, full) = (rates([8; 2], ShadingRate::R4X4), rates([8; 2], ShadingRate::R1X1));
    let mut mask = Mask::new([128; 2], 2);
    let second = MaskView { layer: 1, ..view(&coarse, [0; 2], [128; 2], 16) };
    mask.resolve(&[view(&full, [0; 2], [128; 2], 16), second]);
    assert!(!mask.list().is_empty() && mask.list().blocks().all(|block| block.layer == 1));
    mask.resolve(&[MaskView { layer: 2, ..second }]);
    assert!(mask.list().is_empty(), "a layer that there is not");
}

#[test]
fn pictures_that_are_too_large_are_shaded() {
    let coarse = rates([2; 2], ShadingRate::R4X4);
    let mut mask = Mask::new([MAX_SIDE + 1, 8], 1);
    mask.resolve(&[view(&coarse, [0; 2], [MAX_SIDE + 1, 8], 4096)]);
    assert!(mask.list().is_empty());
    let mut mask = Mask::new([MAX_SIDE, 64], 1);
    mask.resolve(&[view(&coarse, [MAX_SIDE - 64, 0], [64; 2], 32)]);
    let farthest = mask.list().blocks().map(|block| block.block.x).max();
    assert_eq!(farthest, Some(4095));
}

#[test]
fn dispatches_cover_the_list() {
    let coarse = rates([64; 2], ShadingRate::R4X4);
    let mask = whole(4096, 64, &coarse);
    let [columns, rows, 1, count] = mask.list().words()[..HEADER_WORDS] else { panic!("a header") };
    assert_eq!(count as usize, mask.list().len());
    assert!(columns <= 65535 && rows > 1);
    assert!(columns * rows * BLOCKS_PER_GROUP >= count && columns * (rows - 1) * BLOCKS_PER_GROUP < count);
}

#[test]
fn laying_again_takes_no_more_memory() {
    let mut mask = Mask::new([512; 2], 2);
    let capacity = |mask: &Mask| mask.list().words().as_ptr();
    let before = capacity(&mask);
    let coarse = rates([64; 2], ShadingRate::R4X4);
    let views = [0, 1].map(|layer| MaskView { layer, ..view(&coarse, [0; 2], [512; 2], 8) });
    mask.resolve(&views);
    assert_eq!(before, capacity(&mask), "the list has moved");
}

/// Tiles of any rates, a view anywhere in the picture.
fn scenes() -> impl Strategy<Value = (Plane<u8>, [u32; 2], [u32; 2], u32)> {
    let texel = prop_oneof![Just(8u32), Just(16), Just(32), Just(64), Just(10)];
    let bytes = proptest::collection::vec(
        prop_oneof![Just(0u8), Just(1), Just(4), Just(5), Just(9), Just(6), Just(10)],
        400,
    );
    (bytes, [0u32..60, 0u32..60], [1u32..200, 1u32..200], texel).prop_map(|(bytes, offset, extent, texel)| {
        (Plane::from_fn(20, 20, |x, y| bytes[(y * 20 + x) as usize]), offset, extent, texel)
    })
}

proptest! {
    #[test]
    fn every_skipped_block_has_shaded_sources_of_its_view((tiles, offset, extent, texel) in scenes()) {
        let mut mask = Mask::new([240, 200], 1);
        let view = view(&tiles, offset, extent, texel);
        mask.resolve(&[view]);
        let skipped = mask.skipped(0).unwrap();
        prop_assert_eq!(skipped.texels().iter().filter(|skipped| **skipped).count(), mask.list().len());
        for SkippedBlock { block, sources, layer } in mask.list().blocks() {
            prop_assert!(skipped.at(block.x, block.y) && layer == 0);
            let first = (block * BLOCK).as_ivec2();
            let inside = |first: glam::IVec2| {
                let offset = UVec2::from(offset).as_ivec2();
                let end = (offset + UVec2::from(extent).as_ivec2()).min(glam::IVec2::new(240, 200));
                first.cmpge(offset).all() && (first + BLOCK as i32).cmple(end).all()
            };
            prop_assert!(inside(first));
            prop_assert!(sources.iter().any(Option::is_some));
            for source in sources.iter().flatten() {
                let at = block.as_ivec2() + source.offset();
                prop_assert!(inside(at * BLOCK as i32), "{block} from {at}");
                prop_assert!(!skipped.at(at.x as u32, at.y as u32), "{block} from {at}");
            }
            // No tile that the block touches has full rate.
            for corner in [[0, 0], [3, 0], [0, 3], [3, 3]] {
                let tile = (block * BLOCK + UVec2::from(corner)) / UVec2::from(view.tiles.texel);
                prop_assert!(view.tiles.rate(tile) != ShadingRate::R1X1);
            }
        }
    }

    /// The table of a pattern's own sources is an optimisation only. Of two at one distance the one farther from the axis counts.
    #[test]
    fn sources_are_the_nearest_of_each_quarter((tiles, offset, extent, texel) in scenes()) {
        let mut mask = Mask::new([240, 200], 1);
        let view = view(&tiles, offset, extent, texel);
        mask.resolve(&[view]);
        let skipped = mask.skipped(0).unwrap();
        let (first, end) = view.blocks([240, 200]);
        for SkippedBlock { block, sources, .. } in mask.list().blocks() {
            let reach = REACH as i32;
            let offsets = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| glam::IVec2::new(x, y)));
            let shaded = |offset: &glam::IVec2| {
                let at = block.as_ivec2() + *offset;
                let inside = at.cmpge(first.as_ivec2()).all() && at.cmplt(end.as_ivec2()).all();
                inside && !skipped.at(at.x as u32, at.y as u32)
            };
            let none = (i32::MAX, 0);
            let mut least = [none; SOURCES];
            for offset in offsets.filter(shaded) {
                let (quarter, aside) = match (offset.x, offset.y) {
                    (1.., 0..) => (0, offset.y),
                    (..=0, 1..) => (1, offset.x),
                    (..=-1, ..=0) => (2, offset.y),
                    _ => (3, offset.x),
                };
                least[quarter] = least[quarter].min((offset.length_squared(), -aside.abs()));
            }
            let found = [0, 1, 2, 3].map(|quarter| {
                let offset = sources[quarter].map(Source::offset);
                let aside = |offset: glam::IVec2| -[offset.y, offset.x][quarter % 2].abs();
                offset.map_or(none, |offset| (offset.length_squared(), aside(offset)))
            });
            prop_assert_eq!(found, least, "{}", block);
        }
    }
}

#[test]
fn a_plan_is_resolved_where_its_view_is() {
    let texel = [16; 2];
    let plan = EyePlan {
        offset: [40, 8],
        extent: [80, 64],
        texel,
        rates: rates([6, 5], ShadingRate::R2X1),
        ..EyePlan::default()
    };
    let (mut by_plan, mut by_hand) = (Mask::new([160, 96], 2), Mask::new([160, 96], 2));
    by_plan.resolve(&[MaskView::of(&plan, 1)]);
    by_hand.resolve(&[MaskView { layer: 1, ..view(&plan.rates, [40, 8], [80, 64], 16) }]);
    assert_eq!(by_plan.list(), by_hand.list());
    assert!(by_plan.skips(1, [49, 13]) && !by_plan.skips(1, [36, 13]) && !by_plan.skips(1, [124, 13]));
}

/// Tiles of a picture of 16 x 16, of which some are left out.
fn some_stale(rate: ShadingRate, stale: impl Fn(u32, u32) -> bool) -> Plane<u8> {
    let mut tiles = rates([16; 2], rate);
    for y in 0..16 {
        for x in 0..16 {
            tiles.row_mut(y)[x as usize] |= if stale(x, y) { STALE } else { 0 };
        }
    }
    tiles
}

#[test]
fn stale_tiles_are_skipped_and_neither_filled_nor_read() {
    let checkers = |x: u32, y: u32| (x / 3 + y / 2).is_multiple_of(2);
    for rate in VULKAN_RATES {
        let tiles = some_stale(rate, checkers);
        let mask = whole(256, 16, &tiles);
        let is_stale = |block: UVec2| checkers(block.x / 4, block.y / 4);
        let skipped = mask.skipped(0).unwrap();
        for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
            assert!(!is_stale(UVec2::new(x, y)) || skipped.at(x, y), "{rate:?} {x} {y}");
        }
        for block in mask.list().blocks() {
            assert!(!is_stale(block.block), "{block:?}");
            for source in block.sources.iter().flatten() {
                let source = block.block.saturating_add_signed(source.offset());
                assert!(!is_stale(source) && !skipped.at(source.x, source.y), "{block:?}");
            }
        }
        let shaded = skipped.texels().iter().filter(|skipped| !**skipped).count() as f32 / 4096.0;
        assert!((mask.shaded() - shaded).abs() < 1e-6);
        // Half of the tiles, and the blocks that are added where sources are missing.
        assert!(
            (rate.fraction() * 0.45..=rate.fraction() * 0.6 + 0.02).contains(&shaded),
            "{rate:?} {shaded}"
        );
    }
}

#[test]
fn a_block_is_left_out_where_all_its_tiles_are() {
    // Tiles of 10 pixels cut blocks.
    let stale = |x: u32, _: u32| !x.is_multiple_of(3);
    let mask = whole(160, 10, &some_stale(ShadingRate::R1X1, stale));
    for (x, y) in (0..160).flat_map(|y| (0..160).map(move |x| (x, y))) {
        let block = x / 4 * 4;
        assert_eq!(mask.skips(0, [x, y]), (block..block + 4).all(|x| stale(x / 10, 0)), "{x} {y}");
    }
    assert!(mask.list().is_empty());
}
