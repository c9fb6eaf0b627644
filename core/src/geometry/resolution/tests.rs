use super::*;
use crate::geometry::{Fov, eccentricity};
use proptest::prelude::*;

/// Paper B's image: 1440 x 1600 with a focal length of 555 pixels.
fn headset() -> ImagePlane {
    ImagePlane { origin: Vec2::new(-720.0, 800.0) / 555.0, step: Vec2::new(1.0, -1.0) / 555.0 }
}

#[test]
fn the_centre_has_the_focal_length_per_radian() {
    let centre = pixels_per_degree(&headset(), Vec2::new(720.0, 800.0));
    assert!((centre - 9.686_577).abs() < 1e-4, "{centre}");
    let fov = Fov { left: -52.4f32.to_radians(), right: 52.4f32.to_radians(), up: 0.6, down: -0.6 };
    let of_fov = resolution(&fov.tangents().plane([1440, 1600]), Vec2::new(720.0, 800.0)).horizontal;
    assert!((of_fov - 9.68).abs() < 0.01, "{of_fov}");
}

#[test]
fn at_45_degrees_to_the_side_there_are_twice_as_many_across_and_sqrt_2_along() {
    let side = resolution(&headset(), Vec2::new(720.0 + 555.0, 800.0));
    assert!((side.horizontal / 9.686_577 - 2.0).abs() < 1e-5, "{side:?}");
    assert!((side.vertical / 9.686_577 - std::f32::consts::SQRT_2).abs() < 1e-5, "{side:?}");
}

#[test]
fn an_image_without_angle_has_no_resolution() {
    let flat = Fov { left: 0.5, right: 0.5, up: 0.5, down: -0.5 }.tangents().plane([100, 100]);
    assert_eq!(resolution(&flat, Vec2::splat(50.0)).horizontal, 0.0);
    assert_eq!(pixels_per_degree(&flat, Vec2::splat(50.0)), 0.0);
    assert_eq!(pixels_per_degree(&headset(), Vec2::NAN), 0.0);
}

proptest! {
    #[test]
    fn it_is_one_over_the_angle_between_neighbours(
        left in -1.2f32..-0.1, right in 0.1f32..1.2, up in 0.1f32..1.2, down in -1.2f32..-0.1,
        x in 0.0f32..1.0, y in 0.0f32..1.0, mirrored: bool,
    ) {
        let (left, right) = if mirrored { (right, left) } else { (left, right) };
        let plane = Fov { left, right, up, down }.tangents().plane([400, 400]);
        let pixel = Vec2::new(x, y) * 400.0;
        let found = resolution(&plane, pixel);
        for (axis, per_degree) in [(Vec2::X, found.horizontal), (Vec2::Y, found.vertical)] {
            let angle = eccentricity(plane.direction(pixel - axis / 2.0), plane.direction(pixel + axis / 2.0));
            prop_assert!((angle.to_degrees() * per_degree - 1.0).abs() < 2e-3, "{angle}, {found:?}");
        }
    }

    #[test]
    fn it_is_finite_for_any_view_and_point(
        left: f32, right: f32, up: f32, down: f32, x: f32, y: f32, width: u32, height: u32,
    ) {
        let plane = Fov { left, right, up, down }.tangents().plane([width, height]);
        let found = pixels_per_degree(&plane, Vec2::new(x, y));
        prop_assert!(found.is_finite() && found >= 0.0, "{found}");
    }
}
