//! Properties for any map, gaze and orientation.

use super::*;
use proptest::prelude::*;

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_filter_map("too short", |(x, y, z)| Vec3::new(x, y, z).try_normalize())
}

fn ahead() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0).prop_map(|(x, y)| Vec3::new(x, y, -1.0).normalize())
}

fn any_quat() -> impl Strategy<Value = Quat> {
    (direction(), -3.1f32..3.1).prop_map(|(axis, angle)| Quat::from_axis_angle(axis, angle))
}

fn any_map() -> impl Strategy<Value = FixedFoveation> {
    let peripheral = prop_oneof![Just(ShadingRate::R4X4), Just(ShadingRate::R2X2), Just(ShadingRate::R2X4)];
    (0.0f32..40.0, 0.0f32..60.0, peripheral).prop_map(|(foveal_deg, transitional_deg, peripheral)| {
        FixedFoveation { foveal_deg, transitional_deg, peripheral }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn rate_does_not_rise_with_eccentricity(map in any_map(), left in ahead(), right in ahead()) {
        let rates = RateSettings::Fixed(map);
        let mut planner = Planner::new(without_safety_limits(PlanSettings { rates, ..PlanSettings::default() }));
        let plan = planner.plan(&PlanInput { gaze: gaze(left, right), ..input() });
        for eye in &plan.eyes {
            let mut tiles: Vec<(f32, f32)> = (0..40)
                .flat_map(|x| (0..35).map(move |y| (x, y)))
                .map(|(x, y)| (eye.centres.map(|at| eccentricity(at, middle_of(eye, x, y))), eye.rate(x, y)))
                .map(|(angles, rate)| (angles[0].min(angles[1]).to_degrees(), rate.octaves()))
                .collect();
            tiles.sort_by(|a, b| a.0.total_cmp(&b.0));
            // The nearest point of a tile is within 2.2 degrees of its middle.
            for (index, (far, octaves)) in tiles.iter().enumerate() {
                let nearer = tiles[..index].iter().filter(|(near, _)| near + 4.4 < *far);
                prop_assert!(nearer.clone().all(|(_, before)| before <= octaves), "{octaves} at {far}");
            }
        }
    }

    /// The rate of a direction is that of the rings, the same in both eyes; a tile has the finest of its directions.
    #[test]
    fn both_eyes_give_one_direction_the_same_rate(map in any_map(), left in ahead(), right in ahead(), seen in ahead()) {
        let settings = PlanSettings { rates: RateSettings::Fixed(map), ..PlanSettings::default() };
        let mut planner = Planner::new(without_safety_limits(settings));
        let input = PlanInput { gaze: gaze(left, right), ..input() };
        let plan = planner.plan(&input);
        prop_assert_eq!(plan.eyes[0].rings, plan.eyes[1].rings);
        let rates = [0, 1].map(|index: usize| {
            let eye = &plan.eyes[index];
            let to_view = input.eyes[index].orientation.inverse();
            let angles = eye.centres.map(|centre| eccentricity(centre, to_view * seen).to_degrees());
            (angles[0].min(angles[1]), to_view * seen)
        });
        prop_assert!((rates[0].0 - rates[1].0).abs() < 1e-3, "{rates:?}");
        for (eye, (angle, direction)) in plan.eyes.iter().zip(rates) {
            let at = (direction.truncate() / -direction.z - eye.plane().origin) / eye.plane().step;
            if direction.z < 0.0 && at.cmpge(glam::Vec2::ZERO).all() && at.x < 640.0 && at.y < 560.0 {
                let [x, y] = eye.tile_of([at.x as u32, at.y as u32]);
                let finest = eye.rings.rate_at(&plan.available, angle + 1e-3).octaves();
                prop_assert!(eye.rate(x, y).octaves() <= finest, "{:?} at {angle}", eye.rate(x, y));
            }
        }
    }

    #[test]
    fn joint_rotation_changes_nothing(map in any_map(), left in ahead(), right in ahead(), turn in any_quat()) {
        let settings = without_safety_limits(PlanSettings { rates: RateSettings::Fixed(map), ..PlanSettings::default() });
        let before = PlanInput { gaze: gaze(left, right), ..input() };
        let mut after = PlanInput { gaze: gaze(turn * left, turn * right), ..before };
        after.eyes.iter_mut().for_each(|eye| eye.orientation = turn * eye.orientation);
        let mut planners = [Planner::new(settings), Planner::new(settings)];
        let [first, second] = &mut planners;
        let (first, second) = (first.plan(&before), second.plan(&after));
        for (a, b) in first.eyes.iter().zip(&second.eyes) {
            let differ = a.rates.texels().iter().zip(b.rates.texels()).filter(|(a, b)| a != b).count();
            prop_assert!(differ <= 3, "{differ} tiles");
        }
    }

    /// With any settings, contrast and sound.
    #[test]
    fn fovea_has_full_rate(
        map in any_map(), left in ahead(), velocity_deg_s in 0.0f32..800.0, by_contrast in any::<bool>(), cap in any::<bool>(),
    ) {
        let model = AudioVisual { cap: cap.then_some(map), fixed: map, ..AudioVisual::default() };
        let rates = if by_contrast { RateSettings::AudioVisual(model) } else { RateSettings::Fixed(map) };
        let tile = TileContrast { bands: [0.0; 4], adaptation_cd_m2: 1.0 };
        let plain = ContrastMap { tiles: Plane::filled(40, 35, tile) };
        let gaze = GazeState { velocity_deg_s, ..gaze(left, left) };
        let mut input = PlanInput { gaze, audio: Some(loud()), ..input() };
        input.eyes.iter_mut().for_each(|eye| eye.contrast = Some(&plain));
        let mut planner = Planner::new(PlanSettings { rates, ..PlanSettings::default() });
        let plan = settled(&mut planner, input);
        prop_assert!(plan.inflation_deg >= 1.1 - 1e-5);
        for eye in &plan.eyes {
            for (x, y) in (0..40).flat_map(|x| (0..35).map(move |y| (x, y))) {
                let angle = eccentricity(eye.centres[0], middle_of(eye, x, y)).to_degrees();
                let inside = angle <= 5.0 + plan.inflation_deg - 1e-3;
                prop_assert!(!inside || eye.rate(x, y) == ShadingRate::R1X1, "{:?} at {angle}", eye.rate(x, y));
            }
        }
    }

    /// Every direction that stays in view is rendered within its period, however the head turns, and as it comes
    /// into view.
    #[test]
    fn directions_are_rendered_within_their_period(
        factors in prop_oneof![Just("11223"), Just("12345"), Just("11112")],
        phase in prop_oneof![Just(Phase::Aligned), Just(Phase::Staggered), Just(Phase::AlternateEye)],
        axis in direction(), speed in 0.0f32..0.06, seen in proptest::collection::vec(direction(), 40),
    ) {
        let configuration: UpdateConfiguration = factors.parse().expect("a configuration");
        let schedule = Schedule { configuration, phase, ..Schedule::default() };
        let updates = UpdateSettings {
            faster_in_pursuit: false,
            uncapped: true,
            ..UpdateSettings::from(schedule)
        };
        let mut planner = Planner::new(PlanSettings { schedule: Some(updates), ..fixed() });
        // Frames since a direction was rendered; nothing while it is out of view.
        let mut ages = vec![[None::<u8>; 2]; seen.len()];
        for frame in 0..60u64 {
            let head = Quat::from_axis_angle(axis, speed * frame as f32);
            let input = PlanInput { frame, time_ns: frame as i64 * FRAME_NS, head, ..input() };
            let plan = planner.plan(&input);
            for (direction, ages) in seen.iter().zip(&mut ages) {
                for (index, age) in ages.iter_mut().enumerate() {
                    let eye = &plan.eyes[index];
                    let in_view = (head * input.eyes[index].orientation).inverse() * *direction;
                    let at = (in_view.truncate() / -in_view.z - eye.plane().origin) / eye.plane().step;
                    let outside = (-at).max_element().max(at.x - 640.0).max(at.y - 560.0);
                    if in_view.z >= 0.0 || outside > -0.01 {
                        // Less than a pixel beyond the border, the pixel at the border stands for the direction.
                        *age = (in_view.z < 0.0 && outside < 1.0).then_some(0);
                        continue;
                    }
                    let [x, y] = eye.tile_of([at.x as u32, at.y as u32]);
                    let next = age.map_or(u8::MAX, |age| age.saturating_add(1));
                    *age = Some(if eye.is_due(x, y) { 0 } else { next });
                    let angles = eye.centres.map(|centre| eccentricity(centre, in_view).to_degrees());
                    let reach = angles[0].min(angles[1]);
                    let region = plan.regions_deg.iter().filter(|radius| reach > **radius).count();
                    prop_assert!(
                        age.is_some_and(|age| age < plan.periods[region]),
                        "{age:?} at {reach} degrees in frame {frame}, periods {:?}", plan.periods
                    );
                }
            }
        }
    }
}
