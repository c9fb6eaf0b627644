use super::*;
use crate::geometry::{Fov, eccentricity};
use proptest::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};

const SIDE: f32 = 1024.0;

fn view(orientation: Quat) -> View {
    let fov = Fov { left: -0.9, right: 0.7, up: 0.8, down: -0.85 };
    View { orientation, plane: fov.tangents().plane([SIDE as u32, SIDE as u32]) }
}

fn straight() -> View {
    view(Quat::IDENTITY)
}

fn any_rotation() -> impl Strategy<Value = Quat> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, 0.0f32..PI).prop_filter_map("no axis", |(x, y, z, angle)| {
        Some(Quat::from_axis_angle(Vec3::new(x, y, z).try_normalize()?, angle))
    })
}

#[test]
fn a_turn_to_the_left_moves_the_picture_to_the_right() {
    let angle = 0.2f32;
    let turned = view(Quat::from_rotation_y(angle));
    let ahead = straight().plane.origin / -straight().plane.step;
    let found = Reprojection::between(&straight(), &turned).unwrap().pixel(ahead).unwrap();
    let expected = ahead.x + angle.tan() / straight().plane.step.x;
    assert!((found.x - expected).abs() < 0.01 && (found.y - ahead.y).abs() < 0.01, "{found}");
}

#[test]
fn points_beside_or_behind_the_view_have_no_place() {
    let ahead = straight().plane.origin / -straight().plane.step;
    for angle in [FRAC_PI_2 + 0.01, PI, -PI, -FRAC_PI_2 - 0.01] {
        let there = Reprojection::between(&straight(), &view(Quat::from_rotation_y(angle))).unwrap();
        assert_eq!(there.pixel(ahead), None, "{angle}");
    }
    assert_eq!(Reprojection::between(&straight(), &straight()).unwrap().pixel(Vec2::NAN), None);
}

#[test]
fn orientations_that_are_no_rotation_and_views_without_angle_have_no_map() {
    for wrong in
        [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::NAN, Quat::from_xyzw(0.0, f32::INFINITY, 0.0, 1.0)]
    {
        assert_eq!(Reprojection::between(&straight(), &view(wrong)), None);
        assert_eq!(Reprojection::between(&view(wrong), &straight()), None);
    }
    let flat = Fov { left: 0.3, right: 0.3, up: 0.5, down: -0.5 }.tangents().plane([10, 10]);
    let flat = View { orientation: Quat::IDENTITY, plane: flat };
    assert_eq!(Reprojection::between(&straight(), &flat), None);
    assert!(Reprojection::between(&flat, &straight()).is_some(), "its one column has a place all the same");
}

proptest! {
    #[test]
    fn there_and_back_is_where_it_was(
        a in any_rotation(), yaw in -0.7f32..0.7, pitch in -0.7f32..0.7, x in 0.0f32..SIDE, y in 0.0f32..SIDE,
    ) {
        let b = a * Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch);
        let (a, b) = (view(a), view(b));
        let there = Reprojection::between(&a, &b).unwrap();
        let back = Reprojection::between(&b, &a).unwrap();
        let pixel = Vec2::new(x, y);
        // Farther out than 85 degrees a pixel's neighbours are indistinguishable in f32.
        let seen = there.pixel(pixel).filter(|pixel| pixel.abs().max_element() < 6000.0);
        if let Some(seen) = seen {
            let again = back.pixel(seen).unwrap();
            prop_assert!((again - pixel).length() < 0.05, "{pixel} to {seen} to {again}");
        }
    }

    #[test]
    fn the_world_direction_stays_the_same(
        a in any_rotation(), b in any_rotation(), x in 0.0f32..SIDE, y in 0.0f32..SIDE,
    ) {
        let (a, b) = (view(a), view(b));
        let pixel = Vec2::new(x, y);
        let world = a.orientation * a.plane.direction(pixel);
        match Reprojection::between(&a, &b).unwrap().pixel(pixel) {
            Some(found) => {
                let angle = eccentricity(b.orientation * b.plane.direction(found), world);
                prop_assert!(angle < 1e-5, "{angle}");
            }
            // 1e-5: rounding, for directions at exactly 90 degrees.
            None => prop_assert!((b.orientation.inverse() * world).z > -1e-5),
        }
    }

    #[test]
    fn length_and_sign_of_a_quaternion_do_not_matter(
        q in any_rotation(), scale in prop_oneof![Just(-1.0f32), Just(1e30), Just(-1e-30), 0.1f32..10.0],
        x in 0.0f32..SIDE, y in 0.0f32..SIDE,
    ) {
        let scaled = Quat::from_vec4(glam::Vec4::from(q) * scale);
        let plain = Reprojection::between(&straight(), &view(q)).unwrap();
        let other = Reprojection::between(&straight(), &view(scaled)).unwrap();
        let difference = plain.matrix() - other.matrix();
        // In pixels, of which one view is 1024 wide.
        prop_assert!(difference.to_cols_array().iter().all(|d| d.abs() <= 1e-3), "{difference}");
        if let (Some(a), Some(b)) = (plain.pixel(Vec2::new(x, y)), other.pixel(Vec2::new(x, y))) {
            prop_assert!(a.distance(b) <= 1e-3 * a.length().max(1000.0).powi(2) / 1000.0, "{a}, {b}");
        }
    }

    #[test]
    fn any_numbers_give_a_finite_pixel_or_none(
        q in proptest::array::uniform4(any::<f32>()), fov in proptest::array::uniform4(any::<f32>()), x: f32, y: f32,
    ) {
        let plane = Fov { left: fov[0], right: fov[1], up: fov[2], down: fov[3] }.tangents().plane([640, 480]);
        let other = View { orientation: Quat::from_array(q), plane };
        for (from, to) in [(&straight(), &other), (&other, &straight())] {
            if let Some(found) = Reprojection::between(from, to).and_then(|map| map.pixel(Vec2::new(x, y))) {
                prop_assert!(found.is_finite());
            }
        }
    }
}
