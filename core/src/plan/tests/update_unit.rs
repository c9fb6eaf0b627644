use super::*;
use crate::reuse::STALE;
use crate::schedule::{Regions, pixel_rate};
use proptest::prelude::*;

/// To the letter of paper B.
fn as_published(configuration: UpdateConfiguration) -> PlanSettings {
    let schedule = Schedule { configuration, phase: Phase::Aligned, ..Schedule::default() };
    let updates = UpdateSettings {
        faster_in_pursuit: false,
        unit: UpdateUnit::Tiles,
        uncapped: true,
        ..UpdateSettings::from(schedule)
    };
    PlanSettings { schedule: Some(updates), safety: SafetySettings::PAPER, ..PlanSettings::default() }
}

/// The display that paper B's table fits best: 1440 x 1600 pixels, 110.5 degrees high.
fn paper_display<'a>() -> PlanInput<'a> {
    let up = 55.25f32.to_radians();
    let right = (up.tan() * 0.9).atan();
    let fov = Fov { left: -right, right, up, down: -up };
    let eye = EyeInput { extent: [1440, 1600], fov, orientation: Quat::IDENTITY, ..input().eyes[0] };
    PlanInput { eyes: [eye; 2], ..input() }
}

/// Cost of tiles of 16 pixels: tiles across a region's edge are rendered as often as their fastest pixel.
#[test]
fn tiles_cost_half_a_point_more_than_pixels() {
    let paper = paper_display();
    let plane = paper.eyes[0].fov.tangents().plane([1440, 1600]);
    let areas = Regions::default().pixel_counts(&plane, [1440, 1600], Vec3::NEG_Z).map(|count| count as f32);
    for configuration in UpdateConfiguration::PAPER {
        let mut planner = Planner::new(as_published(configuration));
        // A multiple of all periods.
        let mut share = 0.0;
        for frame in 0..60 {
            share += planner.plan(&PlanInput { frame, ..paper }).eyes[0].statistics().pixel_share / 60.0;
        }
        let more = 100.0 * (share - pixel_rate(areas, configuration));
        println!("{configuration}: {:.2} %, {more:.2} points more than by pixels", 100.0 * share);
        assert!((-0.001..0.5).contains(&more), "{configuration}: {more} points");
    }
}

#[test]
fn a_frame_that_is_planned_again_renders_no_less() {
    for unit in [UpdateUnit::Directions, UpdateUnit::Tiles] {
        let schedule = Schedule { configuration: UpdateConfiguration::F11223, ..Schedule::default() };
        let updates = UpdateSettings { unit, ..UpdateSettings::from(schedule) };
        let mut planner = Planner::new(PlanSettings { schedule: Some(updates), ..fixed() });
        for frame in 0..20 {
            let turned = |by: f32| PlanInput { head: Quat::from_rotation_y(by * 0.05), frame, ..input() };
            let due =
                |plan: &FramePlan| plan.eyes[0].ages.texels().iter().map(|age| *age == 0).collect::<Vec<_>>();
            let first = due(planner.plan(&turned(frame as f32)));
            let again = due(planner.plan(&turned(frame as f32)));
            assert_eq!(first, again, "{unit:?}, frame {frame}: what came into view since the last frame");
        }
    }
}

#[test]
fn a_map_says_what_is_stale() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11223, Phase::Aligned));
    let eye = &settled(&mut planner, input()).eyes[0];
    let mut map = Vec::new();
    eye.write_map(&mut map);
    let stale = eye.ages.texels().iter().map(|age| *age > 0);
    assert!(stale.clone().any(|stale| stale) && stale.clone().any(|stale| !stale));
    let expected =
        eye.rates.texels().iter().zip(stale).map(|(rate, stale)| rate + if stale { STALE } else { 0 });
    assert_eq!(map, expected.collect::<Vec<_>>());
}

/// A drift of 20 arc minutes is visible up to 14.2 degrees after one frame, and up to 29.4 after two.
#[test]
fn visible_drift_shortens_periods() {
    let mut planner = Planner::new(with_schedule(UpdateConfiguration::F11223, Phase::Staggered));
    for (drift_arcmin, periods) in [
        (0.0, [1, 1, 2, 2, 3]),
        (10.0, [1, 1, 2, 2, 3]),
        (-20.0, [1, 1, 1, 2, 3]),
        (30.0, [1, 1, 1, 1, 2]),
        (60.0, [1; 5]),
        (f32::NAN, [1; 5]),
    ] {
        planner.set_drift(drift_arcmin);
        let plan = settled(&mut planner, input());
        assert_eq!(plan.reasons.contains(Reason::HeadMoves), periods != [1, 1, 2, 2, 3], "{drift_arcmin}");
        assert_eq!(plan.periods, periods, "{drift_arcmin}");
    }
    planner = Planner::new(as_published(UpdateConfiguration::F12345));
    planner.set_drift(60.0);
    assert_eq!(settled(&mut planner, input()).periods, [1, 2, 3, 4, 5]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_tile_gets_older_than_the_period_of_any_of_its_points(
        gazes in proptest::collection::vec(-40f32..40.0, 2..20),
        configuration in 0usize..10,
    ) {
        let configuration = UpdateConfiguration::PAPER[configuration];
        let schedule = Schedule { configuration, ..Schedule::default() };
        let mut planner = Planner::new(as_published(configuration));
        let mut since = Vec::new();
        for (frame, gaze_deg) in (7..).zip(gazes) {
            let direction = Quat::from_rotation_y(gaze_deg.to_radians()) * Vec3::NEG_Z;
            let eyes = input().eyes.map(|eye| EyeInput { orientation: Quat::IDENTITY, ..eye });
            let plan = planner.plan(&PlanInput { frame, eyes, gaze: gaze(direction, direction), ..input() });
            let eye = &plan.eyes[1];
            since.resize(eye.ages.texels().len(), u8::MAX);
            for (index, since) in since.iter_mut().enumerate() {
                let (x, y) = (index as u32 % eye.ages.width(), index as u32 / eye.ages.width());
                *since = if eye.is_due(x, y) { 0 } else { since.saturating_add(1) };
                let nearest = eccentricity(direction, middle_of(eye, x, y)).to_degrees();
                prop_assert!(*since < schedule.period_at(nearest), "{since} frames at {nearest} degrees");
            }
        }
    }
}
