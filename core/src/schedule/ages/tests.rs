use super::*;
use crate::geometry::{Fov, View};
use crate::schedule::{Regions, TileCells, UpdateConfiguration, pixel_rate};
use glam::Quat;
use proptest::prelude::*;

fn all() -> impl Iterator<Item = Cell> {
    (0..CELLS).map(Cell::from_index)
}

fn yaw(yaw_deg: f32) -> Vec3 {
    let angle = yaw_deg.to_radians();
    Vec3::new(angle.sin(), 0.0, -angle.cos())
}

fn slow(phase: Phase) -> Schedule {
    Schedule { configuration: UpdateConfiguration::F12345, phase, ..Schedule::default() }
}

fn touched(direction: Vec3) -> Touched {
    // One tile of about 0.1 degrees.
    let plane = Fov { left: -0.001, right: 0.001, up: 0.001, down: -0.001 }.tangents().plane([1, 1]);
    let mut tiles = TileCells::default();
    tiles.update(&View { orientation: Quat::from_rotation_arc(Vec3::NEG_Z, direction), plane }, [1, 1], 16);
    tiles.touched(0, 0)
}

const PHASES: [Phase; 3] = [Phase::Aligned, Phase::Staggered, Phase::AlternateEye];

fn any_phase() -> impl Strategy<Value = Phase> {
    proptest::sample::select(PHASES.to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_gets_older_than_its_period(
        steps in proptest::collection::vec((any_phase(), -180f32..180.0, 0usize..10, 1u64..4), 1..30),
        start in prop_oneof![Just(u64::MAX - 7), 0u64..1000],
    ) {
        let mut ages = CellAges::new();
        let mut frame = start;
        let mut seen = vec![[false; 2]; CELLS];
        for (phase, gaze_deg, configuration, skip) in steps {
            let configuration = UpdateConfiguration::PAPER[configuration];
            frame = frame.wrapping_add(skip);
            ages.advance(&Schedule { configuration, phase, ..Schedule::default() }, frame, [yaw(gaze_deg), yaw(gaze_deg + 3.0)]);
            ages.finish(0);
            for cell in all() {
                for (eye, seen) in seen[cell.index()].iter_mut().enumerate() {
                    prop_assert!(ages.age(cell, eye) < ages.period(cell));
                    prop_assert_eq!(ages.age(cell, eye) == 0, ages.is_due(cell, eye));
                    *seen |= ages.is_due(cell, eye);
                }
            }
        }
        prop_assert!(seen.iter().all(|seen| *seen == [true; 2]));
    }

    #[test]
    fn both_eyes_see_a_direction_at_one_age(
        gazes in proptest::collection::vec((-60f32..60.0, -60f32..60.0), 1..20),
        aligned: bool,
    ) {
        let schedule = slow(if aligned { Phase::Aligned } else { Phase::Staggered });
        let mut ages = CellAges::new();
        for (frame, (left_deg, right_deg)) in gazes.into_iter().enumerate() {
            ages.advance(&schedule, frame as u64, [yaw(left_deg), yaw(right_deg)]);
            ages.want(&touched(yaw(50.0)), 2.0);
            ages.finish(1);
            prop_assert!(all().all(|cell| ages.age(cell, 0) == ages.age(cell, 1)));
            prop_assert!(all().all(|cell| ages.is_due(cell, 0) == ages.is_due(cell, 1)));
        }
    }

    #[test]
    fn a_tile_is_rendered_within_its_period(
        gazes in proptest::collection::vec(-50f32..50.0, 20),
        phase in any_phase(),
        yaw_angle in -3f32..3.0,
        eye in 0usize..2,
    ) {
        let extent = [160, 160];
        let plane = Fov { left: -0.8, right: 0.7, up: 0.6, down: -0.8 }.tangents().plane(extent);
        let mut tiles = TileCells::default();
        tiles.update(&View { orientation: Quat::from_rotation_y(yaw_angle), plane }, extent, 16);
        let mut ages = CellAges::new();
        let mut due = [false; 100];
        let mut since = [u8::MAX; 100];
        for (frame, gaze_deg) in gazes.into_iter().enumerate() {
            ages.advance(&slow(phase), frame as u64, [yaw(gaze_deg); 2]);
            ages.finish(0);
            ages.due_tiles(&tiles, eye, &mut due);
            for (index, (since, due)) in since.iter_mut().zip(due).enumerate() {
                *since = if due { 0 } else { since.saturating_add(1) };
                let mut shortest = u8::MAX;
                tiles.at(index).for_each(|cell| shortest = shortest.min(ages.period(cell)));
                prop_assert!(*since < shortest, "tile {index}: {since} frames of {shortest}");
            }
        }
    }
}

#[test]
fn a_steady_gaze_leaves_the_schedule_alone() {
    for phase in PHASES {
        let schedule = slow(phase);
        let mut ages = CellAges::new();
        for frame in 0..30 {
            ages.advance(&schedule, frame, [Vec3::NEG_Z; 2]);
            if frame < 5 {
                continue;
            }
            for cell in all() {
                for eye in 0..2 {
                    let scheduled = schedule.is_due(frame, centre(cell), ages.period(cell), eye);
                    assert_eq!(ages.is_due(cell, eye), scheduled, "{phase:?}, frame {frame}, {cell:?}");
                }
            }
        }
    }
}

#[test]
fn a_cell_has_the_period_of_its_point_nearest_to_either_gaze() {
    let schedule = slow(Phase::Aligned);
    let gaze = [yaw(-20.0), yaw(30.0)];
    let mut ages = CellAges::new();
    ages.advance(&schedule, 0, gaze);
    for cell in all() {
        let mut exact = u8::MAX;
        let mut reach = 0;
        for across in 0..=8 {
            for down in 0..=8 {
                let point = super::super::cells::point(cell, [across as f32 / 8.0, down as f32 / 8.0]);
                let nearest = gaze.map(|gaze| crate::geometry::eccentricity(gaze, point).to_degrees());
                let nearest = nearest[0].min(nearest[1]);
                exact = exact.min(schedule.period_at(nearest));
                reach = reach.max(schedule.period_at((nearest - 2.0 * CELL_RADIUS_DEG).max(0.0)));
            }
        }
        assert!(ages.period(cell) <= exact && ages.period(cell) + 1 >= reach, "{cell:?}");
    }
}

#[test]
fn a_gaze_without_a_meaning_is_everywhere() {
    let mut ages = CellAges::new();
    ages.advance(&slow(Phase::Aligned), 0, [Vec3::NAN, Vec3::ZERO]);
    assert!(all().all(|cell| ages.period(cell) == 1));
    ages.advance(&slow(Phase::Aligned), 1, [Vec3::NAN, Vec3::X]);
    let one_eye = ages.periods.clone();
    ages.advance(&slow(Phase::Aligned), 2, [Vec3::X * 1e-20, Vec3::X * 9.0]);
    assert_eq!(ages.periods, one_eye);
}

#[test]
fn the_same_frame_again_keeps_what_is_due() {
    let mut ages = CellAges::new();
    for frame in 0..9 {
        ages.advance(&slow(Phase::Staggered), frame, [Vec3::NEG_Z; 2]);
        let (due, grown) = (ages.due.clone(), ages.ages.clone());
        ages.advance(&slow(Phase::Staggered), frame, [Vec3::NEG_Z; 2]);
        assert_eq!((due, grown), (ages.due.clone(), ages.ages.clone()));
    }
    // Backwards: all ages are unknown.
    ages.advance(&slow(Phase::Staggered), 3, [Vec3::NEG_Z; 2]);
    assert!(ages.due.iter().all(|&due| due == BOTH));
}

/// Ages in a frame in which no period above 1 is due.
fn between() -> CellAges {
    let mut ages = CellAges::new();
    for frame in 0..2 {
        ages.advance(&slow(Phase::Aligned), frame, [Vec3::NEG_Z; 2]);
        ages.finish(0);
    }
    ages
}

#[test]
fn wishes_are_granted_by_need_then_index() {
    let places = [20.0, 40.0, 60.0, 80.0].map(|yaw_deg| Cell::of(yaw(yaw_deg)).unwrap());
    let granted = |needs: [f32; 4], limit| {
        let mut ages = between();
        for (place, need) in places.into_iter().zip(needs) {
            ages.want(&touched(centre(place)), need);
        }
        ages.finish(limit);
        assert!(ages.wanted.is_empty() && ages.needs.iter().all(|&need| need == 0.0));
        places.map(|place| ages.is_due(place, 0))
    };
    assert_eq!(granted([2.0, 3.0, 4.0, 5.0], 4), [true; 4]);
    assert_eq!(granted([2.0, 3.0, 4.0, 5.0], 0), [false; 4]);
    assert_eq!(granted([2.0, 3.0, 1.0, 5.0], 2), [false, true, false, true]);
    assert_eq!(granted([2.0, f32::NAN, 4.0, 5.0], 1), [false, true, false, false]);
    assert_eq!(granted([0.0, -1.0, 0.5, f32::NEG_INFINITY], 4), [false, false, true, false]);
    let first = places.iter().min().unwrap();
    assert_eq!(granted([2.0; 4], 1), places.map(|place| place == *first));
}

#[test]
fn requirements_have_no_limit() {
    let mut ages = between();
    let place = touched(yaw(50.0));
    ages.want(&place, 2.0);
    ages.require(&place);
    assert_eq!(ages.finish(0), 0);
    assert!(ages.any_due(&place, 0) && ages.any_due(&place, 1));
    let mut ages = between();
    assert!(!ages.any_due(&place, 0));
    ages.require_all();
    ages.finish(0);
    assert!(all().all(|cell| ages.is_due(cell, 0) && ages.age(cell, 1) == 0));
}

/// Share of paper B's display that is rendered, in tiles of 16 pixels: P, mean and worst frame.
fn load(phase: Phase, turning: f32) -> [f32; 3] {
    let configuration = UpdateConfiguration::F11223;
    let schedule = Schedule { configuration, phase, ..Schedule::default() };
    let extent = [1440, 1600];
    let up = 55.25f32.to_radians();
    let right = (up.tan() * 0.9).atan();
    let plane = Fov { left: -right, right, up, down: -up }.tangents().plane(extent);
    let counts = Regions::default().pixel_counts(&plane, extent, Vec3::NEG_Z);
    let rate = pixel_rate(counts.map(|count| count as f32), configuration);
    let (mut ages, mut tiles, mut due) = (CellAges::new(), TileCells::default(), vec![false; 90 * 100]);
    let loads: Vec<f32> = (0..66)
        .map(|frame| {
            let orientation =
                Quat::from_rotation_y(0.3 + turning * frame as f32) * Quat::from_rotation_x(0.2);
            ages.advance(&schedule, frame, [orientation * Vec3::NEG_Z; 2]);
            ages.finish(0);
            tiles.update(&View { orientation, plane }, extent, 16);
            ages.due_tiles(&tiles, 0, &mut due);
            due.iter().filter(|&&due| due).count() as f32 / due.len() as f32
        })
        .skip(6)
        .collect();
    let mean = loads.iter().sum::<f32>() / loads.len() as f32;
    [rate, mean, loads.into_iter().fold(0.0, f32::max)]
}

#[test]
fn staggered_frames_are_alike_and_aligned_ones_are_not() {
    for turning in [0.0, 0.02] {
        let [rate, mean, worst] = load(Phase::Aligned, turning);
        assert!(mean >= rate && mean < rate + 0.025 && worst == 1.0, "{rate} {mean} {worst}");
        let [rate, mean, worst] = load(Phase::Staggered, turning);
        assert!(mean >= rate && mean < rate + 0.08 && worst < 1.1 * mean, "{rate} {mean} {worst}");
    }
}
