//! Tiles that are compared, and the earlier image for each.

use super::set;
use crate::geometry::{Fov, View};
use crate::reuse::{ComparedTiles, Picture, Reuse, StaleTiles};
use glam::Quat;
use proptest::prelude::*;

const EXTENT: [u32; 2] = [160, 112];
const FOV: Fov = Fov { left: -0.9, right: 0.7, up: 0.8, down: -0.6 };

fn picture(yaw_deg: f32, stale: &StaleTiles) -> Picture<'_> {
    let orientation = Quat::from_rotation_y(yaw_deg.to_radians());
    Picture {
        view: View { orientation, plane: FOV.tangents().plane(EXTENT) },
        extent: EXTENT,
        stale,
        viewpoint: None,
    }
}

fn compared(reuse: &Reuse, oldest: usize) -> ComparedTiles {
    let mut tiles = ComparedTiles::default();
    tiles.update(reuse, oldest, |_| true);
    tiles
}

/// Of a period of three frames.
#[test]
fn fresh_tiles_are_compared_with_the_re_used_image() {
    let frame = |turn: u32| set(EXTENT, [16; 2], move |column, _| column % 3 != turn);
    let frames = [0, 1, 2, 0, 1].map(frame);
    let [now, earlier @ ..] = &frames;
    let reuse = Reuse::new(picture(0.0, now), earlier.iter().map(|stale| picture(0.0, stale)), true);
    let tiles = compared(&reuse, 3);
    assert_eq!((tiles.count(), tiles.with_age(3).len()), (4 * 7, 4 * 7), "of 10 columns 4");
    assert!(tiles.with_age(3).iter().all(|word| (word & 0xffff) % 3 == 0 && word >> 16 < 7));
    assert_eq!(compared(&reuse, 2).count(), 0, "two frames ago others were rendered");
    let mut none = tiles;
    none.update(&reuse, 3, |[column, _]| column == 3);
    assert_eq!(none.count(), 7);
    none.clear();
    assert_eq!((none.count(), none.oldest(), none.with_age(0).len(), none.with_age(9).len()), (0, 0, 0, 0));
}

/// Tiles that are rendered in each frame are compared as if they were not.
#[test]
fn tiles_rendered_in_each_frame_are_compared_with_the_oldest_image() {
    let fresh = set(EXTENT, [16; 2], |_, _| false);
    let reuse =
        Reuse::new(picture(1.0, &fresh), [0.5, 0.0, -0.5, -1.0].map(|yaw| picture(yaw, &fresh)), true);
    let tiles = compared(&reuse, 3);
    // Directions that came into view at the edge are only in newer images, if in any.
    assert_eq!(tiles.oldest(), 3);
    assert!(tiles.with_age(3).len() >= 8 * 5 && tiles.count() < 70, "{}", tiles.count());
    assert!(tiles.with_age(4).is_empty());
}

proptest! {
    #[test]
    fn nothing_is_compared_with_what_was_not_rendered(
        maps in prop::collection::vec(prop::collection::vec(any::<bool>(), 70), 2..6),
        speed in -3.0f32..3.0,
        oldest in 0usize..9,
    ) {
        let sets: Vec<_> = maps
            .iter()
            .map(|map| set(EXTENT, [16; 2], |column, row| map[(row * 10 + column) as usize]))
            .collect();
        let pictures: Vec<_> =
            sets.iter().enumerate().map(|(age, stale)| picture(speed * age as f32, stale)).collect();
        let reuse = Reuse::new(pictures[0], pictures[1..].iter().copied(), true);
        let tiles = compared(&reuse, oldest);
        let mut seen = std::collections::BTreeSet::new();
        for age in 1..=8 {
            for word in tiles.with_age(age) {
                let tile = [word & 0xffff, word >> 16];
                prop_assert!(age <= oldest && seen.insert(tile) && !sets[0].is_stale(tile));
                let rect = reuse.tiles(tile, [1, 1]);
                for point in [rect.min, rect.max, (rect.min + rect.max) / 2.0] {
                    let inside = point.clamp(rect.min + 0.01, rect.max - 0.01);
                    prop_assert!(reuse.source(inside, age).is_some(), "{tile:?} at age {age}");
                }
            }
        }
    }
}
