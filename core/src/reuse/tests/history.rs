//! Positions of pixels in earlier images, and the lists of tiles made of those.

use super::set;
use crate::geometry::{Fov, View, eccentricity};
use crate::reuse::{Edge, MAX_AGES, Picture, Reuse, StaleTiles, TileLists, TileRect, TileRects};
use glam::{Quat, Vec2};
use proptest::prelude::*;
use std::collections::BTreeSet;

const FOV: Fov = Fov { left: -0.9, right: 0.7, up: 0.8, down: -0.6 };

fn view(extent: [u32; 2], yaw_deg: f32, roll_deg: f32) -> View {
    let orientation =
        Quat::from_rotation_y(yaw_deg.to_radians()) * Quat::from_rotation_z(roll_deg.to_radians());
    View { orientation, plane: FOV.tangents().plane(extent) }
}

fn picture(extent: [u32; 2], yaw_deg: f32, stale: &StaleTiles) -> Picture<'_> {
    Picture { view: view(extent, yaw_deg, 0.0), extent, stale, viewpoint: None }
}

fn centres(extent: [u32; 2]) -> impl Iterator<Item = Vec2> {
    (0..extent[1]).flat_map(move |y| (0..extent[0]).map(move |x| Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
}

#[test]
fn content_at_rest_is_found_at_its_exact_place() {
    let extent = [100, 70];
    let now = set(extent, [16, 8], |_, _| true);
    let some = set(extent, [16, 8], |column, _| column % 2 == 0);
    let fresh = StaleTiles::default();
    let earlier = [picture(extent, 30.0, &some), picture(extent, 30.0, &fresh)];
    let reuse = Reuse::new(picture(extent, 30.0, &now), earlier, true);
    assert!(reuse.is_still());
    for point in centres(extent) {
        let is_in_newest = now.tile_at(point / Vec2::new(100.0, 70.0))[0] % 2 == 1;
        assert_eq!(reuse.source(point, 1).is_some(), is_in_newest);
        let source = reuse.source(point, if is_in_newest { 1 } else { 2 }).unwrap();
        assert_eq!(source.point, point);
        let footprint = reuse.footprint(source).unwrap();
        let ([x, y], weight) = footprint[0];
        assert_eq!((Vec2::new(x as f32, y as f32) + 0.5, weight), (point, 1.0));
    }
}

#[test]
fn content_of_a_turned_view_is_found_in_the_same_direction() {
    let extent = [120, 90];
    let (now, fresh) = (set(extent, [16, 16], |_, _| true), StaleTiles::default());
    let (newest, before) = (picture(extent, 0.0, &now), picture(extent, 4.0, &fresh));
    let reuse = Reuse::new(newest, [before], true);
    assert!(!reuse.is_still());
    let mut found = 0;
    for point in centres(extent) {
        let here = newest.view.orientation * newest.view.plane.direction(point);
        let Some(source) = reuse.source(point, 1) else { continue };
        let there = before.view.orientation * before.view.plane.direction(source.point);
        assert!(eccentricity(here, there) < 1e-5, "{point}");
        found += 1;
    }
    // 4 of about 92 degrees have come into view.
    assert!((9000..10700).contains(&found), "{found} of 10,800");
    let without = Reuse::new(newest, [before], false);
    assert!(centres(extent).all(|point| without.source(point, 1).unwrap().point == point), "paper B");
}

#[test]
fn nothing_comes_from_what_was_not_rendered() {
    let extent = [64, 64];
    let now = set(extent, [16, 16], |_, _| true);
    let stale = set(extent, [16, 16], |column, row| (column + row) % 2 == 1);
    let newest = picture(extent, 0.0, &now);
    let reuse = Reuse::new(newest, [picture(extent, 0.7, &stale), picture(extent, 1.4, &stale)], true);
    let mut clamped = 0;
    let both = |point| [1, 2].map(|age| reuse.source(point, age));
    for source in centres(extent).flat_map(both).flatten() {
        let earlier = picture(extent, 0.7 * source.age as f32, &stale);
        let footprint = reuse.footprint(source).unwrap();
        assert!((footprint.iter().map(|(_, weight)| weight).sum::<f32>() - 1.0).abs() < 1e-5);
        for ([x, y], weight) in footprint {
            let texel = Vec2::new(x as f32, y as f32) + 0.5;
            assert!(weight == 0.0 || earlier.is_fresh_at(texel));
            clamped += usize::from(weight == 0.0);
        }
    }
    assert!(clamped > 100, "{clamped}");
}

#[test]
fn borders_fade_over_their_width() {
    let extent = [64, 64];
    let now = set(extent, [16, 16], |column, row| column == 1 && row == 1);
    let reuse = Reuse::new(picture(extent, 0.0, &now), [], true);
    let share = |tile: [u32; 2], across: i8, down: i8, x: f32, y: f32| {
        let edge = Edge { across, down };
        let rect = reuse.edge(tile, edge, 4.0);
        let (point, is_seam) = (Vec2::new(x, y), reuse.is_seam(tile, edge));
        assert!(point.cmpge(rect.min).all() && point.cmplt(rect.max).all(), "{point} is not in {rect:?}");
        is_seam.then(|| edge.share(&rect, point))
    };
    assert_eq!(share([0, 1], 1, 0, 15.5, 20.5), Some(0.875));
    assert_eq!(share([0, 1], 1, 0, 12.5, 20.5), Some(0.125));
    assert_eq!(share([2, 1], -1, 0, 32.5, 20.5), Some(0.875));
    assert_eq!(share([1, 2], 0, -1, 20.5, 34.5), Some(0.375));
    assert_eq!(share([1, 0], 0, 1, 20.5, 12.5), Some(0.125));
    assert_eq!(share([2, 2], -1, -1, 33.5, 32.5), Some(0.625 * 0.875));
    assert_eq!(share([1, 1], -1, 0, 16.5, 20.5), None, "stale itself");
    assert_eq!(share([0, 1], -1, 0, 0.5, 20.5), None, "nothing is stale there");
    let beside = set(extent, [16, 16], |column, row| row == 1 && column > 0);
    let reuse = Reuse::new(picture(extent, 0.0, &beside), [], true);
    let corner = Edge { across: -1, down: -1 };
    assert!(!reuse.is_seam([2, 2], corner), "it fades upwards");
    assert!(reuse.is_seam([0, 2], Edge { across: 1, down: -1 }));
}

#[test]
fn pictures_that_cannot_be_related_end_the_history() {
    let extent = [64, 64];
    let (now, fresh) = (set(extent, [16, 16], |_, _| true), StaleTiles::default());
    let mut senseless = picture(extent, 0.0, &fresh);
    senseless.view.orientation = Quat::from_xyzw(0.0, 0.0, 0.0, f32::NAN);
    let good = picture(extent, 0.0, &fresh);
    let ages = |earlier: &[Picture<'_>]| {
        let reuse = Reuse::new(picture(extent, 0.0, &now), earlier.iter().copied(), true);
        (reuse.ages(), reuse.source(Vec2::ONE, 1).is_some())
    };
    assert_eq!(ages(&[good, senseless, good]), (1, true));
    assert_eq!(ages(&[senseless, good]), (0, false));
    assert_eq!(ages(&[good; 20]), (MAX_AGES, true));
}

fn tiles(rects: &TileRects) -> BTreeSet<[u32; 2]> {
    rects.iter().flat_map(TileRect::tiles).collect()
}

proptest! {
    /// The lists are made from corners of tiles; here each pixel is checked.
    #[test]
    fn lists_agree_with_pixels(
        width in prop_oneof![20u32..90, 300u32..400], height in 20u32..90, texel in prop::array::uniform2(prop_oneof![Just(8u32), Just(16), 5u32..20]),
        yaw in prop::array::uniform3(-6.0f32..6.0), roll in -3.0f32..3.0, is_still in any::<bool>(), seed in 0u32..100,
        oldest in 0usize..4, scale in prop_oneof![Just(1.0f32), 0.7f32..1.4],
    ) {
        let extent = [width, height];
        let pattern = |of: u32| move |column: u32, row: u32| !(column * 5 + row * 3 + (column * row + seed) * of).is_multiple_of(3);
        let turn = if is_still { 0.0 } else { 1.0 };
        let then = if is_still { extent } else { extent.map(|side| (side as f32 * scale) as u32) };
        let sets = [(0, extent), (1, then), (2, then), (3, then)].map(|(of, extent)| set(extent, texel, pattern(of)));
        let earlier = [0, 1, 2].map(|index| Picture {
            view: view(then, yaw[index] * turn, roll * turn),
            ..picture(then, 0.0, &sets[index + 1])
        });
        let now = picture(extent, 0.0, &sets[0]);
        let reuse = Reuse::new(now, earlier, true);
        let mut lists = TileLists::default();
        lists.update(&reuse, 4.0, oldest);
        let (fresh, whole) = (tiles(&lists.fresh), lists.full.each_ref().map(tiles));
        let mixed = lists.partial.each_ref().map(tiles);
        let border = lists.seam.each_ref().map(|of_age| of_age.each_ref().map(tiles));
        // Every pixel of the footprint was rendered in that picture.
        let is_had = |point: Vec2, index: usize| {
            let Some(source) = reuse.source(point, index + 1) else { return false };
            let footprint = reuse.footprint(source).unwrap();
            is_still
                || footprint
                    .iter()
                    .all(|([x, y], _)| earlier[index].is_fresh_at(Vec2::new(*x as f32, *y as f32) + 0.5))
        };
        let [columns, rows] = now.stale.tiles();
        for tile in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
            let listed = usize::from(fresh.contains(&tile)) + whole.iter().filter(|list| list.contains(&tile)).count();
            prop_assert_eq!(listed, 1, "{:?}", tile);
            let from = whole.iter().position(|list| list.contains(&tile));
            for (index, _) in mixed.iter().enumerate().filter(|(_, list)| list.contains(&tile)) {
                prop_assert!(from.is_none_or(|from| from >= oldest && from > index), "{tile:?} in {index}");
            }
            for (kind, edge) in Edge::ALL.into_iter().enumerate() {
                let listed: Vec<_> = (0..MAX_AGES).filter(|&age| border[age][kind].contains(&tile)).collect();
                prop_assert!(listed.len() <= usize::from(reuse.is_seam(tile, edge)), "{tile:?} {edge:?}");
                for index in listed {
                    let [first, end] = reuse.pixels(&reuse.edge(tile, edge, 4.0));
                    for (x, y) in (first[1]..end[1]).flat_map(|y| (first[0]..end[0]).map(move |x| (x, y))) {
                        let point = Vec2::new(x as f32, y as f32) + 0.5;
                        prop_assert!(is_had(point, index), "{edge:?} of {tile:?} at {point}");
                    }
                }
            }
        }
        for point in centres(extent) {
            let tile = now.tile_at(point);
            if !now.stale.is_stale(tile) {
                prop_assert!(fresh.contains(&tile));
                continue;
            }
            if let Some(index) = whole.iter().position(|list| list.contains(&tile)) {
                prop_assert!(is_had(point, index), "{index} at {point}");
                continue;
            }
            for (index, mixed) in mixed.iter().take(3).enumerate() {
                let is_there = reuse.source(point, index + 1).is_some();
                prop_assert!(!is_there || mixed.contains(&tile), "{index} at {point}");
            }
        }
    }
}
