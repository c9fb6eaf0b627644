use super::*;
use proptest::prelude::*;

const USUAL: DepthRange = DepthRange { min_depth: 0.0, max_depth: 1.0, near_z: 0.1, far_z: 100.0 };

/// Depth of a distance, as a projection matrix makes it (f n / (f - n) form, in double precision).
fn depth_of(distance: f64, near: f64, far: f64) -> f64 {
    far * (distance - near) / (distance * (far - near))
}

#[test]
fn every_arrangement_of_planes_gives_the_distance_back() {
    for distance in [0.1f64, 0.15, 1.0, 10.0, 99.0] {
        let usual = depth_of(distance, 0.1, 100.0);
        let arrangements = [
            ("usual", USUAL, usual),
            ("reversed", DepthRange { near_z: 100.0, far_z: 0.1, ..USUAL }, 1.0 - usual),
            ("infinite far", DepthRange { far_z: f32::INFINITY, ..USUAL }, 1.0 - 0.1 / distance),
            (
                "reversed and infinite",
                DepthRange { near_z: f32::INFINITY, far_z: 0.1, ..USUAL },
                0.1 / distance,
            ),
            (
                "part of the range",
                DepthRange { min_depth: 0.25, max_depth: 0.75, ..USUAL },
                0.25 + usual / 2.0,
            ),
        ];
        for (name, range, depth) in arrangements {
            let found = f64::from(view_distance(depth as f32, &range));
            // A depth in f32 near 1 leaves 6e-8 of 1 / 0.1.
            let allowed = 1e-6 * distance * (1.0 + distance / 0.1);
            assert!((found - distance).abs() <= allowed, "{name}: {found}, not {distance}");
        }
    }
}

#[test]
fn infinite_and_invalid_depth_is_at_the_greatest_distance() {
    let endless = DepthRange { far_z: f32::INFINITY, ..USUAL };
    for (depth, range) in [
        (1.0, endless),
        (0.0, DepthRange { near_z: f32::INFINITY, far_z: 0.1, ..USUAL }),
        (f32::NAN, USUAL),
        (0.5, DepthRange { near_z: 0.0, ..USUAL }),
        (0.5, DepthRange { far_z: -1.0, ..USUAL }),
        (0.5, DepthRange { min_depth: 0.5, max_depth: 0.5, ..USUAL }),
        (0.5, DepthRange { min_depth: 1.0, max_depth: 0.0, ..USUAL }),
        (0.5, DepthRange { near_z: f32::INFINITY, far_z: f32::INFINITY, ..USUAL }),
    ] {
        assert_eq!(view_distance(depth, &range), MAX_VIEW_DISTANCE_M, "{depth}, {range:?}");
    }
    assert_eq!(view_distance(-3.0, &USUAL), 0.1);
    assert!((view_distance(f32::INFINITY, &USUAL) - 100.0).abs() < 1e-3);
}

proptest! {
    #[test]
    fn any_numbers_give_a_distance(depth: f32, min_depth: f32, max_depth: f32, near_z: f32, far_z: f32) {
        let found = view_distance(depth, &DepthRange { min_depth, max_depth, near_z, far_z });
        prop_assert!(found > 0.0 && found <= MAX_VIEW_DISTANCE_M, "{found}");
    }

    #[test]
    fn farther_values_are_farther(a in 0.0f32..=1.0, b in 0.0f32..=1.0) {
        prop_assert!(view_distance(a.min(b), &USUAL) <= view_distance(a.max(b), &USUAL));
    }
    #[test]
    fn nearness_is_one_by_distance(
        depth in 0.0f32..=1.0, near in 0.01f32..1.0, far in 2.0f32..1e5, min in 0.0f32..0.4, max in 0.6f32..=1.0,
        is_reversed: bool, is_endless: bool,
    ) {
        let far = if is_endless { f32::INFINITY } else { far };
        let [near_z, far_z] = if is_reversed { [far, near] } else { [near, far] };
        let range = DepthRange { min_depth: min, max_depth: max, near_z, far_z };
        let found = Nearness::new(&range).unwrap().at(depth);
        let expected = view_distance(depth, &range).recip();
        // A few units in the last place of the nearest.
        prop_assert!((found - expected).abs() <= 3e-6 / near, "{found}, not {expected}");
    }
}

#[test]
fn invalid_depth_ranges_have_no_nearness() {
    for range in [
        DepthRange { near_z: 0.0, ..USUAL },
        DepthRange { far_z: -1.0, ..USUAL },
        DepthRange { near_z: f32::NAN, ..USUAL },
        DepthRange { min_depth: 0.5, max_depth: 0.5, ..USUAL },
        DepthRange { min_depth: 1.0, max_depth: 0.0, ..USUAL },
        DepthRange { max_depth: f32::NAN, ..USUAL },
    ] {
        assert_eq!(Nearness::new(&range), None, "{range:?}");
    }
    let usual = Nearness::new(&USUAL).unwrap();
    assert_eq!((usual.at(-3.0), usual.at(0.0)), (10.0, 10.0));
    assert!((usual.at(f32::INFINITY) - 0.01).abs() < 1e-6);
}
