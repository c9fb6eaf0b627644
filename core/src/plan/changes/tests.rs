use super::*;
use crate::geometry::Fov;
use crate::schedule::{Phase, Regions, Schedule, UpdateConfiguration};
use glam::Quat;
use std::iter;

/// Tiles of [`view`].
const ALL: usize = 60 * 60;

const SCHEDULE: Schedule = Schedule {
    regions: Regions { radii_deg: [6.3, 9.1, 18.1, 31.1] },
    configuration: UpdateConfiguration::F11223,
    phase: Phase::Staggered,
};

/// 60 x 60 tiles of about 1.7 degrees.
fn view(yaw_deg: f32) -> View {
    let fov = Fov { left: -0.9, right: 0.9, up: 0.9, down: -0.9 };
    View { orientation: Quat::from_rotation_y(yaw_deg.to_radians()), plane: fov.tangents().plane([60; 2]) }
}

fn word(tile: [u32; 2]) -> u32 {
    tile[0] | tile[1] << 16
}

/// The cell in the middle of a tile.
fn cell(view: &View, [x, y]: [u32; 2]) -> Cell {
    let point = Vec2::new(x as f32, y as f32) + 0.5;
    Cell::of(view.orientation * view.plane.direction(point)).unwrap()
}

fn refresh(changes: &mut Changes, ages: &mut CellAges, frame: u64) -> bool {
    ages.advance(&SCHEDULE, frame, [Vec3::NEG_Z; 2]);
    changes.refresh(frame, [Vec3::NEG_Z; 2], ages)
}

/// Changes in an image that was seen before the head turned are refreshed at their place in the world.
#[test]
fn visible_changes_are_refreshed_at_their_place() {
    let (mut ages, mut changes) = (CellAges::new(), Changes::default());
    (0..3).for_each(|frame| assert!(!refresh(&mut changes, &mut ages, frame)));
    let seen = view(20.0);
    let tiles = [([5, 30], 5.0), ([50, 8], 1e-3), ([40, 40], 0.0)];
    let quiet = (0..57).map(|column| (word([column, 59]), 0.0));
    let all: Vec<_> = tiles.iter().map(|(tile, change)| (word(*tile), *change)).chain(quiet).collect();
    changes.seen(&seen, ALL, all.into_iter());
    for frame in 3..6 {
        assert!(refresh(&mut changes, &mut ages, frame));
        assert!(ages.is_due(cell(&seen, [5, 30]), 0) && ages.is_due(cell(&seen, [5, 30]), 1));
    }
    let often = |tile| {
        let (mut ages, mut changes) = (ages.clone(), changes.clone());
        (6..9)
            .filter(|frame| {
                refresh(&mut changes, &mut ages, *frame);
                ages.is_due(cell(&seen, tile), 0)
            })
            .count()
    };
    assert_eq!((often([5, 30]), often([50, 8])), (3, 1));
}

#[test]
fn two_plans_of_a_frame_refresh_no_more_than_one() {
    let (mut ages, mut changes) = (CellAges::new(), Changes::default());
    (0..3).for_each(|frame| _ = refresh(&mut changes, &mut ages, frame));
    changes.settings.limit_cells = 20;
    changes.settings.cut_share = 2.0;
    let due = |ages: &CellAges| {
        (0..60)
            .flat_map(|y| (0..60).map(move |x| [x, y]))
            .filter(|tile| ages.is_due(cell(&view(0.0), *tile), 0))
            .count()
    };
    let everything =
        || (0..60u32).flat_map(|y| (0..60).map(move |x| (word([x, y]), 9.0))).collect::<Vec<_>>();
    changes.seen(&view(0.0), ALL, everything().into_iter());
    refresh(&mut changes, &mut ages, 3);
    let once = due(&ages);
    changes.seen(&view(0.0), ALL, everything().into_iter());
    refresh(&mut changes, &mut ages, 3);
    assert_eq!(due(&ages), once);
    assert_eq!(changes.granted, (3, 20));
}

#[test]
fn a_scene_cut_refreshes_everything_at_once() {
    let (mut ages, mut changes) = (CellAges::new(), Changes::default());
    (0..4).for_each(|frame| _ = refresh(&mut changes, &mut ages, frame));
    // A quarter of the picture, as in a frame with one due region.
    let tiles =
        |count: u32| (0..count).map(|index| (word([index % 60, index / 60]), 3.0)).collect::<Vec<_>>();
    changes.seen(&view(0.0), ALL, tiles(900).into_iter());
    assert!(refresh(&mut changes, &mut ages, 4));
    let behind = Cell::of(Vec3::Z).unwrap();
    assert!(ages.is_due(behind, 0) && ages.is_due(behind, 1), "even what was not seen");
}

/// In a frame without a due region, only tiles with earlier changes are compared, with a rim.
#[test]
fn a_small_moving_object_is_no_scene_cut() {
    let (mut ages, mut changes) = (CellAges::new(), Changes::default());
    (0..4).for_each(|frame| _ = refresh(&mut changes, &mut ages, frame));
    let tile = |index: u32| word([5 + index % 14, 5 + index / 14]);
    let moving = (0..196).map(|index| (tile(index), if (48..148).contains(&index) { 3.0 } else { 0.0 }));
    changes.seen(&view(0.0), ALL, moving.collect::<Vec<_>>().into_iter());
    assert!(refresh(&mut changes, &mut ages, 4));
    let behind = Cell::of(Vec3::Z).unwrap();
    assert!(!ages.is_due(behind, 0) || !ages.is_due(behind, 1), "only its own cells");
}

#[test]
fn no_compared_tiles_change_nothing() {
    let (mut ages, mut changes) = (CellAges::new(), Changes::default());
    changes.seen(&view(0.0), ALL, iter::empty::<(u32, f32)>().collect::<Vec<_>>().into_iter());
    assert!(!refresh(&mut changes, &mut ages, 0));
    assert!(changes.activity.is_none(), "and takes no memory");
}
