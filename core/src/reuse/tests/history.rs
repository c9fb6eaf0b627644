//! Where pixels lie in earlier pictures, and the lists of tiles made of that.

use super::set;
use crate::geometry::{Fov, View, eccentricity};
use crate::reuse::{MAX_AGES, Picture, Reuse, StaleTiles, Strip, TileLists};
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
    Picture { view: view(extent, yaw_deg, 0.0), extent, stale }
}

fn centres(extent: [u32; 2]) -> impl Iterator<Item = Vec2> {
    (0..extent[1]).flat_map(move |y| (0..extent[0]).map(move |x| Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
}

#[test]
fn what_stands_still_is_found_at_its_very_place() {
    let extent = [100, 70];
    let now = set(extent, [16, 8], |_, _| true);
    let some = set(extent, [16, 8], |column, _| column % 2 == 0);
    let fresh = StaleTiles::default();
    let earlier = [picture(extent, 30.0, &some), picture(extent, 30.0, &fresh)];
    let reuse = Reuse::new(picture(extent, 30.0, &now), earlier, true);
    assert!(reuse.is_still());
    for point in centres(extent) {
        let source = reuse.source(point).unwrap();
        assert_eq!(source.point, point);
        assert_eq!(source.age, if now.tile_at(point / Vec2::new(100.0, 70.0))[0] % 2 == 1 { 1 } else { 2 });
        let footprint = reuse.footprint(source).unwrap();
        let ([x, y], weight) = footprint[0];
        assert_eq!((Vec2::new(x as f32, y as f32) + 0.5, weight), (point, 1.0));
    }
}

#[test]
fn what_turns_is_found_in_the_same_direction() {
    let extent = [120, 90];
    let (now, fresh) = (set(extent, [16, 16], |_, _| true), StaleTiles::default());
    let (newest, before) = (picture(extent, 0.0, &now), picture(extent, 4.0, &fresh));
    let reuse = Reuse::new(newest, [before], true);
    assert!(!reuse.is_still());
    let mut found = 0;
    for point in centres(extent) {
        let here = newest.view.orientation * newest.view.plane.direction(point);
        let Some(source) = reuse.source(point) else { continue };
        let there = before.view.orientation * before.view.plane.direction(source.point);
        assert!(eccentricity(here, there) < 1e-5, "{point}");
        found += 1;
    }
    // 4 of about 92 degrees have come into view.
    assert!((9000..10700).contains(&found), "{found} of 10,800");
    let without = Reuse::new(newest, [before], false);
    assert!(centres(extent).all(|point| without.source(point).unwrap().point == point), "paper B");
}

#[test]
fn nothing_comes_from_what_was_not_rendered() {
    let extent = [64, 64];
    let now = set(extent, [16, 16], |_, _| true);
    let stale = set(extent, [16, 16], |column, row| (column + row) % 2 == 1);
    let newest = picture(extent, 0.0, &now);
    let reuse = Reuse::new(newest, [picture(extent, 0.7, &stale), picture(extent, 1.4, &stale)], true);
    let mut clamped = 0;
    for source in centres(extent).filter_map(|point| reuse.source(point)) {
        let earlier = picture(extent, 0.7, &stale);
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
    let share = |x: f32, y: f32| reuse.border_share(Vec2::new(x, y), 4.0);
    assert_eq!(share(15.5, 20.5), 0.875);
    assert_eq!(share(12.5, 20.5), 0.125);
    assert_eq!(share(11.5, 20.5), 0.0);
    assert_eq!(share(32.5, 20.5), 0.875);
    assert_eq!(share(20.5, 34.5), 0.375);
    assert!((share(33.5, 33.5) - (1.0 - 1.5 * 2f32.sqrt() / 4.0)).abs() < 1e-5);
    assert_eq!(reuse.border_share(Vec2::new(15.5, 20.5), 0.0), 0.0);
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
        (reuse.ages(), reuse.source(Vec2::ONE).is_some())
    };
    assert_eq!(ages(&[good, senseless, good]), (1, true));
    assert_eq!(ages(&[senseless, good]), (0, false));
    assert_eq!(ages(&[good; 20]), (MAX_AGES, true));
}

/// The strip of its tile that a point is in, for borders of 4 pixels.
fn strip_at(point: Vec2, tile: Vec2) -> Option<Strip> {
    let width = (tile / 2.0).min(Vec2::splat(4.0));
    let within = point - (point / tile).floor() * tile;
    let (near, far) = (within.cmplt(width), within.cmpge(tile - width));
    let of = |is: bool, strip: Strip| is.then_some(strip);
    let row = of(near.y, Strip::Upper).or(of(far.y, Strip::Lower));
    row.or(of(near.x, Strip::Left)).or(of(far.x, Strip::Right))
}

proptest! {
    /// The lists are made from corners of tiles; each pixel has its own say here.
    #[test]
    fn lists_agree_with_pixels(
        width in 20u32..90, height in 20u32..90, texel in prop::array::uniform2(prop_oneof![Just(8u32), Just(16), 5u32..20]),
        yaw in prop::array::uniform3(-6.0f32..6.0), roll in -3.0f32..3.0, is_still in any::<bool>(), seed in 0u32..100,
    ) {
        let extent = [width, height];
        let pattern = |of: u32| move |column: u32, row: u32| !(column * 5 + row * 3 + (column * row + seed) * of).is_multiple_of(3);
        let sets = [0, 1, 2, 3].map(|of| set(extent, texel, pattern(of)));
        let turn = if is_still { 0.0 } else { 1.0 };
        let earlier = [0, 1, 2].map(|index| Picture {
            view: view(extent, yaw[index] * turn, roll * turn),
            ..picture(extent, 0.0, &sets[index + 1])
        });
        let now = picture(extent, 0.0, &sets[0]);
        let reuse = Reuse::new(now, earlier, true);
        let mut lists = TileLists::default();
        lists.update(&reuse, 4.0);
        let [columns, _] = now.stale.tiles();
        let of = |list: &[u32]| list.iter().copied().collect::<BTreeSet<u32>>();
        let whole = [0, 1, 2].map(|age| of(&lists.whole[age]));
        let mixed = [0, 1, 2].map(|age| of(&lists.mixed[age]));
        let border = [0, 1, 2].map(|age| of(&lists.border[age]));
        prop_assert_eq!(whole.iter().map(BTreeSet::len).sum::<usize>(), lists.whole.iter().map(Vec::len).sum::<usize>());
        for point in centres(extent) {
            let [column, row] = now.tile_at(point);
            let tile = row * columns + column;
            let source = reuse.source(point);
            let age = source.map(|source| source.age - 1);
            if !now.stale.is_stale([column, row]) {
                prop_assert!(lists.fresh.contains(&tile));
                let is_border = reuse.border_share(point, 4.0) > 0.0;
                let entry = strip_at(point, 1.0 / now.tiles_per_pixel()).map(|strip| strip.of(tile));
                let is_listed = |age: usize| entry.is_some_and(|entry| border[age].contains(&entry));
                prop_assert!(!is_border || age.is_none_or(is_listed), "border at {point}");
                continue;
            }
            for (index, list) in whole.iter().enumerate() {
                if list.contains(&tile) {
                    prop_assert_eq!(age, Some(index), "at {}", point);
                    let footprint = reuse.footprint(source.unwrap()).unwrap();
                    for ([x, y], _) in footprint {
                        prop_assert!(earlier[index].is_fresh_at(Vec2::new(x as f32, y as f32) + 0.5) || is_still, "at {point}");
                    }
                }
            }
            if let Some(age) = age {
                prop_assert!(whole[age].contains(&tile) || mixed[age].contains(&tile), "at {point}: {age}");
            }
        }
    }
}
