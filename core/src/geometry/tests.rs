use super::*;
use proptest::prelude::*;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

fn any_f32() -> impl Strategy<Value = f32> {
    prop_oneof![
        proptest::num::f32::ANY,
        Just(f32::NAN),
        Just(f32::INFINITY),
        Just(0.0),
        Just(f32::MAX),
        Just(f32::MIN_POSITIVE)
    ]
}

fn any_vec3() -> impl Strategy<Value = Vec3> {
    (any_f32(), any_f32(), any_f32()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_filter_map("too short", |(x, y, z)| Vec3::new(x, y, z).try_normalize())
}

fn symmetric() -> ImagePlane {
    let quarter = Fov { left: -FRAC_PI_4, right: FRAC_PI_4, up: FRAC_PI_4, down: -FRAC_PI_4 };
    quarter.tangents().plane([100, 100])
}

#[test]
fn known_angles() {
    let ahead = Vec3::NEG_Z;
    for (v, expected) in [
        (Vec3::NEG_Z, 0.0),
        (Vec3::new(1.0, 0.0, -1.0), FRAC_PI_4),
        (Vec3::X, FRAC_PI_2),
        (Vec3::Z, PI),
        (Vec3::new(1e-4, 0.0, -1.0), 1e-4),
    ] {
        assert!((eccentricity(ahead, v) - expected).abs() < 1e-6, "{v}");
        assert!((eccentricity(ahead * 1e30, v * 1e-30) - expected).abs() < 1e-6, "{v}, scaled");
    }
}

#[test]
fn image_corners_look_along_the_edges_of_the_view() {
    let fov = Fov { left: -0.9, right: 0.7, up: 0.8, down: -1.0 };
    let plane = fov.tangents().plane([640, 480]);
    let upper_left = plane.direction(Vec2::ZERO);
    let lower_right = plane.direction(Vec2::new(640.0, 480.0));
    assert!((upper_left - Vec3::new((-0.9f32).tan(), 0.8f32.tan(), -1.0)).length() < 1e-5);
    assert!((lower_right - Vec3::new(0.7f32.tan(), (-1.0f32).tan(), -1.0)).length() < 1e-5);
}

#[test]
fn tile_around_the_gaze_starts_at_zero() {
    let rect = PixelRect { min: Vec2::splat(40.0), max: Vec2::splat(60.0) };
    let range = tile_eccentricity(&symmetric(), rect, Vec3::NEG_Z);
    assert_eq!(range.min, 0.0);
    assert!((range.max - (0.2f32 * 2f32.sqrt()).atan()).abs() < 1e-5, "{range:?}");
    assert_eq!(tile_eccentricity(&symmetric(), rect, Vec3::Z).max, PI);
}

#[test]
fn meaningless_gaze_is_everywhere() {
    let rect = PixelRect { min: Vec2::ZERO, max: Vec2::splat(16.0) };
    for gaze in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(
            tile_eccentricity(&symmetric(), rect, gaze),
            EccentricityRange { min: 0.0, max: 0.0 },
            "{gaze}"
        );
    }
}

#[test]
fn meaningless_directions_are_looked_at() {
    for other in
        [Vec3::new(1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::ZERO]
    {
        for nothing in [Vec3::ZERO, -Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            assert_eq!(
                (eccentricity(nothing, other), eccentricity(other, nothing)),
                (0.0, 0.0),
                "{nothing}, {other}"
            );
        }
    }
}

proptest! {
    #[test]
    fn eccentricity_is_an_angle_for_any_input(a in any_vec3(), b in any_vec3()) {
        let angle = eccentricity(a, b);
        prop_assert!((0.0..=PI + 1e-6).contains(&angle), "{angle}");
    }

    #[test]
    fn turning_gaze_and_ray_together_changes_nothing(
        a in direction(), b in direction(), axis in direction(), angle in -PI..PI,
    ) {
        let turn = glam::Quat::from_axis_angle(axis, angle);
        let difference = eccentricity(a, b) - eccentricity(turn * a, turn * b);
        prop_assert!(difference.abs() < 2e-6, "{difference}");
    }

    #[test]
    fn directions_are_finite_for_any_field_of_view(
        left in any_f32(), right in any_f32(), up in any_f32(), down in any_f32(),
        width in any::<u32>(), height in any::<u32>(),
    ) {
        let plane = Fov { left, right, up, down }.tangents().plane([width, height]);
        prop_assert!(plane.direction(Vec2::new(width as f32, height as f32)).is_finite());
    }

    #[test]
    fn every_point_of_a_tile_is_in_its_range(
        x in 0.0f32..90.0, y in 0.0f32..90.0, size in 0.5f32..100.0, gaze in direction(),
        u in 0.0f32..=1.0, v in 0.0f32..=1.0,
    ) {
        let plane = symmetric();
        let rect = PixelRect { min: Vec2::new(x, y), max: Vec2::new(x, y) + size };
        let range = tile_eccentricity(&plane, rect, gaze);
        let point = eccentricity(gaze, plane.direction(rect.min + Vec2::new(u, v) * size));
        prop_assert!(range.min <= point + 2e-6 && point <= range.max + 2e-6, "{point} in {range:?}");
    }

    #[test]
    fn tile_range_is_reached(x in 0.0f32..90.0, y in 0.0f32..90.0, size in 1.0f32..30.0, gaze in direction()) {
        let plane = symmetric();
        let rect = PixelRect { min: Vec2::new(x, y), max: Vec2::new(x, y) + size };
        let range = tile_eccentricity(&plane, rect, gaze);
        let angles = (0..=64).flat_map(|i| (0..=64).map(move |j| Vec2::new(i as f32, j as f32) / 64.0))
            .map(|at| eccentricity(gaze, plane.direction(rect.min + at * size)));
        let (low, high) = angles.fold((PI, 0.0f32), |(low, high), a| (low.min(a), high.max(a)));
        let spacing = 30.0 / 64.0 * 0.02 * 1.5;
        prop_assert!(low - range.min < spacing && range.max - high < spacing, "{low}..{high} in {range:?}");
    }
}
