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
fn what_is_infinitely_far_or_makes_no_sense_is_at_the_greatest_distance() {
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
}
