use super::*;
use crate::schedule::{Phase, Schedule, UpdateConfiguration};
use glam::Vec3;

const SCHEDULE: Schedule = Schedule {
    regions: crate::schedule::Regions { radii_deg: [6.3, 9.1, 18.1, 31.1] },
    configuration: UpdateConfiguration::F11223,
    phase: Phase::Staggered,
};

/// The frames of 0..`frames` in which a cell is rendered, of which it changes in `changes`.
fn rendered(cell: Cell, frames: u64, changes: &[u64]) -> Vec<u64> {
    let (mut ages, mut activity) = (CellAges::new(), Activity::new());
    let mut due = |frame: &u64| {
        ages.advance(&SCHEDULE, *frame, [Vec3::NEG_Z; 2]);
        if changes.contains(frame) {
            activity.changed(cell, 2.0, 12);
        }
        activity.ask(*frame, &mut ages);
        ages.finish(10);
        ages.is_due(cell, 0)
    };
    (0..frames).filter(|frame| due(frame)).collect()
}

#[test]
fn changing_cells_are_rendered_in_each_frame_and_then_by_schedule() {
    let cell = Cell::of(Vec3::new(0.8, 0.3, -1.0)).unwrap();
    let before = rendered(cell, 60, &[]);
    assert_eq!(before.len(), 20, "every third frame");
    let with = rendered(cell, 60, &[20, 25]);
    assert!((20..37).all(|frame| with.contains(&frame)), "{with:?}");
    assert!(with.iter().filter(|frame| **frame >= 40).count() <= 7, "{with:?}");
    assert_eq!(with.iter().filter(|frame| **frame < 20).count(), 7, "{with:?}");
}

#[test]
fn no_more_is_granted_in_a_frame_than_the_limit() {
    let (mut ages, mut activity) = (CellAges::new(), Activity::new());
    let cells = (0..40).map(|step| Cell::of(Vec3::new(0.7, 0.02 * step as f32 - 0.4, -1.0)).unwrap());
    cells.for_each(|cell| activity.changed(cell, 2.0, 12));
    let asked = activity.count();
    for frame in 0..6 {
        ages.advance(&SCHEDULE, frame, [Vec3::NEG_Z; 2]);
        activity.ask(frame, &mut ages);
        let granted = ages.finish(5);
        assert!(granted <= 5 && (frame == 0 || granted > 0), "{granted} of {asked} in frame {frame}");
    }
}

#[test]
fn a_cut_renders_everything_once() {
    let (mut ages, mut activity) = (CellAges::new(), Activity::new());
    let all = |ages: &CellAges| (0..CELLS).filter(|cell| ages.is_due(Cell::from_index(*cell), 1)).count();
    for frame in 0..8 {
        ages.advance(&SCHEDULE, frame, [Vec3::NEG_Z; 2]);
        if frame == 4 {
            activity.cut();
        }
        activity.ask(frame, &mut ages);
        ages.finish(0);
        // In the first frame nothing was rendered before.
        assert_eq!(all(&ages) == CELLS, frame == 0 || frame == 4, "frame {frame}");
    }
}
