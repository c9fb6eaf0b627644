//! Blocks of tiles against each tile by itself.

use super::set;
use crate::geometry::PixelRect;
use crate::geometry::{Fov, Nearness, View};
use crate::reuse::places::{Found, Has, TilePlaces};
use crate::reuse::{Edge, Picture, Reuse, StaleTiles, Viewpoint, bits};
use glam::{EulerRot, Quat, Vec3};
use proptest::prelude::*;

const FOV: Fov = Fov { left: -0.95, right: 0.75, up: 0.8, down: -0.9 };

/// Patches of tiles, of which one in three is fresh.
fn patches(extent: [u32; 2], texel: [u32; 2], side: u32, turn: u32) -> StaleTiles {
    set(extent, texel, |column, row| !(column / side + row / side + turn).is_multiple_of(3))
}

fn picture(extent: [u32; 2], turn_deg: [f32; 3], stale: &StaleTiles) -> Picture<'_> {
    let [yaw, pitch, roll] = turn_deg.map(f32::to_radians);
    let orientation = Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll);
    Picture {
        view: View { orientation, plane: FOV.tangents().plane(extent) },
        extent,
        stale,
        viewpoint: None,
    }
}

fn is_set(row: &[u64], [column, _]: [u32; 2]) -> bool {
    bits::read(row, column as i32) & 1 == 1
}

/// Number of tiles that the earlier picture has entirely, by the tile and by its block. Fails if a block claims a whole tile or an edge
/// that the picture lacks, or misses a tile that it has in part.
fn counted(reuse: &Reuse, border: f32) -> Result<[usize; 2], TestCaseError> {
    let mut places = TilePlaces::default();
    places.begin(reuse, border);
    let (earlier, [columns, rows]) = (reuse.at_age(1).unwrap(), reuse.now().stale.tiles());
    let wanted: Vec<u64> = (0..bits::words(columns)).map(|word| bits::range(word, [0, columns])).collect();
    let (mut found, mut counts) = (Found::default(), [0; 2]);
    for row in 0..rows {
        places.find(reuse, (0, earlier), row, &wanted, &mut found);
        for tile in (0..columns).map(|column| [column, row]) {
            let (all, any) = (is_set(&found.all, tile), is_set(&found.any, tile));
            let has = earlier.has_rect(&reuse.tiles(tile, [1, 1]));
            prop_assert!(!all || has == Has::All, "{tile:?} is {has:?}");
            prop_assert!(any || has == Has::Nothing, "{tile:?} is {has:?}");
            counts = [counts[0] + usize::from(has == Has::All), counts[1] + usize::from(all)];
        }
    }
    let (wanted, mut had) = (Edge::ALL.map(|_| wanted.clone()), Edge::ALL.map(|_| Vec::new()));
    for row in 0..rows {
        places.find_edges(reuse, (0, earlier), row, &wanted, &mut had);
        let tiles =
            (0..columns).flat_map(|column| (0..Edge::ALL.len()).map(move |kind| ([column, row], kind)));
        for (tile, kind) in tiles.filter(|(tile, kind)| is_set(&had[*kind], *tile)) {
            let edge = Edge::ALL[kind];
            // Beside a tile that is cut off there is none, so that its end is not a border.
            if (edge.across > 0 && tile[0] + 1 == columns) || (edge.down > 0 && tile[1] + 1 == rows) {
                continue;
            }
            let (rect, whole) = (reuse.edge(tile, edge, border), reuse.tiles(tile, [1, 1]));
            let rect = PixelRect { min: rect.min.max(whole.min), max: rect.max.min(whole.max) };
            prop_assert!(earlier.has_rect(&rect) == Has::All, "{edge:?} of {tile:?}");
        }
    }
    Ok(counts)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_block_never_has_more_than_its_tiles(
        extent in [40u32..900, 40u32..400], texel in [7u32..40, 7u32..40], scale in prop_oneof![Just(1.0f32), 0.4f32..2.5],
        turn_deg in prop::array::uniform3(-90.0f32..90.0), speed in prop_oneof![Just(0.0f32), 0.0f32..0.1, Just(1.0f32)],
        moved in prop::option::of(prop::array::uniform3(-0.1f32..0.1)), side in 1u32..12,
        border in 1.0f32..20.0,
    ) {
        let then = extent.map(|side| (side as f32 * scale) as u32);
        let (now, earlier) = (patches(extent, texel, side, 0), patches(then, texel, side, 1));
        let (mut now, mut earlier) =
            (picture(extent, [0.0; 3], &now), picture(then, turn_deg.map(|turn| turn * speed), &earlier));
        if let Some(moved) = moved {
            let viewpoint = |position_m| Viewpoint { position_m, nearness: Nearness { at_zero: 10.0, slope: -10.0, bounds: [0.0, 1.0] } };
            now.viewpoint = Some(viewpoint(Vec3::ZERO));
            earlier.viewpoint = Some(viewpoint(Vec3::from(moved)));
        }
        counted(&Reuse::new(now, [earlier], true), border)?;
    }

    /// Of heads that turn as people turn them, and patches of the schedule's size.
    #[test]
    fn blocks_lose_few_tiles(turn_deg in [-2.0f32..2.0, -1.0f32..1.0, -0.5f32..0.5], turn in 0u32..3) {
        let (extent, texel) = ([2160; 2], [32; 2]);
        let (now, earlier) = (patches(extent, texel, 9, 0), patches(extent, texel, 9, turn));
        let reuse = Reuse::new(picture(extent, [0.0; 3], &now), [picture(extent, turn_deg, &earlier)], true);
        let [alone, in_blocks] = counted(&reuse, 4.0)?;
        prop_assert!(alone > 500 && in_blocks * 100 >= alone * 90, "{in_blocks} of {alone}");
    }
}
